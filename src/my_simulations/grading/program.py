"""Starts the program of a submission in its cell, and watches its memory and processor time."""
from __future__ import annotations

import contextlib
import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
from dataclasses import dataclass
from typing import Dict, Iterable, Iterator, List, Optional, Sequence, Set, Tuple

from ..resources.package_files import own_directory
from ..simulator.watchdog import resident_bytes
from . import box, cell
from .assignment import GradeLimits
from .permitted_variables import permitted_variables
from .process_list import ProcessList, processor_seconds
from .thread_states import ThreadStates

OUTPUT = "output.txt"
_FIRST_USER = 61000
"""User id of the programs of slot 0: one that no account has (Debian policy, 9.2.2)."""

_FIRST_TESTER = 62000
"""As `_FIRST_USER`, of the tests of the assignment."""

TESTS = "tests"
"""Folder in the box that only the tests of the assignment see."""

_LOOK_S = 0.1
_END_S = 10.0
_STOP_S = 5.0     # wall time
_STOP_LOOK_S = 0.0001
_KEPT_OUTPUT = 200_000
_LOOP_S = 2.0     # wall time in which a program prints where it is
_LONGEST_ERROR = 300
_PLACE = re.compile(r'(?:File "|in file )([^"\n]+?)"?(?:,| on) line (\d+)')
_ERROR = re.compile(r"[\w.]+(Error|Exception)\b")


@dataclass(frozen=True)
class Account:
    """The user of a program in the box.

    Attributes:
        user: id, where the system permits other users.
        home: home folder.
        temporary: folder for temporary files.
        owned: folders that the user owns.
        hidden: folders that the program must not see.
        output: file of what it prints.
    """

    user: int
    home: str
    temporary: str
    owned: Tuple[str, ...]
    hidden: Tuple[str, ...]
    output: str


def submission_account(scratch: str, slot: int) -> Account:
    submission, home, temporary, judge, tests = (
        os.path.join(scratch, name) for name in ("submission", "home", "tmp", "judge", TESTS))
    return Account(_FIRST_USER + slot, home, temporary, (submission, home, temporary),
                   (judge, tests), os.path.join(judge, OUTPUT))


def tester_account(scratch: str, slot: int) -> Account:
    """The user of the assignment's tests: the submission cannot reach its files and processes."""
    judge, tests = (os.path.join(scratch, name) for name in ("judge", TESTS))
    return Account(_FIRST_TESTER + slot, tests, os.path.join(tests, "tmp"), (tests,), (judge,),
                   os.path.join(judge, "tests.txt"))


@dataclass(frozen=True)
class PythonError:
    """An error of a program in Python.

    Attributes:
        file: path in the submission; the name alone of a file elsewhere.
        line: in that file, from 1.
        message: the last line of the error; "" for an endless loop.
    """

    file: str
    line: int
    message: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {self.message}"


class Program:
    """A running program.

    Args:
        command: the command line.
        folder: working directory, in the submission.
        scratch: folder of the box.
        limits: of the assignment.
        account: the user that it gets.
        environment: variables besides those of this process.

    Attributes:
        pid: of the cell.
        processes: those of the program, below the cell.
        watcher: thread id of the thread that watches memory and processor time.
        excess: why it was killed; "" if it was not.
    """

    def __init__(self, command: Sequence[str], folder: str, scratch: str, limits: GradeLimits,
                 account: Account, environment: Dict[str, str]) -> None:
        self._limits = limits
        self._output = account.output
        self._submission = os.path.join(scratch, "submission")
        self._most_bytes = int(limits.file_mb * 1e6 / 2)
        self.excess = ""
        self.watcher = 0
        for path in (*account.owned, *account.hidden, account.temporary):
            os.makedirs(path, exist_ok=True)
        spec = {"parent": os.getpid(), "command": list(command), "cwd": folder,
                "environment": {**_environment(account), **environment},
                "user": account.user, "private": list(account.hidden),
                "needed": _needed(scratch),
                "bytes": self._most_bytes, "processes": limits.processes,
                "memory_bytes": int(limits.memory_mb * 1e6),
                "processor_seconds": int(limits.processor_seconds) + 1}
        for folder in account.owned:
            set_owner(folder, account.user)
        with open(self._output, "ab") as output:
            self._process = subprocess.Popen(
                [sys.executable, "-I", cell.__file__, json.dumps(spec)], cwd=folder,
                stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT)
        self.pid = self._process.pid
        self.processes = ProcessList(self.pid)
        self._threads = ThreadStates(self.pid, lambda: {self.pid})   # not of the cell
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._watch, name="limits", daemon=True)
        self._thread.start()

    @property
    def running(self) -> bool:
        return self._process.poll() is None

    @property
    def status(self) -> Optional[int]:
        """Exit status as of a shell; None while it runs."""
        code = self._process.poll()
        return None if code is None else code if code >= 0 else 128 - code

    def interrupt(self) -> None:
        """Ask the program to end, as Ctrl-C does."""
        self._signal(box.descendants(self.pid), signal.SIGINT)

    @contextlib.contextmanager
    def suspended(self) -> Iterator[None]:
        """Stop all its processes meanwhile. Messages to them wait in their sockets.

        A thread stops when it runs the next time, and until one thread of a process has done so,
        the others may answer a message: so all of them are waited for.
        """
        stopped: Set[int] = set()
        found = set(self.processes.pids())
        while found - stopped and len(stopped) <= self._limits.processes:
            self._signal(found - stopped, signal.SIGSTOP)
            stopped |= found
            found = set(self.processes.pids())   # a process may have started another one
        deadline = time.monotonic() + _STOP_S
        self._threads.refresh()
        while self._threads.any_awake() and time.monotonic() < deadline:
            time.sleep(_STOP_LOOK_S)
        try:
            yield
        finally:
            self._signal(stopped, signal.SIGCONT)

    @staticmethod
    def _signal(pids: Iterable[int], number: int) -> None:
        for pid in pids:
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.kill(pid, number)

    def close(self) -> None:
        self._ended.set()
        self._signal(box.descendants(self.pid), signal.SIGKILL)
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(_END_S)
        self._process.kill()
        self._process.wait()
        self._thread.join()
        self._threads.close()
        self.processes.close()

    def output(self) -> bytes:
        """The end of what it has printed."""
        return end_of_output(self._output)

    def why_ended(self) -> str:
        """What became of it, for a reason; "" while it runs."""
        status = self.status
        if self.excess or status is None:
            return self.excess
        if status == 128 + signal.SIGXCPU:
            return self._slow
        if status == 0:
            return "the program ended during the run, without an error"
        error = self.error
        text = str(error) if error is not None else ""
        if os.path.getsize(self._output) >= self._most_bytes:
            text = f"its output has reached {self._most_bytes * 1e-6:g} MB"
        return f"the program ended with status {status}" + (f": {text}" if text else "")

    @property
    def _slow(self) -> str:
        return f"the program used more processor time than {self._limits.processor_seconds:g} s"

    @property
    def error(self) -> Optional[PythonError]:
        """The Python error that ended it; None if none did."""
        return python_error(self._text(), self._submission)

    def interrupted_at(self) -> Optional[PythonError]:
        """End an endless loop in Python, and return where it was; None if that is unknown."""
        self._signal(self._pythons(), signal.SIGABRT)     # faulthandler prints where it is
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(_LOOP_S)
        return loop_place(self._text(), self._submission)

    def _pythons(self) -> List[int]:
        """Processes that run a Python program of the submission."""
        found = []
        for pid in box.descendants(self.pid):
            with contextlib.suppress(OSError, IndexError):
                with open(f"/proc/{pid}/cmdline", "rb") as stream:
                    words = stream.read().split(b"\0")
                if words[1].startswith(os.fsencode(self._submission) + b"/"):
                    found.append(pid)
        return found

    def _text(self) -> str:
        return self.output().decode("utf-8", "replace")

    def _watch(self) -> None:
        self.watcher = threading.get_native_id()
        most = self._limits.memory_mb * 1e6
        while not self.excess and self.running and not self._ended.wait(_LOOK_S):
            found = box.descendants(self.pid)
            if sum(map(resident_bytes, found)) > most:
                self.excess = f"the program used more memory than {self._limits.memory_mb:g} MB"
            elif processor_seconds(found) > self._limits.processor_seconds:
                self.excess = self._slow
        if self.excess:
            self._process.kill()


def end_of_output(path: str) -> bytes:
    """The end of a file that programs have printed to. Raises OSError."""
    with open(path, "rb") as stream:
        size = stream.seek(0, os.SEEK_END)
        stream.seek(max(0, size - _KEPT_OUTPUT))
        return stream.read()


def python_error(output: str, folder: str) -> Optional[PythonError]:
    """The Python error at the end of an output, in the last file of `folder` that it names."""
    last = output.rstrip().rpartition("\n")[2]
    places = _PLACE.findall(output)
    return _error_at(places, folder, last) if places and _ERROR.match(last) else None


def loop_place(output: str, folder: str) -> Optional[PythonError]:
    """Where a program was that faulthandler has ended, in a file of `folder`; else None."""
    _, found, dump = output.rpartition("Fatal Python error: Aborted")
    places = [place for place in _PLACE.findall(dump) if place[0].startswith(f"{folder}/")]
    return _error_at(places[:1], folder, "") if found and places else None


def _error_at(places: Sequence[Tuple[str, str]], folder: str, message: str) -> PythonError:
    inside = [place for place in places if place[0].startswith(f"{folder}/")]
    file, line = (inside or places)[-1]
    name = os.path.relpath(file, folder) if inside else os.path.basename(file)
    return PythonError(name, int(line), message[:_LONGEST_ERROR])


def _environment(account: Account) -> Dict[str, str]:
    return {**permitted_variables(os.environ), "HOME": account.home,
            "ROS_HOME": os.path.join(account.home, ".ros"), "TMPDIR": account.temporary,
            "PYTHONUNBUFFERED": "1", "PYTHONFAULTHANDLER": "1", "USER": "student"}


def _needed(scratch: str) -> List[str]:
    names = ("submission", "home", "tmp", "test", TESTS)
    return [*(os.path.join(scratch, name) for name in names), *workspace_paths()]


def workspace_paths() -> List[str]:
    """Return the folders that programs of ROS read: package, Python and workspace."""
    found = [own_directory(), sys.prefix, sys.base_prefix,
             os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))]
    for name in ("CMAKE_PREFIX_PATH", "ROS_PACKAGE_PATH", "PYTHONPATH", "GAZEBO_MODEL_PATH",
                 "GAZEBO_RESOURCE_PATH"):
        found += [path for path in os.environ.get(name, "").split(os.pathsep) if path]
    # Packages are often links from the workspace to a clone elsewhere.
    for path in os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep):
        if os.path.isdir(path):
            found += [entry.path for entry in os.scandir(path) if entry.is_symlink()]
    found += [os.path.join(os.path.dirname(path), ".my_simulations")
              for path in os.environ.get("CMAKE_PREFIX_PATH", "").split(os.pathsep) if path]
    return found


def set_owner(top: str, user: int) -> None:
    """Let a user own a folder and all in it, where the system permits other users."""
    with contextlib.suppress(OSError):
        os.chown(top, user, user)
        for folder, folders, names in os.walk(top):
            for name in (*folders, *names):
                os.lchown(os.path.join(folder, name), user, user)
