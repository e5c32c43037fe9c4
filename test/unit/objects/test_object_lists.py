from __future__ import annotations

import math
from pathlib import Path

import pytest

from my_simulations.errors import InputError, Severity
from my_simulations.objects.object_list import ObjectFile, parse_objects
from my_simulations.objects.selection import closest, parse_groups, select
from my_simulations.objects.yaml_source import Source, read_yaml

DATA = Path(__file__).resolve().parents[2] / "data"
INVALID = DATA / "invalid" / "objects"
VALID = DATA / "valid" / "objects"

FAULTS = {
    "missing_position": ("missing-key", "/objects/box/position", 1),
    "missing_model": ("missing-key", "/objects/box/model", 1),
    "missing_orientation": ("missing-key", "/objects/box/orientation", 1),
    "position_of_two_numbers": ("wrong-value", "/objects/box/position", 3),
    "position_nan": ("wrong-value", "/objects/box/position", 3),
    "position_is_text": ("wrong-value", "/objects/box/position", 3),
    "position_true": ("wrong-value", "/objects/box/position", 3),
    "orientation_is_map": ("wrong-value", "/objects/box/orientation", 4),
    "orientation_infinite": ("wrong-value", "/objects/box/orientation", 4),
    "model_is_number": ("wrong-value", "/objects/box/model", 2),
    "model_without_package": ("model-without-package", "/objects/box/model", 2),
    "model_type_unknown": ("model-type", "/objects/box/model_type", 3),
    "model_type_before_sdf": ("model-type", "/objects/box/model_type", 3),
    "object_not_indented": ("object-indentation", "/objects/model", 2),
    "position_not_indented": ("object-indentation", "/objects/position", 4),
    "object_without_name": ("object-indentation", "/objects/model", 1),
    "child_not_indented": ("object-indentation", "/objects/shelf/children/model", 7),
    "object_is_text": ("object-wrong-type", "/objects/box", 1),
    "object_is_empty": ("object-wrong-type", "/objects/box", 1),
    "name_is_number": ("object-name", "/objects/12", 1),
    "children_is_list": ("children-wrong-type", "/objects/box/children", 5),
    "names_collide": ("object-name-twice", "/objects/shelf_box", 10),
    "list_is_sequence": ("list-wrong-type", "/objects", 0),
}


def listing_of(path: Path):
    tree, source, _ = read_yaml(str(path), "/objects")
    return parse_objects(tree, source)


@pytest.mark.parametrize("name", sorted(FAULTS))
def test_a_faulty_list_names_the_parameter_the_file_and_the_line(name):
    code, param, line = FAULTS[name]
    errors = [i for i in listing_of(INVALID / f"{name}.yaml").issues()
              if i.severity is Severity.ERROR]
    assert [(i.code, i.xpath, i.line) for i in errors] == [(code, param, line)]
    assert errors[0].file.endswith(f"{name}.yaml")


@pytest.mark.parametrize("name,code,line", [
    ("not_yaml", "list-not-yaml", 3), ("tab_indented", "list-not-yaml", 2),
    ("not_utf8", "list-not-utf8", 2), ("no_such_file", "list-unreadable", 0)])
def test_an_unreadable_list_is_an_input_error_with_its_place(name, code, line):
    with pytest.raises(InputError) as caught:
        read_yaml(str(INVALID / f"{name}.yaml"), "/objects")
    issue = caught.value.issues[0]
    assert (issue.code, issue.line) == (code, line)
    assert name in issue.file


def test_every_invalid_list_has_a_test():
    tested = set(FAULTS) | {"not_yaml", "tab_indented", "not_utf8"}
    assert {path.stem for path in INVALID.glob("*.yaml")} == tested


def test_the_2012_format_finds_its_file_under_objects():
    listing = listing_of(VALID / "cob_2012.yaml")
    assert listing.faults == {}
    assert listing.objects["MY_OBJECT"].file == ObjectFile(
        "my_simulations", "objects/MY_OBJECT.urdf", xacro=False, sdf=False, named=False)
    assert listing.objects["MY_OBJECT"].position == (1.0, 2.5, 0.0)
    assert listing.objects["crate"].file == ObjectFile(
        "my_simulations", "objects/crate.urdf.xacro", xacro=True, sdf=False, named=False)


def test_a_number_with_an_exponent_and_no_dot_is_a_number():
    assert listing_of(VALID / "cob_2012.yaml").objects["crate"].rpy == (0.0, 0.0, 0.001)


def test_children_are_flattened_and_turned_by_the_yaw_of_their_parents_only():
    listing = listing_of(VALID / "cob_nested.yaml")
    assert list(listing.objects) == ["shelf", "shelf_pallet", "shelf_pallet_tin"]
    pallet = listing.objects["shelf_pallet"]
    assert pallet.position == pytest.approx((1.0, 3.0, 0.75))
    assert pallet.rpy == pytest.approx((0.3, 0.0, math.pi / 2 + 0.5))
    tin = listing.objects["shelf_pallet_tin"]
    turn = math.pi / 2 + 0.5
    assert tin.position == pytest.approx((1.0 - math.sin(turn), 3.0 + math.cos(turn), 0.75))
    assert tin.rpy == pytest.approx((0.0, 0.0, turn))


def test_only_the_first_package_name_is_taken_off_a_path():
    tin = listing_of(VALID / "cob_nested.yaml").objects["shelf_pallet_tin"]
    assert tin.file == ObjectFile("cob_gazebo_objects", "objects/cob_gazebo_objects/tin.sdf",
                                  xacro=False, sdf=True)


@pytest.mark.parametrize("entry", [
    {"model": "my_simulations/../../x.urdf.xacro"}, {"model": "my_simulations/a/../../../x.urdf"},
    {"model": "../x.urdf"}, {"model": "./x.urdf"}, {"model": "my_simulations//etc/x.urdf"},
    {"model": "../../x", "model_type": "urdf.xacro"}])
def test_a_file_outside_of_its_package_is_refused(entry):
    place = {"position": [0, 0, 0], "orientation": [0, 0, 0]}
    found = parse_objects({"a": {**place, **entry}, "b": {**place, "model": "p/x..y.urdf"}},
                          Source("/objects"))
    assert [issue.code for issue in found.faults["a"]] == ["object-file-outside"]
    assert list(found.objects) == ["b"]


def test_one_faulty_object_leaves_the_others_usable():
    good = {"model": "p/o.urdf", "position": [0, 0, 0], "orientation": [0, 0, 0]}
    listing = parse_objects({"bad": {"model": 3}, "good": good}, Source("/objects"))
    assert list(listing.objects) == ["good"]
    assert len(listing.faults["bad"]) == 3


def test_children_of_a_misplaced_parent_are_not_spawned_somewhere_else():
    child = {"model": "p/o.urdf", "position": [0, 0, 0], "orientation": [0, 0, 0]}
    listing = parse_objects(
        {"shelf": {"model": "p/s.urdf", "orientation": [0, 0, 0], "children": {"tin": child}}},
        Source("/objects"))
    assert listing.objects == {}
    assert [i.code for i in listing.faults["shelf_tin"]] == ["parent-faulty"]


def test_an_unknown_key_is_a_warning_with_the_key_that_was_meant():
    listing = parse_objects({"box": {"model": "p/o.urdf", "postion": [0, 0, 0],
                                     "position": [0, 0, 0], "orientation": [0, 0, 0]}},
                            Source("/objects"))
    (issue,) = listing.issues()
    assert issue.severity is Severity.WARNING
    assert "position" in issue.hint
    assert "box" in listing.objects


def test_a_key_given_twice_is_a_warning_with_both_lines(tmp_path):
    path = tmp_path / "twice.yaml"
    path.write_text("box: {}\nball: {}\nbox: {}\n")
    _, _, issues = read_yaml(str(path), "/objects")
    assert [(i.code, i.line) for i in issues] == [("repeated-key", 3)]
    assert "line 1" in issues[0].hint


@pytest.mark.parametrize("text", ["", "# nothing yet\n", "---\n"])
def test_an_empty_file_is_an_empty_list(tmp_path, text):
    path = tmp_path / "empty.yaml"
    path.write_text(text)
    assert listing_of(path).objects == {}
    assert listing_of(path).issues() == []


def test_a_list_that_contains_itself_is_refused_at_its_line(tmp_path):
    path = tmp_path / "cycle.yaml"
    path.write_text("box: &box\n  model: p/o.urdf\n  position: [0, 0, 0]\n"
                    "  orientation: [0, 0, 0]\n  children:\n    inner: *box\n")
    with pytest.raises(InputError) as caught:
        listing_of(path)
    [issue] = caught.value.issues
    assert (issue.line, issue.xpath) == (6, "/objects/box/children/inner")


def nested():
    tree, source, _ = read_yaml(str(VALID / "groups.yaml"), "/object_groups")
    groups, issues = parse_groups(tree, source)
    assert issues == []
    return listing_of(VALID / "cob_nested.yaml"), groups


def test_all_selects_every_object_in_the_order_of_the_list():
    listing, groups = nested()
    selection = select(["shelf_pallet_tin", "all"], listing, groups)
    assert [o.name for o in selection.objects] == ["shelf_pallet_tin", "shelf", "shelf_pallet"]
    assert selection.issues == []


def test_groups_and_names_add_up_and_nothing_is_selected_twice():
    listing, groups = nested()
    selection = select(["shelves", "shelf", "shelf_pallet_tin"], listing, groups)
    assert [o.name for o in selection.objects] == ["shelf", "shelf_pallet", "shelf_pallet_tin"]


def test_group_members_may_carry_the_child_before_the_parent():
    listing, groups = nested()
    selection = select(["old_order"], listing, groups)
    assert [o.name for o in selection.objects] == ["shelf_pallet", "shelf_pallet_tin"]
    assert selection.issues == []


def test_naming_a_parent_selects_it_without_its_children():
    listing, groups = nested()
    assert [o.name for o in select(["shelf"], listing, groups).objects] == ["shelf"]


def test_an_unknown_name_is_an_error_with_the_closest_known_ones():
    listing, groups = nested()
    selection = select(["Shelf_palet", "shelf"], listing, groups)
    assert [o.name for o in selection.objects] == ["shelf"]
    (issue,) = selection.issues
    assert issue.code == "unknown-object"
    assert "'Shelf_palet'" in issue.message
    assert "shelf_pallet" in issue.hint


def test_an_unknown_member_of_a_group_is_an_error_that_names_the_group():
    listing, _ = nested()
    selection = select(["mine"], listing, {"mine": ["shelf", "ghost"]})
    assert [o.name for o in selection.objects] == ["shelf"]
    assert "'ghost'" in selection.issues[0].message
    assert "'mine'" in selection.issues[0].message


def test_faults_of_objects_that_were_not_asked_for_are_not_reported():
    good = {"model": "p/o.urdf", "position": [0, 0, 0], "orientation": [0, 0, 0]}
    listing = parse_objects({"bad": {}, "good": good}, Source("/objects"))
    assert select(["good"], listing, {}).issues == []
    assert len(select(["bad"], listing, {}).issues) == 3
    assert len(select(["all"], listing, {}).issues) == 3


@pytest.mark.parametrize("tree,code", [
    ([1], "groups-wrong-type"), ({"g": "shelf"}, "group-wrong-type"),
    ({"g": [1]}, "group-member"), ({3: []}, "group-name")])
def test_a_faulty_group_is_an_error_and_left_out(tree, code):
    groups, issues = parse_groups(tree, Source("/object_groups"))
    assert groups == {}
    assert [i.code for i in issues] == [code]


def test_the_closest_names_ignore_letter_case():
    assert closest("my_object", ["table", "MY_OBJECT", "shelf"]) == ["MY_OBJECT"]
