"""Meshes: formats, unit, instances, parts, faults."""
import os
import shutil

import numpy as np
import pytest
from reading import INVALID, VALID

from my_simulations.description.model import Link, Model
from my_simulations.description.shapes import Box, Collision, Mesh, mesh_key
from my_simulations.errors import InputError, Severity
from my_simulations.formats.mesh.loading import collision_meshes, load_mesh, without_missing_meshes


def load(name, **options):
    return load_mesh(Mesh(name, os.path.join(VALID, name), **options))


def bounds(data):
    return data.vertices.min(axis=0).tolist(), data.vertices.max(axis=0).tolist()


def volume(data):
    corners = data.vertices[data.triangles]
    return float(np.einsum("ij,ij->i", corners[:, 0],
                           np.cross(corners[:, 1], corners[:, 2])).sum() / 6)


@pytest.mark.parametrize("name", ["cube.stl", "cube_ascii.stl"])
def test_binary_and_ascii_stl_are_the_same_cube(name):
    data = load(name)
    assert data.vertices.shape == (8, 3) and data.triangles.shape == (12, 3)
    assert bounds(data) == ([0, 0, 0], [1, 1, 1])
    assert volume(data) == pytest.approx(1.0)
    assert data.vertices.dtype == np.float64 and data.triangles.dtype == np.int32


def test_a_binary_stl_may_begin_with_solid(tmp_path):
    with open(os.path.join(VALID, "cube.stl"), "rb") as stream:
        content = stream.read()
    path = tmp_path / "cube.STL"
    path.write_bytes(b"solid cube" + content[10:])
    assert len(load_mesh(Mesh("cube", str(path))).triangles) == 12


def test_an_inch_collada_file_is_0_0254_as_big_and_a_y_up_one_is_not_turned():
    data = load("inch_y_up.dae")
    assert sorted(map(tuple, data.vertices.tolist())) == [
        (0, 0, 0), (0, pytest.approx(2 * 0.0254), 0), (pytest.approx(0.0254), 0, 0)]


def test_instances_transforms_and_shared_nodes_of_collada_are_placed():
    data = load("instances.dae")
    assert data.triangles.shape == (3, 3)
    corners = data.vertices[data.triangles] * 100  # centimetres, as in the file
    assert corners == pytest.approx(np.array([
        [[100, 0, 0], [101, 0, 0], [100, 2, 0]], [[100, 0, 0], [100, 2, 0], [96, 0, 0]],
        [[-100, 0, 5], [-99, 0, 5], [-100, 2, 5]]]))


@pytest.mark.parametrize("part, triangles", [("Left", 2), ("child", 1), ("Right", 1), ("tri", 3)])
def test_a_submesh_is_a_node_or_a_geometry_of_collada(part, triangles):
    assert len(load("instances.dae", submesh=part).triangles) == triangles


def test_a_submesh_of_obj_keeps_its_place_or_is_centred():
    assert bounds(load("two_parts.obj")) == ([0, 0, 0], [1, 1, 4])
    assert bounds(load("two_parts.obj", submesh="high")) == ([0, 0, 3], [1, 1, 4])
    centred = load("two_parts.obj", submesh="high", center=True)
    assert bounds(centred) == ([-0.5] * 3, [0.5] * 3)


def test_scale_counts_for_each_axis_and_a_mirrored_mesh_stays_outside_out():
    assert bounds(load("cube.stl", scale=(1.0, 2.0, 3.0))) == ([0, 0, 0], [1, 2, 3])
    assert volume(load("cube.stl", scale=(-1.0, 2.0, 1.0))) == pytest.approx(2.0)


def test_polygons_strips_fans_and_skins_of_collada_are_read(tmp_path):
    with open(os.path.join(VALID, "inch_y_up.dae")) as stream:
        text = stream.read().replace('meter="0.0254"', 'meter="1"').replace(
            'count="9">0 0 0  1 0 0  0 2 0', 'count="12">0 0 0  1 0 0  1 1 0  0 1 0')
    start, end = text.index("<triangles"), text.index("</triangles>") + len("</triangles>")
    entry = '<input semantic="VERTEX" source="#v" offset="0"/>'
    pieces = {
        "polygons": f"<polygons>{entry}<p>0 1 2 3</p></polygons>",
        "tristrips": f"<tristrips>{entry}<p>0 1 3 2</p></tristrips>",
        "trifans": f"<trifans>{entry}<p>0 1 2 3</p></trifans>",
        "polylist": f"<polylist>{entry}<vcount>4</vcount><p>0 1 2 3</p></polylist>",
    }
    for name, piece in pieces.items():
        path = tmp_path / f"{name}.dae"
        path.write_text(text[:start] + piece + text[end:])
        data = load_mesh(Mesh(name, str(path)))
        corners = data.vertices[data.triangles]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        assert normals.tolist() == [[0, 0, 1], [0, 0, 1]], name
    skin = ('<library_controllers><controller id="c"><skin source="#tri-geometry">'
            "<bind_shape_matrix>1 0 0 0 0 1 0 0 0 0 1 7 0 0 0 1</bind_shape_matrix></skin>"
            "</controller></library_controllers>")
    path = tmp_path / "skin.dae"
    path.write_text((text[:start] + pieces["polylist"] + text[end:])
                    .replace("<library_visual", skin + "<library_visual")
                    .replace('geometry url="#tri-geometry"', 'controller url="#c"'))
    assert bounds(load_mesh(Mesh("skin", str(path)))) == ([0, 0, 7], [1, 1, 7])


def test_the_extension_may_have_any_letter_case(tmp_path):
    path = tmp_path / "A.DAE"
    shutil.copy(os.path.join(VALID, "inch_y_up.dae"), path)
    assert len(load_mesh(Mesh("a", str(path))).triangles) == 1


FAULTS = {
    "mesh_with_nan.stl": "mesh-not-finite",
    "mesh_with_nan.dae": "mesh-not-finite",
    "mesh_without_faces.stl": "mesh-empty",
    "mesh_without_faces.dae": "mesh-empty",
    "mesh_cut_off.stl": "mesh-unreadable",
    "mesh_cut_off.dae": "mesh-unreadable",
    "mesh_index_out_of_range.dae": "mesh-unreadable",
    "mesh_unit_zero.dae": "mesh-unreadable",
    "mesh_vertex_unknown.obj": "mesh-unreadable",
    "mass_zero.sdf": "mesh-unreadable",
    "gone.dae": "mesh-not-found",
}


@pytest.mark.parametrize("name", sorted(FAULTS))
def test_a_mesh_that_cannot_be_used_is_refused(name):
    path = os.path.join(INVALID, name)
    with pytest.raises(InputError) as caught:
        load_mesh(Mesh(name, path))
    issue = caught.value.first
    assert (issue.code, issue.severity, issue.file) == (FAULTS[name], Severity.ERROR, path)


def test_every_fixture_of_a_broken_mesh_has_an_expectation():
    there = {n for n in os.listdir(INVALID) if n.endswith((".dae", ".stl", ".obj"))}
    assert there == {n for n in FAULTS if n.startswith("mesh_")}


def test_an_unknown_part_is_refused_with_the_closest_known_one():
    with pytest.raises(InputError) as caught:
        load("two_parts.obj", submesh="hihg")
    assert caught.value.first.code == "mesh-empty" and "high" in caught.value.first.hint


def test_a_collada_file_with_entities_is_refused(tmp_path):
    path = tmp_path / "a.dae"
    path.write_text('<!DOCTYPE x [<!ENTITY a "b">]><COLLADA>&a;</COLLADA>')
    with pytest.raises(InputError) as caught:
        load_mesh(Mesh("a", str(path)))
    assert caught.value.first.code == "mesh-unreadable"


def test_nodes_that_contain_each_other_are_refused(tmp_path):
    with open(os.path.join(VALID, "instances.dae")) as stream:
        text = stream.read().replace("<translate>0 0 5</translate>",
                                     '<instance_node url="#shared"/>')
    path = tmp_path / "a.dae"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        load_mesh(Mesh("a", str(path)))
    assert caught.value.first.code == "mesh-unreadable"


def test_a_changed_file_is_read_again(tmp_path):
    path = tmp_path / "a.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    mesh = Mesh("a", str(path))
    first = load_mesh(mesh)
    assert load_mesh(mesh) is first
    path.write_text("v 0 0 0\nv 22 0 0\nv 0 1 0\nf 1 2 3\n")
    assert load_mesh(mesh).vertices.max() == 22


def model_with(*meshes):
    collisions = [Collision(f"c{n}", mesh) for n, mesh in enumerate(meshes)]
    return Model("m", links=[Link("l", collisions=[*collisions, Collision("box", Box())])])


def test_the_collision_meshes_of_a_model_come_by_their_key_and_faults_name_the_collision():
    good = Mesh("a", os.path.join(VALID, "cube.stl"))
    bad = Mesh("b", os.path.join(INVALID, "mesh_with_nan.stl"))
    model = model_with(good, bad)
    inner = model_with(Mesh("c", os.path.join(VALID, "two_parts.obj"), submesh="low"))
    inner.name = "inner"
    model.models = [inner]
    table, issues = collision_meshes(model)
    assert set(table) == {mesh_key(good), mesh_key(inner.links[0].collisions[0].geometry)}
    (issue,) = issues
    assert issue.code == "mesh-not-finite" and "'c1' of link 'l'" in issue.message
    usable = without_missing_meshes(model, table)
    assert [c.name for c in usable.links[0].collisions] == ["c0", "box"]
    assert len(usable.models[0].links[0].collisions) == 2
    assert len(model.links[0].collisions) == 3


def test_a_model_whose_meshes_are_all_there_is_left_as_it_is():
    model = model_with(Mesh("a", os.path.join(VALID, "cube.stl")))
    assert without_missing_meshes(model, collision_meshes(model)[0]) is model


def size_codes(path, static=False, scale=(1.0, 1.0, 1.0)):
    model = model_with(Mesh("m", str(path), scale=scale))
    model.static = static
    table, issues = collision_meshes(model)
    assert len(table) == 1 and all(issue.severity is Severity.WARNING for issue in issues)
    return [issue.code for issue in issues]


def big_collada(tool, unit):
    with open(os.path.join(VALID, "inch_y_up.dae")) as stream:
        text = stream.read()
    return text.replace("0 2 0", "0 1200 0").replace(
        '<asset><unit name="u" meter="0.0254"/>',
        f"<asset><contributor><authoring_tool>{tool}</authoring_tool></contributor>{unit}")


def test_a_mesh_of_a_moving_model_that_looks_like_a_lost_unit_gets_a_warning(tmp_path):
    path = tmp_path / "a.obj"
    path.write_text("v 0 0 0\nv 300 0 0\nv 0 1 0\nf 1 2 3\n")
    assert size_codes(path) == ["mesh-size-odd"]
    assert size_codes(path, scale=(0.001, 0.001, 0.001)) == []
    assert size_codes(path, static=True) == []
    (issue,) = collision_meshes(model_with(Mesh("m", str(path))))[1]
    assert "300 m" in issue.message and "7.62 m (inches)" in issue.hint


@pytest.mark.parametrize("tool, unit, codes", [
    ("SketchUp 16.1", '<unit name="meter" meter="1"/>', ["mesh-size-odd"]),
    ("Google SketchUp 8", "", ["mesh-size-odd"]),
    ("SketchUp 16.1", '<unit name="inch" meter="0.0254"/>', []),
    ("Blender 2.7", '<unit name="meter" meter="1"/>', [])])
def test_a_building_gets_that_warning_only_where_its_exporter_writes_inches(tmp_path, tool, unit,
                                                                            codes):
    path = tmp_path / "a.dae"
    path.write_text(big_collada(tool, unit))
    assert size_codes(path, static=True) == codes


def unitless_collada(height):
    with open(os.path.join(VALID, "inch_y_up.dae")) as stream:
        text = stream.read()
    return text.replace("0 2 0", f"0 {height} 0").replace('<unit name="u" meter="0.0254"/>', "")


def test_a_collada_file_without_a_unit_gets_the_warning_when_it_is_longer_than_furniture(tmp_path):
    path = tmp_path / "a.dae"
    path.write_text(unitless_collada(20))
    (issue,) = collision_meshes(model_with(Mesh("m", str(path))))[1]
    assert issue.code == "mesh-size-odd"
    assert "20 m long: its file names no <unit>" in issue.message
    assert "0.508 m (inches)" in issue.hint
    assert size_codes(path, static=True) == ["mesh-size-odd"]
    assert size_codes(path, scale=(0.0254, 0.0254, 0.0254)) == []
    path.write_text(unitless_collada(6))
    assert size_codes(path) == ["mesh-size-odd"] and size_codes(path, static=True) == []
    path.write_text(unitless_collada(2))
    assert size_codes(path) == []
