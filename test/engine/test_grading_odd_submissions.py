"""Submissions that are odd: archives, links, permissions, and folders that change meanwhile."""
from __future__ import annotations

import io
import os
import shutil
import stat
import tarfile
import zipfile

import pytest

from my_simulations.grading import grader
from my_simulations.grading.grade import grade
from my_simulations.grading.mark import FAILED, GRADED
from my_simulations.grading.submission_files import MOST_FILES

WORLD = """<sdf version="1.6"><world name="w"><model name="ball"><link name="l"><visual name="v">
<geometry><sphere><radius>0.1</radius></sphere></geometry></visual></link></model></world></sdf>"""
LAB = """submission: {world: "*.world"}
limits: {file_mb: 5}
checks:
  - {points: 2, name: valid, check_model: strict}
  - {points: 1, name: ball, require: pose.ball.z < 0.0, within: 0.1}
"""


def zipped(path, *entries):
    with zipfile.ZipFile(path.with_suffix(".zip"), "w", zipfile.ZIP_DEFLATED) as packed:
        for name, content in entries:
            packed.writestr(name, content)


def archive_of_links(path):
    with tarfile.open(path.with_suffix(".tar.gz"), "w:gz") as packed:
        for name, kind, target in (("a.world", tarfile.SYMTYPE, str(path.parent / "good/a.world")),
                                   ("b.world", tarfile.LNKTYPE, "/etc/passwd"),
                                   ("c.world", tarfile.CHRTYPE, "")):
            entry = tarfile.TarInfo(name)
            entry.type, entry.linkname = kind, target
            packed.addfile(entry, io.BytesIO())


def folder_of_links(path):
    path.mkdir()
    (path / "a.world").symlink_to(path.parent / "good" / "a.world")
    (path / "all").symlink_to(path.parent)


def folder_of_devices(path):
    path.mkdir()
    os.mkfifo(path / "a.world")
    if os.getuid() == 0:
        os.mknod(path / "b.world", 0o666 | stat.S_IFCHR, os.makedev(1, 5))   # /dev/zero


def file_without_permissions(path):
    path.mkdir()
    (path / "a.world").write_text(WORLD)
    (path / "a.world").chmod(0)


def folder_without_permissions(path):
    (path / "lab").mkdir(parents=True)
    (path / "lab" / "a.world").write_text(WORLD)
    (path / "lab").chmod(0)


def many_files(path):
    path.mkdir()
    for number in range(MOST_FILES + 1):
        (path / str(number)).touch()


def deep_folder(path):
    (path / os.path.join(*60 * ["a"])).mkdir(parents=True)


def long_name(path):
    path.mkdir()
    (path / "a.world").write_text(WORLD.replace("ball", 100_000 * "b"))


ODD = {
    "bomb": (lambda path: zipped(path, ("a.world", bytes(50_000_000))),
             "cannot be unpacked: the archive contains more than"),
    "dots": (lambda path: zipped(path, ("../good/a.world", "<sdf/>")),
             "cannot be unpacked: the archive contains a path outside its folder"),
    "absolute": (lambda path: zipped(path, ("/tmp/odd.world", "<sdf/>")),
                 "cannot be unpacked: the archive contains a path outside its folder"),
    "deep_archive": (lambda path: zipped(path, (300 * "a/" + "a.world", WORLD)),
                     "cannot be unpacked: the archive has more than 50 folders in each other"),
    "archive_of_links": (archive_of_links, "contains no *.world; it is empty"),
    "folder_of_links": (folder_of_links, "contains no *.world; it is empty"),
    "devices": (folder_of_devices, "contains no *.world; it is empty"),
    "empty": (lambda path: path.mkdir(), "contains no *.world; it is empty"),
    "closed_file": (file_without_permissions, "a.world cannot be read: its permissions forbid it"),
    "closed_folder": (folder_without_permissions,
                      "left out, because their permissions forbid reading: lab"),
    "many": (many_files, f"cannot be graded: it has more than {MOST_FILES} files"),
    "deep": (deep_folder, "cannot be graded: it has more than 50 folders in each other"),
    "long_name": (long_name, "the world has no model or link")}
"""How to make each submission, and what the page of the student says of it."""

ENCODED = "Lösung "   # as macOS stores names: o and a combining mark


def content(folder):
    """Content and time of each file below a folder."""
    return {str(path): (path.read_bytes(), path.stat().st_mtime_ns)
            for path in sorted(folder.rglob("*")) if path.is_file()}


def submit(folder, student):
    (folder / student).mkdir()
    (folder / student / "a.world").write_text(WORLD)
    return str(folder / student)


@pytest.fixture(scope="module")
def graded(tmp_path_factory):
    """Folder and marks by student of a class with all odd submissions, and two good ones."""
    folder = tmp_path_factory.mktemp("odd")
    (folder / "lab.yaml").write_text(LAB)
    submissions = folder / "submissions"
    submissions.mkdir()
    submit(submissions, "good")
    for name, (make, _) in ODD.items():
        make(submissions / name)
    with zipfile.ZipFile(submissions / "encoded.zip", "w") as packed:
        packed.writestr(ENCODED + "/a.world", WORLD)
        packed.writestr("caf\udce9.txt".encode("utf-8", "surrogateescape").decode("cp437"), "a")
    before = content(submissions / "good")
    paths = [str(submissions / "good"), *sorted(
        str(path) for path in submissions.iterdir() if path.name != "good"),
        submit(submissions, "last")]
    try:
        marks = grade(str(folder / "lab.yaml"), paths, str(folder / "marks"), jobs=2).marks
    finally:
        (submissions / "closed_folder" / "lab").chmod(0o700)
    assert content(submissions / "good") == before
    return folder, {mark.student: mark for mark in marks}


@pytest.mark.parametrize("name", list(ODD))
def test_the_page_of_an_odd_submission_names_the_reason(graded, name):
    folder, marks = graded
    assert (marks[name].status, marks[name].points) == (GRADED, 2.0 if name == "long_name" else 0.0)
    page = (folder / "marks" / "students" / name / "index.html").read_text()
    assert ODD[name][1] in page, page
    assert sum(path.stat().st_size for path in (folder / "marks" / "students" / name).iterdir()
               if path.name != "replay.html") < 1e5


@pytest.mark.parametrize("name", ["good", "last", "encoded"])
def test_odd_submissions_change_no_other_mark(graded, name):
    _, marks = graded
    assert (marks[name].status, marks[name].points, marks[name].notes) == (GRADED, 3.0, [])


def test_submissions_that_are_changed_or_deleted_meanwhile(tmp_path, monkeypatch):
    (tmp_path / "lab.yaml").write_text(LAB)
    paths = [submit(tmp_path, name) for name in ("anna", "changed", "gone", "later", "zoe")]
    in_box = grader.grade_in_box

    def disturbed(assignment, submission, *more):
        if submission.student == "gone":
            shutil.rmtree(submission.path)
        mark = in_box(assignment, submission, *more)
        if submission.student == "changed":
            (tmp_path / "changed" / "a.world").write_text("<sdf>")
        if submission.student == "later":
            shutil.rmtree(submission.path)
        return mark

    monkeypatch.setattr(grader, "grade_in_box", disturbed)
    marks = grade(str(tmp_path / "lab.yaml"), paths, str(tmp_path / "marks"), jobs=1).marks
    assert [(mark.status, mark.points) for mark in marks] == [
        (GRADED, 3.0), (GRADED, 3.0), (FAILED, 0.0), (GRADED, 3.0), (GRADED, 3.0)]
    assert "changed while it was graded" in marks[1].notes[0]
    assert "changed while it was graded" in marks[3].notes[0]
    assert marks[2].results[0].reason == "the submission was deleted"
    monkeypatch.undo()
    kept = {}
    again = grade(str(tmp_path / "lab.yaml"), [paths[0], paths[1]], str(tmp_path / "marks"),
                  told=lambda mark, was_kept: kept.update({mark.student: was_kept})).marks
    assert [mark.points for mark in again] == [3.0, 0.0]
    assert kept == {"anna": True, "changed": False}
