"""What keeps submissions from marks, secrets and each other, also where the grader is not root."""
from __future__ import annotations

import contextlib
import json
import os
import signal
import socket
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest
from waiting import wait_for

from my_simulations.grading import box
from my_simulations.grading.assignment_file import read_assignment
from my_simulations.grading.box_process import _specification
from my_simulations.grading.box_support import isolation_fault
from my_simulations.grading.confined_resolver import ConfinedResolver
from my_simulations.grading.grader import Grader, reserve_slots
from my_simulations.grading.program import Program, submission_account
from my_simulations.grading.submission import Submission, submissions_of
from my_simulations.grading.submission_files import content_of
from my_simulations.resources.resolver import ResourceNotFoundError


@pytest.fixture
def assignment(tmp_path):
    (tmp_path / "labs").mkdir()
    file = tmp_path / "labs" / "lab.yaml"
    file.write_text("submission: {world: a.world}\nchecks:\n"
                    "  - {points: 2, name: valid, check_model: strict}\n")
    return read_assignment(str(file))[0]


def run_in_box(scratch, *command):
    spec = {"parent": os.getpid(), "seconds": 60.0, "command": command, "copy": [], "hidden": [],
            "environment": {"PATH": os.environ["PATH"]}, "scratch": str(scratch), "kept": [],
            "bytes": 1 << 20, "descriptors": [], "namespaces": True}
    return subprocess.run([sys.executable, "-I", box.__file__], input=json.dumps(spec), text=True,
                          capture_output=True, timeout=120)


def test_the_judge_imports_no_modules_of_the_submission(tmp_path):
    assert run_in_box(tmp_path, "pwd").stdout == "/\n"


CONNECT = ("import socket, sys; one = socket.socket(socket.AF_UNIX); one.settimeout(5);"
           " print(one.connect_ex(sys.argv[1]))")


def test_sockets_of_the_system_cannot_be_reached(tmp_path):
    if isolation_fault():
        pytest.fail("this test needs namespaces")
    with tempfile.TemporaryDirectory(dir="/tmp") as short, \
            socket.socket(socket.AF_UNIX) as agent:
        path = os.path.join(short, "agent socket")
        agent.bind(path)
        agent.listen()
        done = run_in_box(tmp_path, sys.executable, "-c", CONNECT, path)
        agent.settimeout(0.0)
        with pytest.raises(BlockingIOError):
            agent.accept()
    assert int(done.stdout) != 0, done.stderr


def test_the_judge_has_no_variables_that_may_hold_secrets(assignment, tmp_path, monkeypatch):
    monkeypatch.setenv("A_TOKEN", "hunter2")
    monkeypatch.setenv("PRIVATE", "hunter2")
    (tmp_path / "anna").mkdir()
    submission = Submission("anna", str(tmp_path / "anna"))
    spec = _specification(assignment, submission, 0, [], str(tmp_path), 5,
                          content_of(submission.path))
    assert "hunter2" not in json.dumps(spec)


def test_what_lies_beside_submissions_is_hidden_unless_it_is_needed(assignment, tmp_path,
                                                                   monkeypatch):
    for name in ("course/anna", "labs/ben", "here/carl"):
        (tmp_path / name).mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "here")
    submissions = submissions_of([str(tmp_path / name) for name in ("course/anna", "labs/ben",
                                                                    "here/carl")])
    grader = Grader(assignment, str(tmp_path / "marks"), 1, False, lambda mark, kept: None)
    assert grader._folders_of(submissions) == [str(tmp_path / "course")]


def test_a_world_reads_no_files_outside_of_the_submission_and_the_models(tmp_path):
    for name in ("sub/own.dae", "models/rock/a.dae", "private/secret.sdf"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("")
    (tmp_path / "sub" / "link.sdf").symlink_to(tmp_path / "private" / "secret.sdf")
    resolver = ConfinedResolver([str(tmp_path / "models")])
    resolver.allow(str(tmp_path / "sub"))
    own = Path(resolver.resolve("own.dae", str(tmp_path / "sub")))
    assert own == tmp_path / "sub" / "own.dae"
    assert resolver.resolve("model://rock/a.dae") == str(tmp_path / "models" / "rock" / "a.dae")
    for uri in (f"file://{tmp_path}/private/secret.sdf", "../private/secret.sdf", "link.sdf",
                "/etc/passwd"):
        with pytest.raises(ResourceNotFoundError, match="lies outside"):
            resolver.resolve(uri, str(tmp_path / "sub"))
        with pytest.raises(ResourceNotFoundError, match="lies outside"):
            resolver.model_file(uri, str(tmp_path / "sub"))
    with pytest.raises(ResourceNotFoundError):
        resolver.resolve("model://stone/a.dae")
    assert resolver.looked_up == [str(tmp_path / name) for name in (
        "sub/own.dae", "models/rock/a.dae", "models/stone/a.dae")]


def test_a_world_cannot_name_a_folder_beside_the_submission_as_a_model(tmp_path):
    for name in ("sub/own/a.dae", "private/secret.sdf"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("")
    resolver = ConfinedResolver([str(tmp_path / "models")])
    resolver.allow(str(tmp_path / "sub"))
    assert resolver.add_unlisted_folder("model://private/secret.sdf", str(tmp_path / "sub"))
    assert resolver.add_unlisted_folder("model://own/a.dae", str(tmp_path / "sub"))
    with pytest.raises(ResourceNotFoundError, match="lies outside"):
        resolver.resolve("model://private/secret.sdf", str(tmp_path / "sub"))
    assert resolver.resolve("model://own/a.dae") == str(tmp_path / "sub" / "own" / "a.dae")


THREADS = """import threading
for _ in range(60):
    threading.Thread(target=threading.Event().wait, daemon=True).start()
print("started", flush=True)
threading.Event().wait()
"""


@pytest.fixture
def program(assignment, tmp_path):
    """A running program with 61 threads."""
    with reserve_slots(1) as slots, contextlib.closing(Program(
            [sys.executable, "-c", THREADS], str(tmp_path), str(tmp_path), assignment.limits,
            submission_account(str(tmp_path), slots[0]), {})) as found:
        wait_for(lambda: b"started" in found.output(), "its threads", 60.0)
        yield found


def test_a_suspended_program_can_answer_nothing(program):
    for _ in range(20):
        with program.suspended():
            states = [Path(task, "stat").read_text().rpartition(")")[2].split()[0]
                      for pid in program.processes.pids()
                      for task in Path(f"/proc/{pid}/task").iterdir()]
        assert len(states) >= 61 and set(states) == {"T"}, states


def test_a_program_ends_with_its_cell(program):
    running = program.processes.pids()
    assert running
    os.kill(program.pid, signal.SIGKILL)
    wait_for(lambda: not any(os.path.exists(f"/proc/{pid}") for pid in running),
             "the end of its processes", 60.0)
