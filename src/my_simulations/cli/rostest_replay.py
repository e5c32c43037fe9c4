"""Keeps a replay of a failed rostest, beside its results: the last 30 s of the simulation."""
from __future__ import annotations

import contextlib
import dataclasses
import glob
import os
import secrets
import shutil
import tempfile
import threading
import xml.etree.ElementTree as ET
from typing import Callable, Iterator, List, Sequence, Set

from ..errors import SimulationError
from ..ros.lifecycle.launch_info import Launch, command_line
from ..ros.lifecycle.server_options import Recording, ServerOptions

_LAST_S = 30.0
_PERIOD_S = 1.0 / 30.0
_LOOK_S = 0.25
_FLAG = "--gtest_output=xml:"


@contextlib.contextmanager
def rostest_replay(options: ServerOptions, words: Sequence[str],
                   say: Callable[[str], None]) -> Iterator[ServerOptions]:
    """Record the simulation if rostest started this process, and keep a replay if a test fails.

    Args:
        options: of the server.
        words: the command line of this process.
        say: prints a line.

    Yields:
        The options of the server, which record a log for the replay if they recorded none.
    """
    launch = Launch.of(words)
    if options.recording.on or not launch.is_rostest:
        yield options
        return
    # The log makes the folder: none is left by a process that ends before its world is loaded.
    folder = os.path.join(tempfile.gettempdir(), f"my_simulations_rostest_{secrets.token_hex(8)}")
    tests = _Tests(launch.pid)
    try:
        yield dataclasses.replace(options, recording=Recording(
            True, path=folder, period=_PERIOD_S, topics=options.recording.topics))
    finally:
        failed = [file for file in tests.end() if has_failed(file)]
        if failed:
            _write(folder, failed, say)
        shutil.rmtree(folder, ignore_errors=True)


class _Tests:
    """Result files of the tests that rostest starts while the simulation runs."""

    def __init__(self, rostest: int) -> None:
        self._rostest = rostest
        self._files: Set[str] = set()
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._watch, name="rostest", daemon=True)
        self._thread.start()

    def _watch(self) -> None:
        while not self._ended.wait(_LOOK_S):
            self._files.update(result_files(self._rostest))

    def end(self) -> List[str]:
        """Stop looking; returns the files."""
        self._ended.set()
        self._thread.join()
        return sorted(self._files)


def result_files(process: int) -> List[str]:
    """Files into which the tests that a process has started will write their results."""
    found = []
    for path in glob.glob(f"/proc/{process}/task/*/children"):
        with contextlib.suppress(OSError):
            with open(path, encoding="ascii") as children:
                numbers = children.read().split()
            for number in numbers:
                found += [word[len(_FLAG):] for word in command_line(int(number))
                          if word.startswith(_FLAG)]
    return found


def has_failed(file: str) -> bool:
    """Whether a test has failed by its results; a test without results has."""
    try:
        root = ET.parse(file).getroot()
        return any(int(suite.get(name) or 0) for suite in root.iter("testsuite")
                   for name in ("failures", "errors"))
    except (OSError, ET.ParseError, ValueError):
        return True


def _write(folder: str, failed: List[str], say: Callable[[str], None]) -> None:
    from ..editor.logs.state_log import FILE
    from .replay_command import replay

    log = os.path.join(folder, FILE)
    if not os.path.isfile(log):
        return
    for file in failed:
        stem = os.path.splitext(file)[0]
        try:
            replay(log, f"{stem}.html", os.path.basename(stem), last=_LAST_S)
        except SimulationError as fault:
            say(f"no replay of the failed test: {fault}")
            return
        say(f"replay of the failed test: {stem}.html")
