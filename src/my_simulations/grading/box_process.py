"""Grades one submission in a box, and receives its results while it runs."""
from __future__ import annotations

import contextlib
import json
import os
import select
import subprocess
import sys
import tempfile
import threading
import time
from typing import Any, Dict, List, Sequence

from ..child_process import child_command, child_environment, signal_name, wait_or_kill
from ..errors import SimulationError
from . import box
from .assignment import Assignment
from .mark import FAILED, GRADED, TIMED_OUT, CheckResult, Mark, late_reason, without_result
from .permitted_variables import permitted_variables
from .result_stream import ResultReader
from .submission import Submission
from .submission_files import Content, content_of

_END_S = 10.0
_PAGES_S = 90.0        # after the time of a submission, to end its programs and write its replay
_LOOK_S = 0.2
_KEPT_OUTPUT = 20000   # characters of the end of the output


class GradingStoppedError(SimulationError):
    """The grading was told to stop during a submission."""


def grade_in_box(assignment: Assignment, submission: Submission, slot: int, hidden: Sequence[str],
                 folder: str, namespaces: bool, stop: threading.Event) -> Mark:
    """Grade a submission; never raises for what it does.

    Args:
        assignment: the assignment.
        submission: the submission to grade.
        slot: number of those that are graded side by side, from 0.
        hidden: files and folders that the submission must not see.
        folder: gets the files that belong to the mark, such as `replay.html`.
        namespaces: whether to isolate the box by namespaces.
        stop: ends the grading with GradingStoppedError once it is set.
    """
    content = content_of(submission.path)
    reader = ResultReader(folder, assignment.checks)
    with tempfile.TemporaryDirectory(prefix="my_simulations_grade_") as scratch:
        receiving, sending = os.pipe()
        try:
            spec = _specification(assignment, submission, slot, hidden, scratch, sending, content)
            spec["namespaces"] = namespaces
            code, output = _run(spec, receiving, sending, reader, stop)
        finally:
            os.close(receiving)
    return _mark(assignment, submission, reader, code, output)


def _specification(assignment: Assignment, submission: Submission, slot: int,
                   hidden: Sequence[str], scratch: str, sending: int,
                   content: Content) -> Dict[str, Any]:
    root = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
    task = {"assignment": assignment.file, "scratch": scratch, "slot": slot,
            "descriptor": sending, "unreadable": content.unreadable}
    environment = {**permitted_variables(child_environment()), "PYTHONDONTWRITEBYTECODE": "1",
                   "HOME": os.path.expanduser("~")}
    return {"parent": os.getpid(), "seconds": assignment.limits.seconds + _PAGES_S,
            "command": child_command("grading.judge", json.dumps(task)),
            "environment": environment, "scratch": scratch,
            "bytes": int(assignment.limits.file_mb * 1e6), "copy": content.files,
            "hidden": [path for path in hidden if not contains(path, assignment.file)],
            "kept": [root, assignment.file, sys.prefix, os.getcwd()],
            "descriptors": [sending]}


def contains(folder: str, path: str) -> bool:
    """Whether a path is a folder or lies in it."""
    return path == folder or path.startswith(folder.rstrip(os.sep) + os.sep)


def _run(spec: Dict[str, Any], receiving: int, sending: int, reader: ResultReader,
         stop: threading.Event) -> "tuple[int, str]":
    """Run the box; returns its exit status and the end of its output."""
    with tempfile.TemporaryFile() as output:
        try:
            process = subprocess.Popen(
                [sys.executable, "-I", box.__file__], stdin=subprocess.PIPE, stdout=output,
                stderr=subprocess.STDOUT, pass_fds=(sending,), start_new_session=True,
                env=permitted_variables(os.environ))   # without root the submission can read it
        finally:
            os.close(sending)
        try:
            assert process.stdin is not None
            with contextlib.suppress(BrokenPipeError), process.stdin as stream:
                stream.write(json.dumps(spec).encode())    # of any length, unlike a command line
            _receive(process, receiving, reader, stop)
        finally:
            if process.poll() is None:
                with contextlib.suppress(ProcessLookupError):
                    process.kill()
            wait_or_kill(process, _END_S)
        size = output.seek(0, os.SEEK_END)
        output.seek(max(0, size - _KEPT_OUTPUT))
        return process.returncode, output.read().decode("utf-8", "replace")


def _receive(process: "subprocess.Popen[bytes]", receiving: int, reader: ResultReader,
             stop: threading.Event) -> None:
    """Read results until the box has ended."""
    is_open = True
    while is_open or process.poll() is None:
        if stop.is_set():
            raise GradingStoppedError
        if not is_open:
            time.sleep(_LOOK_S)
        elif select.select([receiving], [], [], _LOOK_S)[0]:
            data = os.read(receiving, 1 << 16)
            is_open = bool(data) and reader.feed(data)
        elif process.poll() is not None:
            return


def _mark(assignment: Assignment, submission: Submission, reader: ResultReader, code: int,
          output: str) -> Mark:
    results: List[CheckResult] = reader.results
    status, reason = GRADED, "the check was not reached"
    if reader.timed_out or not reader.ended and code == box.TIMED_OUT:
        status, reason = TIMED_OUT, late_reason(assignment)
    elif not reader.ended:
        status = FAILED
        ending = signal_name(code - 128) if code > 128 else f"status {code}"
        last = output.strip().splitlines()[-1:] or [""]
        reason = f"the grading process ended with {ending}: {last[0]}"[:500]
    return Mark(submission.student, status,
                without_result(assignment.checks, results, reason), reader.notes,
                sorted(reader.files), reader.isolation, library=reader.library)
