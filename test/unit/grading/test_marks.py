"""Marks, lists and pages; the stream of results; submissions and their content."""
from __future__ import annotations

import csv
import json
import os

import pytest
from lxml import etree

from my_simulations.errors import CommandError
from my_simulations.grading.assignment_file import read_assignment
from my_simulations.grading.lists import write_lists
from my_simulations.grading.mark import GRADED, TIMED_OUT, CheckResult, Mark, mark_of, score_check
from my_simulations.grading.pages import write_pages
from my_simulations.grading.program import PythonError, loop_place, python_error
from my_simulations.grading.program_choice import choose_program
from my_simulations.grading.result_stream import ResultReader, ResultWriter
from my_simulations.grading.submission import (
    content_key,
    describe_ambiguity,
    find_all_matching,
    find_matching,
    reason_for_no_match,
    submissions_of,
)


@pytest.fixture
def assignment(tmp_path):
    (tmp_path / "lab.yaml").write_text("submission: {world: a.world}\nchecks:\n"
                                       "  - {points: 2, name: valid, check_model: strict}\n"
                                       "  - {points: 3, name: many, count: model, at_least: 3}\n")
    return read_assignment(str(tmp_path / "lab.yaml"))[0]


@pytest.fixture
def marks(assignment):
    first, second = assignment.checks
    return [Mark("anna", GRADED, [score_check(first, 1.0), score_check(second, 1.0)],
                 files=["replay.html"]),
            Mark("<ben>", TIMED_OUT, [score_check(first, 0.0, "a <b> \x01 is wrong", "a.world", 7),
                                      score_check(second, 0.5, "too few")], ["a note"])]


def test_points_are_shares_and_are_rounded(assignment):
    check = assignment.checks[1]
    assert [score_check(check, share).points for share in (-1.0, 1.0 / 3.0, 0.5, 2.0)] == [
        0.0, 1.0, 1.5, 3.0]
    assert len(score_check(check, 0.0, 100_000 * "\x01").reason) == 1001
    mark = Mark("a", GRADED, [score_check(check, 0.5, "r", "f", 3)], key="k")
    assert mark_of(mark.to_json()) == mark


def test_lists_have_points_and_reasons(assignment, marks, tmp_path):
    write_lists(assignment, marks, str(tmp_path / "out"))
    with open(tmp_path / "out" / "marks.csv", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [(row["student"], row["points"], row["status"], row["many"]) for row in rows] == [
        ("anna", "5.0", "graded", "3.0"), ("<ben>", "1.5", "timed out", "1.5")]
    with open(tmp_path / "out" / "nbgrader.csv", newline="") as stream:
        (anna, _) = csv.DictReader(stream)
    assert (anna["assignment"], anna["student_id"], anna["score"], anna["max_score"]) == (
        "lab", "anna", "5.0", "5.0")
    found = json.loads((tmp_path / "out" / "students" / "<ben>" / "results.json").read_text())
    assert found["score"] == 1.5 and found["output"] == "a note"
    assert found["tests"][0] == {"name": "valid", "score": 0.0, "max_score": 2.0,
                                 "status": "failed", "output": "a.world:7: a <b> \x01 is wrong"}
    suites = etree.parse(str(tmp_path / "out" / "junit.xml")).getroot()
    assert [(one.get("name"), one.get("failures"), one.get("errors")) for one in suites] == [
        ("anna", "0", "0"), ("<ben>", "0", "2")]


def test_pages_show_reasons_and_lead_to_replays(assignment, marks, tmp_path):
    path = write_pages(assignment, marks, str(tmp_path / "out"))
    overview = open(path, encoding="utf-8").read()
    assert "students/anna/index.html" in overview and "&lt;ben&gt;" in overview
    assert "<ben>" not in overview and ">3.25<" in overview
    students = tmp_path / "out" / "students"
    assert 'src="replay.html"' in (students / "anna" / "index.html").read_text()
    page = (students / "<ben>" / "index.html").read_text()
    assert "a &lt;b&gt;" in page and "<code>a.world:7</code>" in page and "a note" in page


def test_a_page_shows_a_cause_once_that_several_checks_share(assignment, tmp_path):
    checks = assignment.checks
    cause = "it ended with exit status 1"
    for name, reasons in (("equal", [cause, cause]), ("noted", [f"no answer; {cause}", "too few"])):
        mark = Mark(name, GRADED, [score_check(check, 0.0, reason, "go.py", 3)
                                   for check, reason in zip(checks, reasons)],
                    [cause] if name == "noted" else [])
        write_pages(assignment, [mark], str(tmp_path))
        page = (tmp_path / "students" / name / "index.html").read_text()
        assert page.count(cause) == 1 and page.count("number\">0 of ") == 2
        assert ('rowspan="2"' in page) == (name == "equal")


def test_results_and_files_come_through_in_pieces(assignment, tmp_path):
    receiving, sending = os.pipe()
    writer = ResultWriter(sending)
    writer.isolation("files")
    writer.result(score_check(assignment.checks[0], 0.5, "why", "f", 2))
    writer.file("replay.html", b"line\nline\n\0")
    writer.note("a note")
    writer.end(True)
    with os.fdopen(receiving, "rb") as stream:
        data = stream.read()
    reader = ResultReader(str(tmp_path / "anna"), assignment.checks)
    assert all(reader.feed(data[at:at + 7]) for at in range(0, len(data), 7))
    assert reader.results == [CheckResult("valid", 2.0, 1.0, "why", "f", 2)]
    assert (reader.notes, reader.isolation, reader.ended) == (["a note"], "files", True)
    assert (tmp_path / "anna" / "replay.html").read_bytes() == b"line\nline\n\0"


@pytest.mark.parametrize("data", [
    b"text\n", b'{"file": "../x", "size": 1}\n', b'{"result": {"name": 1}}\n', b"x" * (1 << 17),
    b'{"result": {"name": "valid", "most": 2.0, "points": 6000.0}}\n',
    b'{"result": {"name": "valid", "most": 6000.0, "points": 6000.0}}\n',
    b'{"result": {"name": "other", "most": 2.0, "points": 2.0}}\n'])
def test_a_stream_that_is_invalid_is_not_read_further(assignment, tmp_path, data):
    (tmp_path / "lab.yaml").unlink()
    assert not ResultReader(str(tmp_path), assignment.checks).feed(data)
    assert os.listdir(tmp_path) == []


def test_submissions_are_named_and_their_content_decides(tmp_path):
    for name in ("anna", "ben"):
        (tmp_path / name / "world").mkdir(parents=True)
        (tmp_path / name / "world" / "test.world").write_text("<sdf/>")
    (tmp_path / "carl.world").write_text("<sdf/>")
    anna, ben, carl = submissions_of([str(tmp_path / name) for name in ("anna", "ben/",
                                                                        "carl.world")])
    assert [one.student for one in (anna, ben, carl)] == ["anna", "ben", "carl"]
    assert content_key(anna.path) == content_key(ben.path)
    assert content_key(anna.path, "other") != content_key(anna.path)
    before = content_key(anna.path)
    (tmp_path / "anna" / "world" / "test.world").write_text("<sdf></sdf>")
    assert content_key(anna.path) != before
    assert find_matching(anna.path, ("*.sdf", "test.world")) == "world/test.world"
    assert find_matching(anna.path, ("other.world",)) == ""
    (tmp_path / "anna" / "a.sdf").write_text("<sdf/>")
    patterns = ("*.world", "*.sdf", "a.*")
    assert find_all_matching(anna.path, patterns) == ["world/test.world", "a.sdf"]
    with pytest.raises(CommandError, match="the name anna"):
        submissions_of([str(tmp_path / "anna"), str(tmp_path / "anna")])
    with pytest.raises(CommandError, match="no submission"):
        submissions_of([str(tmp_path / "nobody")])


def test_names_in_another_case_and_hidden_files(tmp_path):
    for name in ("._a.py", "Go.PY", "b.py", "__MACOSX/lab/c.py", ".git/d.py", "e/go.py"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("")
    folder = str(tmp_path)
    assert find_matching(folder, ("go.py",)) == "e/go.py"
    assert find_matching(folder, ("GO.py", "*.py")) == "Go.PY"
    assert find_all_matching(folder, ("*.py",)) == ["b.py", "e/go.py"]
    assert describe_ambiguity(folder, ("b.py", "*.py")) == ""
    assert describe_ambiguity(folder, ("x.py", "*.py")) == (
        "b.py was graded, which has the fewest folders and then the first name; the"
        " submission contains more files that fit *.py: e/go.py")
    assert reason_for_no_match(folder, ("x.py", "y.py")).endswith(
        "no x.py or y.py; it contains ._a.py, Go.PY, b.py, e/go.py")
    (tmp_path / "empty").mkdir()
    assert reason_for_no_match(str(tmp_path / "empty"), ("x.py",)).endswith("it is empty")


NODE, MAIN = "import rospy\nrospy.init_node('a')\n", 'if __name__ == "__main__":\n    main()\n'


@pytest.mark.parametrize("files, chosen, reason", [
    ({"a.py": "x = 1", "b/c.py": NODE}, "b/c.py", "because it calls init_node"),
    ({"a.py": "# rospy.init_node()", "b.py": MAIN}, "b.py", "because it has a main program"),
    ({"a.py": NODE, "b.py": MAIN}, "a.py", "because it calls init_node"),
    ({"a.py": NODE, "b.py": NODE + MAIN}, "b.py", "because it calls init_node and has a main"),
    ({"a.py": NODE, "b.py": NODE}, "a.py", "which has the fewest folders and then the first name"),
    ({"a.py": "", "b.py": ""}, "a.py", "which has the fewest folders and then the first name"),
    ({"a.py": NODE, "go.py": ""}, "go.py", ""), ({"a.py": ""}, "a.py", ""),
    ({"a.txt": ""}, "", "")])
def test_the_program_is_the_file_that_starts_a_node(tmp_path, files, chosen, reason):
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    found = choose_program(str(tmp_path), ("go.py", "*.py"))
    assert found.name == chosen
    assert found.note.startswith(f"{chosen} was run, {reason}" if reason else "")
    assert bool(found.note) == bool(reason)


def test_the_error_of_a_program_has_its_file_and_line():
    output = """  File "/tmp/x/submission/go.py", line 7
    def on_odometry(message
                   ^
SyntaxError: '(' was never closed
"""
    folder = "/tmp/x/submission"
    assert str(python_error(output, folder)) == "go.py:7: SyntaxError: '(' was never closed"
    inner = output.replace("go.py", "lab/go.py").replace("SyntaxError", """
  File "/usr/lib/python3/dist-packages/rospy/core.py", line 12, in call
rospy.exceptions.ROSException""")
    assert str(python_error(inner, folder)) == (
        "lab/go.py:7: rospy.exceptions.ROSException: '(' was never closed")
    encoding = "SyntaxError: Non-UTF-8 code starting with '\\xf6' in file /tmp/go.py on line 3"
    assert str(python_error(encoding, folder)) == f"go.py:3: {encoding}"
    assert [python_error(text, folder) for text in ("done\n", "", "ValueError: x")] == 3 * [None]
    assert len(python_error(output.replace("closed", 1000 * "x"), folder).message) == 300


def test_the_place_of_an_endless_loop_is_that_in_the_submission():
    dump = """hello
Fatal Python error: Aborted

Thread 0x00007f (most recent call first):
  File "/usr/lib/python3.11/threading.py", line 320 in wait

Current thread 0x00007e (most recent call first):
  File "/usr/lib/python3.11/json.py", line 3 in loads
  File "/tmp/x/submission/lab/go.py", line 9 in loop
  File "/tmp/x/submission/lab/go.py", line 12 in <module>
"""
    assert loop_place(dump, "/tmp/x/submission") == PythonError("lab/go.py", 9, "")
    assert loop_place(dump, "/tmp/y") is None
    assert loop_place("Traceback", "/tmp/x/submission") is None
