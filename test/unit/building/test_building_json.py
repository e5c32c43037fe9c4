"""Plans as JSON."""
from __future__ import annotations

import copy
import json

import pytest
from building_plans import two_rooms

from my_simulations.building.plan_json import (
    plan_from_json,
    plan_from_text,
    plan_to_json,
    plan_to_text,
)
from my_simulations.errors import InputError


def faults(tree):
    with pytest.raises(InputError) as caught:
        plan_from_json(tree, "building.json")
    return caught.value.issues


def test_a_plan_survives_its_text():
    plan = two_rooms()
    assert plan_from_text(plan_to_text(plan)) == plan


def test_what_has_a_default_may_be_left_out():
    plan = plan_from_json({"format": 1, "levels": [
        {"name": "Level 1", "walls": [{"id": 4, "start": [0, 0], "end": [1, 0]}]}]})
    assert plan.levels[0].walls[0].height == 2.5
    assert plan.next["wall"] == 5 and plan.next["door"] == 0


def test_numbers_are_not_used_twice_even_after_the_last_item_is_gone():
    tree = plan_to_json(two_rooms())
    tree["next"]["wall"] = 40
    assert plan_from_json(tree).next["wall"] == 40


@pytest.mark.parametrize(("path", "value", "where"), [
    (("levels", 0, "walls", 3, "start"), [0, "x"], "levels[0].walls[3].start"),
    (("levels", 0, "walls", 3, "start"), [0], "levels[0].walls[3].start"),
    (("levels", 0, "walls", 0, "height"), 0, "levels[0].walls[0].height"),
    (("levels", 0, "walls", 0, "height"), float("nan"), "levels[0].walls[0].height"),
    (("levels", 0, "walls", 0, "height"), 10 ** 400, "levels[0].walls[0].height"),
    (("levels", 0, "walls", 0, "thickness"), 1e9, "levels[0].walls[0].thickness"),
    (("levels", 0, "walls", 0, "color"), "red", "levels[0].walls[0].color"),
    (("levels", 0, "walls", 0, "id"), -1, "levels[0].walls[0].id"),
    (("levels", 0, "walls", 0, "id"), True, "levels[0].walls[0].id"),
    (("levels", 0, "doors", 0, "elevation"), -0.5, "levels[0].doors[0].elevation"),
    (("levels", 0, "stairs", 0, "steps"), 0, "levels[0].stairs[0].steps"),
    (("levels", 0, "stairs", 0, "steps"), 10 ** 6, "levels[0].stairs[0].steps"),
    (("levels", 1, "floors", 0, "outline"), [[0, 0], [1, 0]], "levels[1].floors[0].outline"),
    (("levels", 0, "walls"), {}, "levels[0].walls"),
    (("levels",), [], "levels"),
    (("levels", 0), "ground", "levels[0]"),
    (("roof",), {"kind": "dome"}, "roof.kind"),
    (("name",), "a\nb", "name"),
    (("format",), 99, "format"),
])
def test_a_wrong_value_is_named_with_its_place(path, value, where):
    tree = copy.deepcopy(plan_to_json(two_rooms()))
    at = tree
    for step in path[:-1]:
        at = at[step]
    at[path[-1]] = value
    issues = faults(json.loads(json.dumps(tree)))
    assert where in [issue.xpath for issue in issues]
    assert all(issue.file == "building.json" for issue in issues)


def test_all_faults_are_told_at_once():
    tree = plan_to_json(two_rooms())
    tree["levels"][0]["walls"][0]["height"] = -1
    tree["levels"][1]["walls"][2]["end"] = "here"
    assert len(faults(tree)) == 2


def test_two_walls_of_one_number_are_refused():
    tree = plan_to_json(two_rooms())
    tree["levels"][1]["walls"][0]["id"] = 0
    assert [issue.code for issue in faults(tree)] == ["plan-id-repeated"]


@pytest.mark.parametrize("text", [b"", b"{", b"\xff\xfe\x00", b"[1, 2]", b"null", b"[" * 100000,
                                  b'{"format": ' + b"9" * 5000 + b"}"])
def test_a_text_that_is_no_plan_is_refused(text):
    with pytest.raises(InputError):
        plan_from_text(text, "building.json")


def test_a_fault_in_the_text_has_its_line():
    with pytest.raises(InputError) as caught:
        plan_from_text('{"format": 1,\n "levels": oops}', "building.json")
    assert caught.value.first.location == "building.json:2:12"
