"""Checks of world files, without running them."""
from __future__ import annotations

import re

import pytest

from my_simulations.grading.assignment_file import read_assignment
from my_simulations.grading.file_checks import (
    check_files,
    invalid_model_file,
    read_world_file,
)
from my_simulations.resources.resolver import Resolver

BOX = """<model name="{name}"><static>{static}</static><link name="l"><visual name="v"><geometry>
<box><size>1 1 1</size></box></geometry></visual></link></model>"""
WORLD = """<sdf version="1.6"><world name="w">
<light name="sun" type="point"/>{}</world></sdf>"""
MISSING = "the submission contains no *.world; it is empty"
CHECKS = """submission: {world: "*.world"}
checks:
"""


def results(folder, text, *checks):
    (folder / "lab.yaml").write_text(CHECKS + "".join(f"  - {check}\n" for check in checks))
    assignment, _ = read_assignment(str(folder / "lab.yaml"))
    if text is None:
        return check_files(assignment, None, MISSING)
    (folder / "a.world").write_text(text)
    return check_files(assignment, read_world_file(str(folder), "a.world", Resolver([])),
                       MISSING)


def models(*names, static="true"):
    return WORLD.format("".join(BOX.format(name=name, static=static) for name in names))


@pytest.mark.parametrize("count, points, reason", [
    ("count: static, at_least: 2", 4, "found a, b"),
    ("count: static, at_least: 2, not: [a]", 0, "1 static model besides a, 2 are needed"),
    ("count: static, at_least: 2, not: [a], partial: true", 2, "1 static model"),
    ("count: static, at_least: 4, partial: true", 2, "2 static models"),
    ("count: static, at_most: 1", 0, "at most 1"),
    ("count: dynamic, exactly: 0", 4, ""),
    ("count: model, shape: box, exactly: 2", 4, "found a, b"),
    ("count: model, shape: sphere, at_least: 1", 0, "0 models with the shape sphere"),
    ("count: light, exactly: 1", 4, "sun"),
    ("count: link, exactly: 2", 4, "l, l"),
])
def test_entities_are_counted(tmp_path, count, points, reason):
    (found,) = results(tmp_path, models("a", "b"), "{points: 4, " + count + "}")
    assert (found.points, found.passed) == (points, points == 4)
    assert reason in found.reason


def test_faults_of_a_file_are_told_with_line(tmp_path):
    text = models("a").replace("<box>", "\n<box>").replace("1 1 1", "1 one 1")
    lenient, strict = results(tmp_path, text, "{points: 1, check_model: lenient, name: l}",
                              "{points: 1, check_model: strict, name: s}")
    assert strict.points == 0 and strict.file == "a.world" and strict.line == 4
    assert "one" in strict.reason
    unclosed = models("a").replace("</box>", "<a></box>")
    lenient, strict = results(tmp_path, unclosed, "{points: 1, check_model: lenient, name: l}",
                              "{points: 1, check_model: strict, name: s}")
    assert (lenient.points, strict.points) == (1, 0) and "never closed" in strict.reason
    broken, counted = results(tmp_path, "<sdf><world>", "{points: 1, check_model: lenient}",
                              "{points: 1, count: model, at_least: 1}")
    assert (broken.points, counted.points) == (0, 0)
    assert counted.reason.startswith("the world file cannot be read: ")


def test_faults_of_a_file_are_in_the_order_of_its_lines(tmp_path):
    text = models("a", "b", "c").replace("<box>", "\n<box>").replace("1 1 1", "1 one 1")
    text = text.replace("<world", "\n<world").replace("<link", "<pose>a</pose>\n<link")
    found, = results(tmp_path, text, "{points: 1, check_model: strict}")
    lines = [found.line, *map(int, re.findall(r"; line (\d+):", found.reason))]
    assert len(lines) == 4 and lines == sorted(lines), found.reason


def test_a_wrong_end_tag_leaves_no_points_for_the_content(tmp_path):
    wrong = models("a").replace("</box>", "\n</bx>")
    for found in results(tmp_path, wrong, "{points: 1, check_model: lenient}",
                         "{points: 1, count: model, at_least: 1}"):
        assert found.points == 0 and "</bx> closes nothing" in found.reason
        assert (found.file, found.line) == ("a.world", 4)


def test_the_first_model_file_that_does_not_parse_is_found(tmp_path):
    robot = "<robot name='r'>\n<link name='l'>{}</link></robot>"
    texts = {"right.urdf": robot.format(""), "open.urdf": robot.format("<mesh>"),
             "unknown.urdf": robot.format("<word/>"), "wrong.urdf": robot.format("\n</visul>")}
    for name, text in texts.items():
        (tmp_path / name).write_text(text)
    fault = invalid_model_file(str(tmp_path), list(texts), Resolver())
    assert (fault.file, fault.line, fault.message) == ("wrong.urdf", 3, "</visul> closes nothing")
    assert invalid_model_file(str(tmp_path), list(texts)[:3], Resolver()) is None


def test_a_submission_without_a_world_gets_no_points(tmp_path):
    found = results(tmp_path, None, "{points: 1, check_model: lenient}",
                    "{points: 1, count: model, at_least: 1}")
    assert [one.points for one in found] == [0, 0]
    assert {one.reason for one in found} == {MISSING}
