"""rosparam's angle forms in object lists."""
from __future__ import annotations

import math

import pytest
import yaml

from my_simulations.errors import InputError
from my_simulations.objects.object_list import parse_objects
from my_simulations.objects.yaml_source import read_yaml

ENTRY = "lamp:\n  model: cob_gazebo_objects/objects/lamp.urdf\n  position: [0, 0, 0]\n"


def written(tmp_path, angle):
    path = tmp_path / "object_locations.yaml"
    path.write_text(f"{ENTRY}  orientation: [0, 0, {angle}]\n")
    return str(path)


@pytest.mark.parametrize(("angle", "value"), [
    ("deg(90)", math.pi / 2), ("deg( -45.5 )", math.radians(-45.5)), ("deg(1e1)", math.pi / 18),
    ("!degrees 90", math.pi / 2), ("!degrees deg(90)", math.pi / 2),
    ("rad(pi/2)", math.pi / 2), ("rad(-pi)", -math.pi), ("rad(2*pi/3)", 2 * math.pi / 3),
    ("rad(1.5)", 1.5), ("rad(pi/2 + 0.1)", math.pi / 2 + 0.1), ("rad(1e-1-pi)", 0.1 - math.pi),
    ("rad(3*-pi/4)", -3 * math.pi / 4), ("!radians pi", math.pi), ("!radians 1", 1.0)])
def test_angle_forms_of_an_object_list_are_radians(tmp_path, angle, value):
    tree, source, issues = read_yaml(written(tmp_path, angle), "/objects", angles=True)
    assert tree["lamp"]["orientation"][2] == pytest.approx(value, abs=1e-12)
    listing = parse_objects(tree, source)
    assert [*issues, *listing.issues()] == []
    assert listing.objects["lamp"].rpy == (0.0, 0.0, pytest.approx(value, abs=1e-12))


@pytest.mark.parametrize(("angle", "words"), [
    ("deg(north)", "'north' is not a number of degrees"), ("!degrees ''", "number of degrees"),
    ("rad(tau)", "'tau' is not an angle in radians"), ("rad()", "'' is not an angle"),
    ("rad(2 pi)", "3*pi/4"), ("rad(pi/0)", "division by zero"), ("rad(2**9)", "not an angle"),
    ("!radians __import__('os').getcwd(", "not an angle"), ("!radians [1]", "scalar"),
    ("!degrees " + "9" * 2000, "more than 1000 characters")])
def test_an_angle_that_is_not_understood_has_a_line_and_key(tmp_path, angle, words):
    file = written(tmp_path, angle)
    with pytest.raises(InputError) as raised:
        read_yaml(file, "/objects", angles=True)
    [issue] = raised.value.issues
    assert (issue.file, issue.line, issue.xpath) == (file, 4, "/objects/lamp/orientation")
    assert words in issue.message


def test_without_angle_forms_they_are_texts_and_their_tags_unknown(tmp_path):
    tree, _, _ = read_yaml(written(tmp_path, "deg(90)"), "")
    assert tree["lamp"]["orientation"][2] == "deg(90)"
    with pytest.raises(InputError, match="could not determine a constructor"):
        read_yaml(written(tmp_path, "!radians pi"), "")


def test_what_is_added_to_the_safe_loader_changes_nothing(tmp_path, monkeypatch):
    # As rosparam does when it is imported; it hands the text to eval.
    monkeypatch.setattr(yaml.SafeLoader, "yaml_constructors",
                        dict(yaml.SafeLoader.yaml_constructors))
    yaml.SafeLoader.add_constructor("!radians", lambda loader, node: 7.0)
    with pytest.raises(InputError, match="could not determine a constructor"):
        read_yaml(written(tmp_path, "!radians pi"), "")
