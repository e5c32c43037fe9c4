"""Texts that XML cannot hold: refused at every door, and no end of saving where one came in."""
from __future__ import annotations

import asyncio
import json
from dataclasses import replace

import pytest
from building_plans import two_rooms
from editor_case import Refused, box, cases

from my_simulations.building.building_folder import check_name
from my_simulations.building.plan_json import plan_from_json, plan_to_json
from my_simulations.description.light import Light
from my_simulations.description.shapes import Material
from my_simulations.description.world import World
from my_simulations.editor.library import autosave
from my_simulations.errors import CommandError, InputError
from my_simulations.formats.reading import parse_world, read_entity
from my_simulations.formats.sdf.writer.entities import write_world
from my_simulations.objects.yaml_source import read_yaml
from my_simulations.resources.resolver import Resolver
from my_simulations.xml_characters import check_tree, forbidden_character

BAD = [(chr(code), f"U+{code:04X}")
       for code in (0x0, 0x1, 0x1F, 0xD800, 0xDFFF, 0xFFFE, 0xFFFF)]
GOOD = "caf\u00e9 \u4e2d \U0001f916\t\n\r \x7f\ufffd\ufdd0"

case = pytest.fixture(cases)


@pytest.mark.parametrize("character, name", BAD)
def test_the_first_bad_character_is_named_with_its_place(character, name):
    assert forbidden_character(f"ab{character}c\x02") == f"{name} at position 3"


def test_what_xml_holds_is_written_and_read_again():
    assert forbidden_character(GOOD) == ""
    world = World("w", models=[replace(box("a"), name=GOOD)])
    read, _ = parse_world(write_world(world), Resolver())
    assert read.models[0].name == GOOD


def test_a_tree_is_looked_through_down_to_its_keys():
    with pytest.raises(CommandError, match=r"m\.a\[1\]\.b contains the character U\+0001"):
        check_tree({"a": ["fine", {"b": "x\x01"}]}, "m")
    with pytest.raises(CommandError, match=r"a key of m\.a contains the character U\+FFFF"):
        check_tree({"a": {"\uffff": 1}}, "m")
    deep = "\x01"
    for _ in range(100000):
        deep = [deep]
    with pytest.raises(CommandError, match="U[+]0001"):
        check_tree(deep, "m")


@pytest.mark.parametrize("character, name", BAD)
def test_the_simulator_takes_no_such_name(case, character, name):
    simulator = case(box("a")).sim
    told = f"{name} at position 2"
    with pytest.raises(CommandError) as spawned:
        simulator.models.spawn(box(f"b{character}"))
    with pytest.raises(CommandError) as renamed:
        simulator.models.edit("a", replace(simulator.models.get("a"), name=f"a{character}"))
    with pytest.raises(CommandError) as lit:
        simulator.lights.add(Light(f"l{character}"))
    assert [told in str(one.value) for one in (spawned, renamed, lit)] == [True] * 3
    assert simulator.models.names() == ["a"] and simulator.lights.all() == []


@pytest.mark.parametrize("character, name", BAD)
def test_no_message_of_the_page_brings_one_in(case, character, name):
    made = case(box("a"))
    bad = f"b{character}"
    operations = [
        ("rename", {"name": "a", "to": bad}), ("insert", {"shape": "box", "name": bad}),
        ("insert_light", {"light": {"name": bad}}), ("insert", {"sdf": f"<sdf>{bad}</sdf>"}),
        ("paste", {"text": bad}),
        ("set", {"target": {"kind": "visual", "model": "a", "link": "link", "name": "visual"},
                 "path": "material.script_name", "value": bad}),
    ]

    async def attack(browser):
        for kind, fields in operations:
            with pytest.raises(Refused) as refused:
                await browser.edit(kind, **fields)
            assert name in str(refused.value), (kind, refused.value)
            assert kind == "insert" or "edit.op" in str(refused.value)
        await browser.edit("insert", shape="box", name="fine")

    made.browse(attack)
    made.sim.models.get("fine")


@pytest.mark.parametrize("character, name", BAD)
def test_plans_and_building_names_hold_none(character, name):
    tree = json.loads(json.dumps(plan_to_json(two_rooms())))
    tree["levels"][0]["name"] = f"ground{character}"
    with pytest.raises(InputError):
        plan_from_json(tree)
    with pytest.raises(CommandError):
        check_name(f"house{character}")


@pytest.mark.parametrize("escape, name", [("\\x01", "U+0001"), ("\\uFFFE", "U+FFFE"),
                                          ("\\uD800", "U+D800")])
def test_object_lists_name_the_character_and_the_line(tmp_path, escape, name):
    path = tmp_path / "objects.yaml"
    path.write_text(f'a:\n  model: box\nb:\n  model: "b{escape}"\n')
    with pytest.raises(InputError) as refused:
        read_yaml(str(path), "/objects")
    assert refused.value.first.line == 4 and name in str(refused.value)


@pytest.mark.parametrize("character, name", BAD)
def test_documents_name_the_character_with_line_and_column(character, name):
    text = f"<sdf version='1.6'>\n<model name='m{character}'><link name='l'/></model></sdf>"
    with pytest.raises(InputError) as refused:
        read_entity(text, Resolver(), "robot_description")
    first = refused.value.first
    assert (first.line, first.column) == (2, 15) and f"the character {name}," in first.message


def test_a_form_feed_in_a_comment_is_a_warning():
    text = "<sdf version='1.6'><!-- \f --><model name='m'><link name='l'/></model></sdf>\n\0"
    model, issues = read_entity(text, Resolver(), "m.sdf")
    assert model.name == "m"
    assert "a comment contains a character" in issues[0].message


def test_what_cannot_be_written_names_the_model():
    broken = box("b")
    [link] = broken.links
    [visual] = link.visuals
    bad = replace(visual, material=Material(script_uris=["x"], script_name="grey\x01"))
    broken = replace(broken, links=[replace(link, visuals=[bad])])
    with pytest.raises(CommandError, match="model 'b' cannot be written"):
        write_world(World("w", models=[box("a"), broken]))
    with pytest.raises(CommandError, match=r"light 'l\\ud800' cannot be written"):
        write_world(World("w", lights=[Light("l\ud800")]))
    with pytest.raises(CommandError, match="the world cannot be written"):
        write_world(World("w\x00"))


def test_autosave_survives_whatever_goes_wrong_and_says_so(case, monkeypatch):
    made = case(box("a"))
    kept = made.worlds.parent
    faults = [ValueError("first"), MemoryError(), PermissionError(13, "Permission denied")]
    true_write = autosave.write_atomically

    def failing(*args, **options):
        if faults:
            raise faults.pop()
        true_write(*args, **options)

    monkeypatch.setattr(autosave, "write_atomically", failing)

    async def edit(browser):
        await browser.edit("insert", shape="box")
        await browser.until(lambda: any("unsaved changes cannot be kept" in push["issue"]["message"]
                                        for push in browser.pushes if push["type"] == "issue"))
        while not list(kept.rglob("autosave/*.world")):
            await asyncio.sleep(0.05)

    made.browse(edit)
    assert faults == []
