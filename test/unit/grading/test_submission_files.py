"""The files of submissions whose folders contain anything."""
from __future__ import annotations

import os
import socket

import pytest

from my_simulations.grading import submission_files
from my_simulations.grading.box import open_regular
from my_simulations.grading.submission import content_key, reason_for_no_match
from my_simulations.grading.submission_files import SubmissionError, content_of


def names_of(path):
    return [name for name, _ in content_of(str(path)).files]


def test_links_and_special_files_are_left_out(tmp_path):
    (tmp_path / "a.txt").write_text("a")
    (tmp_path / "secret").symlink_to("/etc/passwd")
    (tmp_path / "folder").symlink_to("/etc")
    (tmp_path / "nowhere").symlink_to("missing")
    os.mkfifo(tmp_path / "pipe")
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind(str(tmp_path / "socket"))
        if os.getuid() == 0:
            os.mknod(tmp_path / "device", 0o20666, os.makedev(1, 3))
        assert names_of(tmp_path) == ["a.txt"]
    assert names_of(tmp_path / "pipe") == []


def test_files_that_cannot_be_read_are_named(tmp_path):
    for name in ("a.py", "closed/b.py", "go.py", "own.py"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("")
    (tmp_path / "own.py").chmod(0o600)
    before = content_key(str(tmp_path))
    (tmp_path / "go.py").chmod(0)
    (tmp_path / "closed").chmod(0)
    try:
        found = content_of(str(tmp_path))
        assert [name for name, _ in found.files] == ["a.py", "own.py"]
        assert found.unreadable == ["closed", "go.py"]
        assert content_key(str(tmp_path)) != before
        assert content_of(str(tmp_path / "go.py")).unreadable == ["go.py"]
        assert reason_for_no_match(str(tmp_path), ("GO.py",), found.unreadable) == (
            "go.py cannot be read: its permissions forbid it")
    finally:
        (tmp_path / "closed").chmod(0o700)


def test_trees_that_are_too_deep_or_too_large_are_refused(tmp_path, monkeypatch):
    deep = tmp_path / "deep"
    (deep / os.path.join(*60 * ["a"])).mkdir(parents=True)
    with pytest.raises(SubmissionError, match="more than 50 folders in each other"):
        content_of(str(deep))
    monkeypatch.setattr(submission_files, "MOST_FILES", 3)
    for number in range(4):
        (tmp_path / f"{number}").write_text("")
    with pytest.raises(SubmissionError, match="more than 3 files"):
        content_of(str(tmp_path))


def test_a_file_that_was_replaced_since_it_was_listed_is_not_opened(tmp_path):
    (tmp_path / "secret").write_text("secret")
    (tmp_path / "link").symlink_to(tmp_path / "secret")
    os.mkfifo(tmp_path / "pipe")
    for name in ("link", "pipe"):
        with pytest.raises(OSError):
            open_regular(str(tmp_path / name))
    with open_regular(str(tmp_path / "secret")) as stream:
        assert stream.read() == b"secret"
