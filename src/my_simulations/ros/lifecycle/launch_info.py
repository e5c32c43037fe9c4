"""How this process was started: by roslaunch, rostest or from a shell, and in which folder."""
from __future__ import annotations

import os
from dataclasses import dataclass
from typing import List, Sequence

_LAUNCHERS = ("roslaunch", "rostest")
_FEW = 4
"""Most processes between roslaunch and its node (`launch-prefix`) that are searched."""


@dataclass(frozen=True)
class Launch:
    """Who started this process.

    Attributes:
        pid: process id of the roslaunch or rostest; 0 when started from a shell.
        parent: process id of the parent, which changes when the parent is killed.
        folder: absolute path of the user's working directory. roslaunch starts nodes in ROS_HOME,
            so it is the working directory of roslaunch itself; if that cannot be read, the value
            of the variable PWD, which roslaunch passes on.
    """

    pid: int
    parent: int
    folder: str

    @classmethod
    def of(cls, argv: Sequence[str]) -> "Launch":
        """From a node's command line; call it early, while the parent runs."""
        parent = os.getppid()
        # Only roslaunch passes __log.
        if not any(word.startswith("__log:=") for word in argv):
            return cls(0, parent, os.getcwd())
        pid = _launcher(parent)
        return cls(pid, parent, _folder(pid))

    @property
    def is_rostest(self) -> bool:
        """Whether it is the program rostest that started this process."""
        return any(os.path.basename(word) == "rostest" for word in command_line(self.pid)[:2])

    @property
    def is_alive(self) -> bool:
        """False once the roslaunch that started this node is gone."""
        return self.pid == 0 or os.getppid() == self.parent


def _launcher(parent: int) -> int:
    """The nearest ancestor that is roslaunch or rostest; else the parent."""
    pid = parent
    for _ in range(_FEW):
        if any(os.path.basename(word) in _LAUNCHERS for word in command_line(pid)[:4]):
            return pid
        fields = _read(pid, "stat").rpartition(")")[2].split()
        if len(fields) < 2 or int(fields[1]) <= 1:
            break
        pid = int(fields[1])
    return parent


def command_line(pid: int) -> List[str]:
    """The words of the command line of a process; "" alone if it has ended."""
    return _read(pid, "cmdline").split("\0")


def _read(pid: int, name: str) -> str:
    try:
        with open(f"/proc/{pid}/{name}", encoding="utf-8", errors="surrogateescape") as file:
            return file.read()
    except OSError:
        return ""  # it is gone, or belongs to another user


def _folder(pid: int) -> str:
    try:
        folder = os.readlink(f"/proc/{pid}/cwd")
    except OSError:
        folder = os.environ.get("PWD", "")
    return folder if os.path.isdir(folder) else os.getcwd()
