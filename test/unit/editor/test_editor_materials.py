"""What materials look like: Gazebo's names, scripts of models, colours of files."""
from __future__ import annotations

import os
import time

import pytest

from my_simulations.appearance.gazebo_materials import BUILT_IN as TABLE
from my_simulations.appearance.material_script import ScriptMaterial, read_materials
from my_simulations.description.compare import BUILT_IN
from my_simulations.description.shapes import Material
from my_simulations.editor.scene.scene_json import Materials
from my_simulations.editor.scene.served_files import ServedFiles
from my_simulations.resources.resolver import Resolver

LONGEST_S = 2.0
"""Longest processor time of one script, in seconds; more is a hang."""

SCRIPT = """
// a comment { with braces }
material Shop/Base
{
  technique
  {
    pass
    {
      ambient 0.1 0.2 0.3
      diffuse 0.4 0.5 0.6 0.7 /* alpha
      over lines */
      specular 0.1 0.1 0.1 12
      texture_unit { texture "wood.png"
        scale 0.5 0.25 }
    }
    pass { diffuse 1 1 1 }
  }
  technique { pass { diffuse 0 0 0 } }
}
material Shop/Clear : Shop/Base
{ technique { pass { scene_blend alpha_blend
 lighting off
 emissive 1 1 1 } } }
material Broken
"""


def test_the_first_pass_of_the_first_technique_counts():
    base = read_materials(SCRIPT)["Shop/Base"]
    assert base.ambient == (0.1, 0.2, 0.3, 1.0)
    assert base.diffuse == (0.4, 0.5, 0.6, 0.7)
    assert base.specular == (0.1, 0.1, 0.1, 1.0)
    assert (base.texture, base.scale) == ("wood.png", (0.5, 0.25))


def test_a_material_takes_from_its_parent_what_it_does_not_say():
    clear = read_materials(SCRIPT)["Shop/Clear"]
    assert clear.texture == "wood.png" and clear.diffuse == (0.4, 0.5, 0.6, 0.7)
    assert clear.blend and not clear.lighting and clear.emissive == (1, 1, 1, 1)


WOOD = "material Wood { technique { pass { texture_unit grain { texture wood.png } } } }\n"


@pytest.mark.parametrize(("units", "seen"), [
    ("texture_unit { texture brick.png }", ("brick.png", (1.0, 1.0))),
    ("texture_unit { scale 2 3 }", ("wood.png", (2.0, 3.0))),
    ("texture_unit grain { texture brick.png }", ("brick.png", (1.0, 1.0))),
    ("texture_unit dirt { texture dirt.png\n scale 4 4 }", ("wood.png", (1.0, 1.0))),
    ("texture_unit { scale 2 2 }\n texture_unit { texture dirt.png }", ("wood.png", (2.0, 2.0))),
])
def test_a_texture_unit_of_a_derived_material_changes_that_of_its_parent(units, seen):
    found = read_materials(
        f"{WOOD}material Mine : Wood {{ technique {{ pass {{ {units} }} }} }}")["Mine"]
    assert (found.texture, found.scale) == seen


def test_the_first_texture_unit_with_a_texture_counts():
    found = read_materials("""material Two { technique { pass {
      texture_unit { texture_alias none }
      texture_unit { texture a.png
        scale 0.5 0.5 }
      texture_unit { texture b.png
        scale 10 10 } } } }""")["Two"]
    assert (found.texture, found.scale) == ("a.png", (0.5, 0.5))


@pytest.mark.parametrize("text", ["", "}", "{{{{", "material", "material X {", "material X { pass",
                                  "material X { diffuse a b c }", "\0" * 100, "{" * 100000])
def test_broken_scripts_end_no_program(text):
    assert isinstance(read_materials(text), dict)


@pytest.mark.parametrize("text", ["/* " * 300_000, "/*" * 300_000, "material X { /* "])
def test_an_open_comment_ends_with_the_script(text):
    began = time.process_time()
    read_materials(text)
    assert time.process_time() - began < LONGEST_S


def test_numbers_that_are_not_finite_and_names_that_no_file_has_are_left_out():
    found = read_materials("""material X { technique { pass {
      ambient nan 1 1
      diffuse 1e999 0 0
      specular 1 1 1 nan
      alpha_rejection greater inf
      texture_unit { texture "a\0b.png"
        scale nan 2 } } } }""")["X"]
    assert found == ScriptMaterial("X", specular=(1.0, 1.0, 1.0, 1.0))


@pytest.fixture
def shop(tmp_path):
    """Materials with the script in a model's folder."""
    scripts = tmp_path / "shop" / "materials" / "scripts"
    textures = tmp_path / "shop" / "materials" / "textures"
    scripts.mkdir(parents=True)
    textures.mkdir()
    (scripts / "shop.material").write_text(SCRIPT)
    (textures / "wood.png").write_bytes(b"png")
    resolver = Resolver([str(tmp_path)])
    return Materials(resolver, ServedFiles(resolver))


URIS = ["model://shop/materials/scripts", "model://shop/materials/textures"]


def test_a_script_is_found_with_its_texture(shop):
    found = shop.document(Material(script_uris=URIS, script_name="Shop/Base"))
    assert found["texture"]["url"].endswith("/shop/materials/textures/wood.png")
    assert found["texture"]["scale"] == [0.5, 0.25]
    assert found["diffuse"] == [0.4, 0.5, 0.6, 1.0] and found["transparency"] == 0.0


def test_a_named_pipe_is_no_script_and_nobody_waits_for_it(shop, tmp_path):
    os.mkfifo(tmp_path / "shop" / "materials" / "scripts" / "a.material")
    found = shop.document(Material(script_uris=URIS, script_name="Shop/Base"))
    assert found["texture"]["scale"] == [0.5, 0.25]


def test_only_so_much_is_read_of_a_folder(shop, tmp_path):
    scripts = tmp_path / "shop" / "materials" / "scripts"
    for number in range(12):
        with open(scripts / f"z{number:02}.material", "w", encoding="utf-8") as stream:
            stream.write(f"material Z{number} {{ technique {{ pass {{ diffuse 1 0 0 }} }} }}\n")
            stream.truncate(1 << 30)  # a hole, which takes no room
    began = time.process_time()
    found = [shop.document(Material(script_uris=URIS, script_name=f"Z{number}"))["diffuse"]
             for number in range(12)]
    assert found == [[1.0, 0.0, 0.0, 1.0]] * 7 + [[1.0] * 4] * 5
    assert time.process_time() - began < 8 * LONGEST_S
    assert shop.document(Material(script_uris=URIS, script_name="Shop/Base"))["texture"]


def test_a_blended_script_is_seen_through(shop):
    found = shop.document(Material(script_uris=URIS, script_name="Shop/Clear"))
    assert found["transparency"] == pytest.approx(0.3) and found["lighting"] is False


def test_a_name_is_looked_up_in_what_was_read_before(shop):
    shop.document(Material(script_uris=URIS, script_name="Shop/Base"))
    found = shop.document(Material(script_uris=[BUILT_IN], script_name="Shop/Base"))
    assert found["texture"]["url"]


def test_colours_of_the_file_override_the_script(shop):
    red = (1.0, 0.0, 0.0, 0.5)
    found = shop.document(Material(diffuse=red, script_uris=URIS, script_name="Shop/Base"))
    assert found["diffuse"] == list(red) and found["transparency"] == 0.5
    assert found["ambient"] == [0.1, 0.2, 0.3, 1.0]


def test_an_unknown_name_is_white_and_no_material_stays_none(shop):
    assert shop.document(Material(script_name="Nix"))["diffuse"] == [1, 1, 1, 1]
    assert shop.document(None) is None


@pytest.mark.parametrize("name", TABLE)
def test_gazebos_names_are_known_without_a_script(shop, name):
    found = shop.document(Material(script_uris=[BUILT_IN], script_name=name))
    assert found["name"] == name and len(found["diffuse"]) == 4
    assert found["texture"] is None or found["texture"]["pattern"]


def test_some_of_gazebos_colours(shop):
    def shown(name):
        return shop.document(Material(script_name=name))

    assert shown("Gazebo/Grey")["diffuse"] == [0.7, 0.7, 0.7, 1.0]
    assert shown("Gazebo/RedGlow")["emissive"] == [1.0, 0.0, 0.0, 1.0]
    assert shown("Gazebo/BlueTransparent")["transparency"] == 0.5
    assert shown("Gazebo/Bricks")["texture"]["pattern"] == "bricks"


def test_what_a_script_rejects_by_alpha_is_not_drawn():
    text = """material Leaf { technique { pass {
      alpha_rejection greater 128
      cull_hardware none
      texture_unit { texture leaf.png } } } }
    material Bark { technique { pass { alpha_rejection always_pass 0 } } }"""
    found = read_materials(text)
    assert found["Leaf"].alpha_test == pytest.approx(128 / 255)
    assert found["Bark"].alpha_test == 0.0
    assert found["Leaf"].double_sided and not found["Bark"].double_sided
