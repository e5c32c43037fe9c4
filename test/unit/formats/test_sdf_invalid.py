"""Every fixture of test/data/invalid is refused, or read with the right complaint."""
import os

import pytest
from reading import INVALID, VALID, refusal

from my_simulations.description.validate import validate
from my_simulations.errors import InputError, Severity, errors_of, tolerated_as_errors
from my_simulations.formats.reading import parse_world, read_file, read_world
from my_simulations.resources.resolver import Resolver

MODEL_FAULTS = {
    "mass_zero.sdf": ("mass-not-positive", 5),
    "mass_negative.sdf": ("mass-not-positive", 5),
    "mass_words.sdf": ("bad-value", 5),
    "link_name_empty.sdf": ("name-empty", 3),
    "joint_name_empty.sdf": ("name-empty", 5),
    "nested_model_fault.sdf": ("mass-not-positive", 5),
    "robot_pose_nan.urdf": ("bad-value", 5),
    "robot_link_names_repeated.urdf": ("name-repeated", 7),
    "robot_two_roots.urdf": ("root-many", 7),
    "robot_joint_link_unknown.urdf": ("joint-link-unknown", 8),
    "robot_joint_type_unknown.urdf": ("joint-type-unknown", 8),
    "robot_joint_without_limit.urdf": ("joint-limit-missing", 8),
    "robot_xacro.urdf": ("xacro-unexpanded", 7),
    "robot_ring.urdf": ("root-missing", 1),
    "robot_empty.urdf": ("link-missing", 1),
}
"""Faults that make the model unusable, for Gazebo too: code of the first error, its line."""

PART_FAULTS = {
    "joint_link_missing.sdf": ("joint-link-missing", 5),
    "joint_type_missing.sdf": ("joint-type-missing", 5),
    "geometry_misspelt.sdf": ("geometry-unknown", 5),
    "geometry_missing.sdf": ("geometry-missing", 5),
    "friction_words.sdf": ("bad-value", 5),
    "robot_box_without_size.urdf": ("attribute-missing", 5),
}
"""Faults that Gazebo refuses the document for: an error, but a world keeps what is left."""

TOLERATED = {
    "box_size_negative.sdf": ("bad-shape", 5),
    "sphere_radius_negative.sdf": ("bad-shape", 5),
    "cylinder_length_negative.sdf": ("bad-shape", 5),
    "mesh_scale_zero.sdf": ("scale-zero", 5),
    "collision_mesh_missing.sdf": ("mesh-not-found", 5),
    "inertia_not_positive_definite.sdf": ("inertia-not-positive", 5),
    "inertia_zero.sdf": ("inertia-not-positive", 5),
    "inertia_nan.sdf": ("value-not-finite", 5),
    "pose_nan.sdf": ("value-odd", 5),
    "pose_words.sdf": ("value-odd", 5),
    "pose_of_five_numbers.sdf": ("value-odd", 5),
    "link_names_repeated.sdf": ("name-repeated", 4),
    "link_named_world.sdf": ("name-reserved", 3),
    "joint_names_repeated.sdf": ("name-repeated", 6),
    "joint_link_unknown.sdf": ("joint-link-unknown", 5),
    "joint_to_itself.sdf": ("joint-link-repeated", 5),
    "joint_axis_zero.sdf": ("joint-axis-zero", 5),
    "joint_axis_missing.sdf": ("joint-axis-missing", 5),
    "joint_type_unknown.sdf": ("joint-type-unknown", 5),
    "joint_limit_nan.sdf": ("value-not-finite", 5),
    "frame_unknown.sdf": ("frame-unknown", 3),
    "frame_cycle.sdf": ("frame-unknown", 3),
    "pose_twice.sdf": ("element-repeated", 6),
    "nested_include_missing.sdf": ("model-not-found", 4),
    "robot_box_size_negative.urdf": ("bad-shape", 5),
    "robot_collision_mesh_missing.urdf": ("mesh-not-found", 5),
    "robot_inertia_zero.urdf": ("inertia-not-positive", 2),
    "robot_two_parents.urdf": ("link-two-parents", 6),
    "robot_massless.urdf": ("link-missing", 2),
    "robot_joint_axis_zero.urdf": ("joint-axis-zero", 8),
}
"""Faults with which Gazebo loads the model, and so do we: code of the warning, its line."""

REFUSED = {
    "bare_model.sdf": "root-unknown",
    "no_model.sdf": "model-missing",
    "truncated_in_value.sdf": "xml-truncated",
    "truncated_before_root_ends.sdf": "xml-truncated",
    "truncated_in_tag.sdf": "xml-truncated",
    "not_xml.sdf": "xml-no-root",
    "empty_file.sdf": "xml-empty",
    "entity_bomb.sdf": "xml-entities",
    "entity_external.sdf": "xml-entities",
    "no_such_file.sdf": "file-not-found",
}


def invalid(name):
    return os.path.join(INVALID, name)


@pytest.mark.parametrize("name", sorted([*MODEL_FAULTS, *PART_FAULTS]))
def test_a_faulty_model_is_read_with_an_error_that_names_file_line_and_element(name):
    code, line = {**MODEL_FAULTS, **PART_FAULTS}[name]
    _, issues = read_file(invalid(name), Resolver())
    first = errors_of(issues)[0]
    assert (first.code, first.line) == (code, line)
    assert first.file == invalid(name)
    assert first.xpath.startswith(("/sdf/", "/robot"))


@pytest.mark.parametrize("name", sorted(n for n in MODEL_FAULTS if n.endswith(".sdf")))
def test_a_world_leaves_out_an_unusable_model_whole_and_keeps_the_rest(name):
    with open(invalid(name)) as stream:
        text = stream.read()
    start, end = text.index("<model"), text.rindex("</model>") + len("</model>")
    text = (text[:start] + "<world name='w'>" + text[start:end]
            + "<model name='good'><link name='l'/></model></world>" + text[end:])
    world, issues = parse_world(text, Resolver(), invalid(name))
    assert [model.name for model in world.models] == ["good"]
    assert MODEL_FAULTS[name][0] in [issue.code for issue in errors_of(issues)]


@pytest.mark.parametrize("name", sorted(n for n in PART_FAULTS if n.endswith(".sdf")))
def test_a_world_keeps_the_model_a_part_of_which_is_broken(name):
    with open(invalid(name)) as stream:
        text = stream.read()
    text = text.replace("<model", "<world name='w'><model").replace("</model>", "</model></world>")
    world, issues = parse_world(text, Resolver(), invalid(name))
    model = world.models[0]
    assert [link.name for link in model.links] in (["body"], ["a", "b"])
    assert model.joints == []
    assert len(model.links[0].collisions) == (1 if name == "friction_words.sdf" else 0)
    assert errors_of(issues)


@pytest.mark.parametrize("name", sorted(TOLERATED))
def test_what_gazebo_loads_is_loaded_with_a_warning_that_names_file_line_and_element(name):
    _, issues = read_file(invalid(name), Resolver())
    assert errors_of(issues) == []
    first = next(issue for issue in issues if issue.tolerated)
    assert (first.code, first.line) == TOLERATED[name]
    assert first.severity is Severity.WARNING
    assert first.file == invalid(name)
    assert first.xpath.startswith(("/sdf/", "/robot"))


@pytest.mark.parametrize("name", sorted(TOLERATED))
def test_what_is_tolerated_is_an_error_for_the_strict(name):
    _, issues = read_file(invalid(name), Resolver())
    first = errors_of(tolerated_as_errors(issues))[0]
    assert (first.code, first.line) == TOLERATED[name]


@pytest.mark.parametrize("name", sorted(REFUSED))
def test_a_document_with_nothing_usable_is_refused(name):
    fault = refusal(read_file, invalid(name), Resolver())
    assert fault.first.code == REFUSED[name]
    assert fault.first.severity is Severity.ERROR
    assert fault.first.file == invalid(name)


def test_every_fixture_for_the_readers_has_an_expectation():
    known = {*MODEL_FAULTS, *PART_FAULTS, *TOLERATED, *REFUSED}
    there = {n for n in os.listdir(INVALID) if n.endswith((".sdf", ".urdf"))}
    assert there == known - {"no_such_file.sdf"}


def test_a_misspelt_shape_is_answered_with_the_closest_known_one():
    _, issues = read_file(invalid("geometry_misspelt.sdf"), Resolver())
    assert "sphere" in errors_of(issues)[0].hint


def test_a_missing_world_file_is_refused():
    assert refusal(read_world, "/no/such.world", Resolver()).first.code == "file-not-found"


def test_a_folder_is_no_world_file():
    assert refusal(read_world, INVALID, Resolver()).first.code == "file-unreadable"


def test_a_file_without_world_is_refused():
    assert refusal(read_world, invalid("no_world.world"), Resolver()).first.code == "world-missing"


def test_an_unknown_include_lists_every_place_tried_and_the_rest_loads(tmp_path):
    resolver = Resolver([str(tmp_path / "one"), str(tmp_path / "two")])
    loaded = read_world(invalid("include_unknown.world"), resolver)
    world, issues = loaded.world, loaded.issues
    assert [model.name for model in world.models] == ["thing"]
    (issue,) = errors_of(issues)
    assert (issue.code, issue.line) == ("model-not-found", 3)
    for place in ("one", "two"):
        assert str(tmp_path / place / "no_such_model") in issue.message


def test_an_include_without_uri_is_left_out_and_the_rest_loads():
    loaded = read_world(invalid("include_without_uri.world"), Resolver())
    world, issues = loaded.world, loaded.issues
    assert [model.name for model in world.models] == ["thing"]
    assert [issue.code for issue in errors_of(issues)] == ["include-uri-missing"]


def test_a_step_size_of_zero_becomes_the_default():
    loaded = read_world(invalid("step_size_zero.world"), Resolver())
    world, issues = loaded.world, loaded.issues
    assert world.physics.max_step_size == 0.001
    assert [issue.code for issue in issues if issue.tolerated] == ["physics-range"]


def test_a_model_of_the_valid_fixtures_has_no_fault():
    model, issues = read_file(os.path.join(VALID, "everything.sdf"), Resolver())
    assert errors_of(issues) == []
    assert errors_of(validate(model)) == []


def test_a_service_text_that_is_garbage_is_refused_not_raised():
    from my_simulations.formats.reading import read_entity

    for garbage in ("", " ", "\0", "hello", "<", "<a", "</a>", "<a/>", "<robot", "{}", "<?xml?>"):
        with pytest.raises(InputError):
            read_entity(garbage, Resolver())
