"""Textures and blends of heightmaps: read, reported, written, ready for drawing."""
import pytest
from reading import codes, model_of

from my_simulations.appearance.materials import Materials
from my_simulations.appearance.palette import PATTERNS
from my_simulations.appearance.terrain_layers import TerrainLayer
from my_simulations.appearance.textures import TextureFiles
from my_simulations.description.shapes import (
    Heightmap,
    Material,
    TerrainBlend,
    TerrainTexture,
    Visual,
    mesh_key,
)
from my_simulations.formats.reading import read_entity
from my_simulations.formats.sdf.state_applied import scale_model
from my_simulations.formats.sdf.writer.entities import write_entity
from my_simulations.resources.resolver import Resolver

TWO = ("<texture><diffuse>low.png</diffuse><normal>bumps.png</normal><size>4</size></texture>"
       "<texture><diffuse>high.png</diffuse><size>2</size></texture>"
       "<blend><min_height>3</min_height><fade_dist>1.5</fade_dist></blend>")


@pytest.fixture
def folder(tmp_path):
    for name in ("grey.png", "low.png", "high.png", "bumps.png"):
        (tmp_path / name).write_bytes(b"")
    return tmp_path


def terrain(folder, inside):
    model, issues = model_of(
        '<link name="l"><visual name="v"><geometry><heightmap><uri>grey.png</uri>'
        f"<size>8 8 6</size>{inside}</heightmap></geometry></visual></link>",
        resolver=Resolver(resource_paths=[str(folder)]))
    return model, [issue for issue in issues if issue.xpath.find("/heightmap") >= 0]


def layers(visual, folder):
    resolver = Resolver(resource_paths=[str(folder)])
    look = Materials(resolver, TextureFiles(resolver)).of_visual(visual)
    return look.layers if look else ()


def test_textures_and_blends_are_read(folder):
    model, issues = terrain(folder, TWO)
    shape = model.links[0].visuals[0].geometry
    low, high, bumps = (str(folder / name) for name in ("low.png", "high.png", "bumps.png"))
    assert shape.textures == [TerrainTexture(low, bumps, 4.0), TerrainTexture(high, "", 2.0)]
    assert shape.blends == [TerrainBlend(3.0, 1.5)] and shape.extra == [] and issues == []


def test_what_is_read_is_written(folder):
    model, _ = terrain(folder, TWO.replace("<size>4</size>", "<size>10</size><odd/>"))
    again, _ = read_entity(write_entity(model).decode(), Resolver())
    written, read = (one.links[0].visuals[0].geometry for one in (again, model))
    assert (written.textures, written.blends) == (read.textures, read.blends)
    assert written.textures[0].extra == ["<odd/>"]


def test_the_layers_are_those_of_the_file(folder):
    model, _ = terrain(folder, TWO)
    low, high, bumps = (str(folder / name) for name in ("low.png", "high.png", "bumps.png"))
    assert layers(model.links[0].visuals[0], folder) == (
        TerrainLayer(low, "", bumps, 4.0, 0.0, pytest.approx(1e-6)),
        TerrainLayer(high, "", "", 2.0, 3.0, 1.5))


@pytest.mark.parametrize("what, tag", [("texture", "diffuse"), ("normal map", "normal")])
def test_a_missing_image_is_told_with_its_line_and_the_rest_is_kept(folder, what, tag):
    model, issues = terrain(folder, f"\n\n<texture><{tag}>gone.png</{tag}></texture>")
    (issue,) = issues
    assert issue.code == "image-not-found" and issue.line == 3
    assert issue.message.startswith(f"the {what} of this heightmap 'gone.png' was not found")
    (layer,) = layers(model.links[0].visuals[0], folder)
    assert (layer.texture, layer.pattern, layer.normal) == ("", "", "")


def test_pictures_that_gazebo_brings_along_are_drawn_by_us(folder):
    model, issues = terrain(folder, "".join(
        f"<texture><diffuse>file://media/materials/textures/{name}_diffusespecular.png</diffuse>"
        "<normal>file://media/materials/textures/flat_normal.png</normal></texture>"
        for name in ("dirt", "grass", "fungus")) + 2 * "<blend/>")
    found = layers(model.links[0].visuals[0], folder)
    assert [layer.pattern for layer in found] == ["dirt", "grass", "fungus"] and issues == []
    assert {layer.pattern for layer in found} <= set(PATTERNS)


def test_a_named_material_covers_the_textures():
    shape = Heightmap(textures=[TerrainTexture()])
    assert len(layers(Visual("v", shape), "")) == 1
    assert len(layers(Visual("v", shape, material=Material(diffuse=(1, 0, 0, 1))), "")) == 1
    assert layers(Visual("v", shape, material=Material(script_name="Gazebo/Red")), "") == ()


@pytest.mark.parametrize("textures, blends, seen, told", [
    (1, 0, 1, []), (3, 2, 3, []), (3, 1, 2, ["terrain-blends"]), (1, 2, 1, ["terrain-blends"]),
    (0, 1, 0, [])])
def test_the_number_of_blends_that_does_not_fit_is_told(folder, textures, blends, seen, told):
    model, issues = terrain(folder, textures * "<texture/>" + blends * "<blend/>")
    assert len(layers(model.links[0].visuals[0], folder)) == seen and codes(issues) == told


def test_a_size_that_is_not_positive_is_replaced(folder):
    model, issues = terrain(folder, "<texture><size>0</size></texture>")
    assert model.links[0].visuals[0].geometry.textures[0].size == 10.0
    assert codes(issues) == ["bad-value"]


def test_a_scaled_terrain_keeps_its_textures_where_they_were(folder):
    model, _ = terrain(folder, TWO)
    shape = scale_model(model, (1.0, 1.0, 2.0)).links[0].visuals[0].geometry
    assert shape.size == (8, 8, 12) and shape.blends == [TerrainBlend(6.0, 3.0)]


def test_textures_do_not_make_another_mesh():
    plain, covered = Heightmap("a"), Heightmap("a", textures=[TerrainTexture()])
    assert mesh_key(plain) == mesh_key(covered)
