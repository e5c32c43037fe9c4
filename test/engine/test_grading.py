"""Grading of world files, from the command line to the pages."""
from __future__ import annotations

import contextlib
import csv
import io
import json
import os
import zipfile

import numpy as np
import pytest
from PIL import Image

from my_simulations.cli.grade_command import main
from my_simulations.errors import CommandError
from my_simulations.grading import grade as grade_module

BALL = """<model name="{name}"><pose>{x} 0 {z} 0 0 0</pose><link name="l">
<inertial><mass>1</mass><inertia><ixx>.004</ixx><iyy>.004</iyy><izz>.004</izz></inertia></inertial>
<collision name="c"><geometry><sphere><radius>0.1</radius></sphere></geometry></collision>
<visual name="v"><geometry><sphere><radius>0.1</radius></sphere></geometry></visual>
</link></model>"""
WORLD = """<sdf version="1.6"><world name="w"><include><uri>model://ground_plane</uri></include>
{}</world></sdf>"""
LAB = """lab: fall
submission: {world: "*.world"}
checks:
  - {points: 1, name: valid, check_model: strict}
  - {points: 4, name: place, place: ball, at: [0, 0, 1.775], within: 0.5, tolerance: 0.01,
     partial: 1.01}
  - {points: 4, name: ground, require: pose.ball.z < 0.11, within: 3,
     partial: 1 - min(pose.ball.z)}
  - {points: 1, name: apart, no_contact: [ball, ground_plane], within: 0.5}
  - {points: 1, name: landed, no_contact: [ball, ground_plane], within: 3}
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    (tmp_path / "lab.yaml").write_text(LAB)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def submit(folder, student, *balls):
    (folder / student).mkdir(exist_ok=True)
    (folder / student / "a.world").write_text(WORLD.format("".join(
        BALL.format(name=name, x=x, z=z) for name, x, z in balls)))


def grade(folder, *words):
    status = main(["grade", "lab.yaml", *words, "--out", "marks"])
    with open(folder / "marks" / "marks.csv", newline="") as stream:
        return status, {row["student"]: row for row in csv.DictReader(stream)}


def points(row):
    return [float(row[name]) for name in ("valid", "place", "ground", "apart", "landed")]


def assert_shows_a_ball(path):
    with Image.open(path) as picture:
        assert picture.size == (640, 400)
        grey = np.asarray(picture.convert("L"), dtype=float)
    middle = grey[160:240, 280:360]
    assert middle.max() - middle.min() > 20.0   # the ball and its shading; a plain ground has less


def test_worlds_are_run_and_marked_with_partial_points(folder, capsys):
    submit(folder, "good", ("ball", 0, 3))
    submit(folder, "near", ("ball", 0.51, 3))
    submit(folder, "none", ("cube", 0, 3))
    (folder / "broken").mkdir()
    (folder / "broken" / "a.world").write_text("<sdf version='1.6'>\n<world>")
    (folder / "empty").mkdir()
    submit(folder, "tag", ("ball", 0, 3))
    text = (folder / "tag" / "a.world").read_text()
    (folder / "tag" / "a.world").write_text(text.replace("</collision>", "</colision>"))
    status, rows = grade(folder, "good", "near", "none", "broken", "empty", "tag", "--jobs", "2")
    assert status == 0, capsys.readouterr().err
    assert points(rows["good"]) == [1, 4, 4, 1, 0]
    assert points(rows["near"]) == [1, 2, 4, 1, 0]
    assert points(rows["none"]) == [1, 0, 0, 0, 0]
    assert points(rows["broken"])[1:] == points(rows["empty"])[1:] == [0, 0, 0, 0]
    assert points(rows["tag"]) == [0, 0, 0, 0, 0]
    students = folder / "marks" / "students"
    page = (students / "tag" / "index.html").read_text()
    assert page.count("&lt;/colision&gt; closes nothing") == 2 and "a.world:4" in page
    found = json.loads((students / "near" / "results.json").read_text())
    assert "0.510 m from its place" in found["tests"][1]["output"]
    assert "touches ground_plane at 0." in found["tests"][4]["output"]
    assert "no model" in (students / "none" / "index.html").read_text()
    assert "a.world:2" in (students / "broken" / "index.html").read_text()
    assert 'src="picture.png"' in (students / "good" / "index.html").read_text()
    assert_shows_a_ball(students / "good" / "picture.png")
    assert 'id="data"' in (students / "good" / "replay.html").read_text(encoding="utf-8")


def test_an_unchanged_submission_keeps_its_mark_and_a_changed_one_is_graded_again(folder, capsys):
    submit(folder, "anna", ("ball", 0, 3))
    submit(folder, "ben", ("ball", 0, 3))
    grade(folder, "anna", "ben")
    times = {name: os.stat(folder / "marks" / "students" / name / "mark.json").st_mtime_ns
             for name in ("anna", "ben")}
    submit(folder, "ben", ("ball", 0.51, 3))
    capsys.readouterr()
    status, rows = grade(folder, "anna", "ben")
    assert (status, points(rows["anna"])[1], points(rows["ben"])[1]) == (0, 4, 2)
    told = capsys.readouterr().err
    assert "anna: 10 of 11, unchanged" in told and "ben: 8 of 11\n" in told
    now = {name: os.stat(folder / "marks" / "students" / name / "mark.json").st_mtime_ns
           for name in ("anna", "ben")}
    assert now["anna"] == times["anna"] and now["ben"] != times["ben"]
    text = LAB.replace("points: 1, name: valid", "points: 2, name: valid")
    (folder / "lab.yaml").write_text(text)
    assert points(grade(folder, "anna")[1]["anna"])[0] == 2


def test_a_world_that_exceeds_the_time_leaves_the_checks_before_it(folder, capsys):
    (folder / "lab.yaml").write_text(LAB.replace("within: 3", "within: 3000").replace(
        "lab: fall", "lab: fall\nlimits: {seconds: 4}\nsample: 0.001"))
    submit(folder, "slow", *((f"ball{n}" if n else "ball", n, 3) for n in range(60)))
    status, rows = grade(folder, "slow")
    assert (status, rows["slow"]["status"]) == (1, "timed out")
    assert points(rows["slow"])[2:] == [0, 0, 0] or points(rows["slow"])[3] == 1
    assert "not finished within 4 s" in (
        folder / "marks" / "students" / "slow" / "index.html").read_text()


def test_programs_do_not_run_where_they_cannot_be_isolated(folder, capsys, monkeypatch):
    monkeypatch.setattr(grade_module, "isolation_fault",
                        lambda: "this system permits no namespaces")
    submit(folder, "anna", ("ball", 0, 3))
    status, rows = grade(folder, "anna")
    assert (status, points(rows["anna"])[0]) == (0, 1)
    assert "world files are graded without isolation" in capsys.readouterr().err
    (folder / "lab.yaml").write_text(LAB.replace('world: "*.world"', "run: go.py").replace(
        "lab: fall", "lab: fall\nworld: worlds/empty.world"))
    assert main(["grade", "lab.yaml", "anna", "--out", "other"]) == 2
    assert "--no-isolation" in capsys.readouterr().err
    assert not (folder / "other").exists()


def test_a_program_grades_by_the_function_of_the_library(folder):
    submit(folder, "anna", ("ball", 0, 3))
    kept = []
    for expected in ([False], [True]):
        done = grade_module.grade("lab.yaml", ["anna"], "marks",
                                  told=lambda mark, was_kept: kept.append(was_kept))
        assert [(mark.student, mark.points) for mark in done.marks] == [("anna", 10.0)]
        assert kept == expected
        assert all(os.path.exists(file) for file in done.files)
        kept.clear()
    with pytest.raises(CommandError, match="nobody"):
        grade_module.grade("lab.yaml", ["nobody"])


def test_a_submission_that_is_too_large_is_told_so(folder):
    (folder / "lab.yaml").write_text(LAB.replace("lab: fall", "lab: fall\nlimits: {file_mb: 1}"))
    submit(folder, "large", ("ball", 0, 3))
    (folder / "large" / "video.avi").write_bytes(bytes(2_000_000))
    _, rows = grade(folder, "large")
    assert points(rows["large"]) == [0, 0, 0, 0, 0]
    assert "the limit is 1 MB" in (
        folder / "marks" / "students" / "large" / "index.html").read_text()


def test_a_replay_that_is_too_large_is_left_out_with_a_note(folder):
    text = LAB.replace("lab: fall", "lab: fall\nlimits: {replay_mb: 0.1}")
    (folder / "lab.yaml").write_text(text)
    submit(folder, "anna", ("ball", 0, 3))
    _, rows = grade(folder, "anna")
    assert points(rows["anna"]) == [1, 4, 4, 1, 0]
    student = folder / "marks" / "students" / "anna"
    assert not (student / "replay.html").exists()
    page = (student / "index.html").read_text()
    assert "there is no replay" in page and "the limit is 0.1 MB" in page


def test_archives_are_graded_as_the_folders_that_they_contain(folder):
    submit(folder, "anna", ("ball", 0, 3))
    with zipfile.ZipFile(folder / "ben.zip", "w") as packed:
        packed.write(folder / "anna" / "a.world", "Lab 1/a.world")
        packed.writestr("Lab 1/old/b.world", "<sdf/>")
    with zipfile.ZipFile(folder / "bomb.zip", "w", zipfile.ZIP_DEFLATED) as packed:
        packed.writestr("a.world", bytes(300_000_000))
    _, rows = grade(folder, "anna", "ben.zip", "bomb.zip")
    assert points(rows["anna"]) == points(rows["ben"]) == [1, 4, 4, 1, 0]
    assert points(rows["bomb"]) == [0, 0, 0, 0, 0] and rows["bomb"]["status"] == "graded"
    students = folder / "marks" / "students"
    page = (students / "ben" / "index.html").read_text()
    assert "Lab 1/a.world was graded" in page and "*.world: Lab 1/old/b.world" in page
    assert "cannot be unpacked: the archive contains more than" in (
        students / "bomb" / "index.html").read_text()
    assert "ben: 10 of 11, unchanged" in graded_again(folder, "ben.zip")


def graded_again(folder, *words):
    """What a second grading reports."""
    with contextlib.redirect_stderr(io.StringIO()) as said:
        grade(folder, *words)
    return said.getvalue()


def test_names_and_sizes_of_files_harm_no_other_mark(folder):
    submit(folder, "good", ("ball", 0, 3))
    for name in ("a\n,\"<b>", os.fsdecode(b"\xff")):
        submit(folder, name, ("ball", 0, 3))
        (folder / name / os.fsdecode(b"\xfe\n,.txt")).write_text("a")
    submit(folder, "many", ("ball", 0, 3))
    for number in range(1000):
        (folder / "many" / f"{number:0200}").write_text("")
    submit(folder, "endless", ("ball", 0, 3))
    with open(folder / "endless" / "sparse", "wb") as stream:
        stream.truncate(1 << 42)
    names = [path.name for path in folder.iterdir() if path.is_dir()]
    assert len(names) == 5
    status, rows = grade(folder, *names, "--jobs", "2")
    assert (status, points(rows.pop("endless"))) == (0, [0, 0, 0, 0, 0])
    assert [points(row) for row in rows.values()] == [[1, 4, 4, 1, 0]] * 4
    assert "a\n,\"<b>" in rows
    page = (folder / "marks" / "index.html").read_text()
    assert "students/%FF/index.html" in page
    assert "<b>" not in page.replace('<td class="number"><b>', "")


def test_an_invalid_assignment_or_command_line_ends_with_2(folder, capsys):
    (folder / "bad.yaml").write_text("checks:\n  - {points: x}\n")
    assert main(["grade", "bad.yaml", "anna"]) == 2
    assert "bad.yaml:2: error: a check has exactly one of the keys" in capsys.readouterr().err
    assert main(["grade", "lab_shet", "anna"]) == 2
    assert "there is no assignment 'lab_shet': it is neither a file nor one of drive_square" in (
        capsys.readouterr().err)
    assert main(["grade", "lab.yaml", "nobody"]) == 2
    assert main(["grade", "lab.yaml", "--check"]) == 0
    assert "5 checks, 11 points" in capsys.readouterr().out
    assert main(["grade", "lab_sheet", "--check"]) == 0
