"""The world of a student as processes of this machine."""
from __future__ import annotations

import contextlib
import json
import os
import signal
import socket
import subprocess
import sys
import time
from typing import Any, Dict, List, Optional

from ..child_process import child_environment, wait_or_kill
from ..editor.transport.access_guard import COOKIE
from ..grading.box import descendants
from ..grading.permitted_variables import permitted_variables
from ..grading.program import set_owner, workspace_paths
from ..resources.world_lookup import WORLDS
from ..simulator.watchdog import process_time
from . import relay, student_box
from .class_plan import ClassPlan, Student, launch_text
from .world_states import ENDED, STARTING, STOPPED

_RELAY_USER = 62999
_END_S = 30.0
_MEASURE_S = 3.0


class LocalWorld:
    """Processes of one student; they end with this process.

    Args:
        plan: the class.
        student: whose world it is.
        token: of the editor.
        listening: socket that browsers connect to; it stays open between two runs.

    Attributes:
        state: STARTING until the monitor reports the world, RUNNING, STOPPED, or ENDED if the
            processes ended by themselves.
        reason: why it stopped or ended.
        active: monotonic wall time at which a browser was last connected, s.
        monitor: port of this machine that leads to the editor, for the manager.
        memory_mb: memory that belongs to the student's processes alone, MB.
        processor_s: processor time of the living processes, s.
    """

    def __init__(self, plan: ClassPlan, student: Student, token: str,
                 listening: socket.socket) -> None:
        self.student = student
        self.token = token
        self.listening = listening
        self.state, self.reason = STOPPED, ""
        self.active = time.monotonic()
        self.monitor = 0
        self.memory_mb = self.processor_s = 0.0
        self._measured = float("-inf")
        self._plan = plan
        self._process: "subprocess.Popen[bytes] | None" = None
        self._activity = -1
        self._disk = DiskUse(plan.home(student))

    def start(self) -> None:
        """Start the processes. Raises OSError."""
        home = make_home(self._plan, self.student)
        monitoring = socket.create_server(("127.0.0.1", 0))
        reading, writing = os.pipe()
        os.set_blocking(reading, False)
        passed = [self.listening.fileno(), monitoring.fileno(), writing]
        with open(log_file(self._plan, self.student), "ab") as output:
            self._process = subprocess.Popen(
                [sys.executable, "-I", student_box.__file__], stdin=subprocess.PIPE, stdout=output,
                stderr=subprocess.STDOUT, pass_fds=passed, start_new_session=True,
                env=permitted_variables(os.environ))   # without root the student can read it
        os.close(writing)
        self.monitor = monitoring.getsockname()[1]
        monitoring.close()
        assert self._process.stdin is not None
        with contextlib.suppress(BrokenPipeError):   # it has ended: `poll` says so
            self._process.stdin.write(json.dumps(self._specification(home, passed)).encode())
            self._process.stdin.close()
        self._activity = reading
        self.state, self.reason, self.active = STARTING, "", time.monotonic()

    def _specification(self, home: str, passed: List[int]) -> Dict[str, Any]:
        limits, student = self._plan.limits, self.student
        return {
            "parent": os.getpid(), "home": home,
            "class_folder": os.path.realpath(self._plan.folder),
            "needed": workspace_paths(), "command": ["roslaunch", "-"],
            "input": launch_text(self._plan, student.port),
            "environment": self._environment(home), "user": student.user,
            "processors": processors_of(student.number, limits.processors),
            "bytes": int(limits.file_mb * 1e6), "memory_bytes": None, "processor_seconds": None,
            "processes": limits.processes,
            "relay": [sys.executable, "-I", relay.__file__, str(student.port),
                      f"{COOKIE}_{student.port}", *map(str, passed)],
            "relay_user": _RELAY_USER, "descriptors": passed}

    def _environment(self, home: str) -> Dict[str, str]:
        return {**permitted_variables(child_environment()), "HOME": home,
                "USER": self.student.name, "LOGNAME": self.student.name,
                "ROS_HOME": os.path.join(home, ".ros"), "ROS_MASTER_URI": "http://127.0.0.1:11311",
                "ROS_IP": "127.0.0.1", "ROS_HOSTNAME": "127.0.0.1", "PYTHONUNBUFFERED": "1",
                "MY_SIMULATIONS_NO_BROWSER": "1", "MY_SIMULATIONS_EDITOR_TOKEN": self.token}

    @property
    def is_alive(self) -> bool:
        """Whether processes run."""
        return self._process is not None and self._process.poll() is None

    def poll(self) -> None:
        """Check whether browsers are active; stop processes that exceed the memory or the disk."""
        if self._process is None:
            return
        with contextlib.suppress(BlockingIOError):
            if os.read(self._activity, 65536):
                self.active = time.monotonic()
        self._measure(self._process.pid)
        self._disk.poll()
        if self.memory_mb > self._plan.limits.memory_mb:
            self._end(STOPPED, f"more memory than {self._plan.limits.memory_mb:g} MB", 0.0)
        elif self._disk.used_mb > self._plan.limits.home_mb:
            self._end(STOPPED, f"the files of the home take {self._disk.used_mb:.0f} MB, more than"
                               f" {self._plan.limits.home_mb:g} MB: delete some", 0.0)
        elif not self.is_alive:
            code = self._process.returncode
            self._end(ENDED, f"the processes ended with status {code}", 0.0)

    def stop(self, reason: str) -> None:
        """End all processes, as Ctrl-C does; waits for them."""
        if self._process is not None:
            self._end(STOPPED, reason, _END_S)

    def _end(self, state: str, reason: str, seconds: float) -> None:
        process, self._process = self._process, None
        assert process is not None
        if seconds and process.poll() is None:
            process.send_signal(signal.SIGTERM)
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(seconds)
        if process.poll() is None:
            process.kill()   # the namespaces end with it
        wait_or_kill(process, _END_S)
        os.close(self._activity)
        self._disk.reset()
        self.state, self.reason, self.monitor = state, reason, 0
        self.memory_mb = self.processor_s = 0.0
        self._measured = float("-inf")

    def _measure(self, process: int) -> None:
        """Measure memory and processor time every few seconds."""
        if time.monotonic() < self._measured + _MEASURE_S:
            return
        self._measured = time.monotonic()
        found = descendants(process)
        self.memory_mb = sum(map(_own_memory, found)) / 1e6
        self.processor_s = sum(used for used, _ in filter(None, map(process_time, found)))


def processors_of(number: int, count: int) -> List[int]:
    """The processors of a student: students share them in turn."""
    all_of_them = sorted(os.sched_getaffinity(0))
    return sorted({all_of_them[(number * count + index) % len(all_of_them)]
                   for index in range(count)})


def make_home(plan: ClassPlan, student: Student) -> str:
    """The home folder, which only the student can enter; made if it does not exist.

    A new one has the folder of the submission, in which worlds are saved by default.
    """
    os.makedirs(os.path.dirname(plan.home(student)), exist_ok=True)
    home = os.path.realpath(plan.home(student))
    with contextlib.suppress(FileExistsError):
        os.mkdir(home, 0o700)
        _fill_home(home, plan.submission)
        set_owner(home, student.user)
    if os.geteuid() == 0:
        os.chown(home, student.user, student.user)
    return home


def _fill_home(home: str, submission: str) -> None:
    """Make the folder of the submission, to which the default folder for worlds leads."""
    handed_in, worlds = (os.path.join(home, inside) for inside in (submission, WORLDS))
    for folder in (handed_in, os.path.dirname(worlds)):
        os.makedirs(folder, exist_ok=True)
    if not os.path.exists(worlds):
        os.symlink(os.path.relpath(handed_in, os.path.dirname(worlds)), worlds)


def log_file(plan: ClassPlan, student: Student) -> str:
    """The file with the output of a student's programs, which only the manager can read."""
    folder = os.path.join(plan.state, "logs")
    os.makedirs(folder, 0o700, exist_ok=True)
    return os.path.join(folder, f"{student.name}.txt")


def _own_memory(pid: int) -> int:
    """Resident bytes without those of files and shared memory."""
    try:
        with open(f"/proc/{pid}/statm", encoding="ascii") as statm:
            words = statm.read().split()
    except OSError:
        return 0
    return (int(words[1]) - int(words[2])) * os.sysconf("SC_PAGE_SIZE")


_DISK_MEASURE_S = 10.0
_BYTES_PER_FILE = 4096   # an empty file takes a place in the file system, too
_COMMAND = 'du -sxB1 "$0"; du -sx --inodes "$0"'


class DiskUse:
    """Measures the files below a folder in a process of its own: there may be millions.

    Args:
        folder: only its file system is measured. What cannot be read is left out, as are deleted
            files that a program still has open.

    Attributes:
        used_mb: disk space at the last measurement, MB; 0 before the first.
    """

    def __init__(self, folder: str) -> None:
        self.used_mb = 0.0
        self._folder = folder
        self._process: "Optional[subprocess.Popen[bytes]]" = None
        self._begun = float("-inf")

    def poll(self) -> None:
        """Take a measurement that has ended, or begin one every few seconds."""
        if self._process is None:
            if time.monotonic() > self._begun + _DISK_MEASURE_S:
                self._begun = time.monotonic()
                self._process = subprocess.Popen(
                    ["nice", "sh", "-c", _COMMAND, self._folder], stdin=subprocess.DEVNULL,
                    stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        elif self._process.poll() is not None:
            lines = self._process.communicate()[0].split(b"\n")
            self._process = None
            if len(lines) == 3:   # else the folder was deleted
                size, files = (int(line.split()[0]) for line in lines[:2])
                self.used_mb = (size + files * _BYTES_PER_FILE) / 1e6

    def reset(self) -> None:
        """End a measurement that goes on, and forget the last one."""
        if self._process is not None:
            self._process.kill()
            self._process.communicate()
            self._process = None
        self.used_mb, self._begun = 0.0, float("-inf")
