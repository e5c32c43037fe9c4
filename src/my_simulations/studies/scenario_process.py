"""Runs a command and ends all that it started, however deep: nodes in sessions of their own, too.

    python3 -I scenario_process.py PARENT SECONDS COMMAND [WORD ...]

Run as a file, it imports the standard library alone. It takes over the processes that lose their
parent (PR_SET_CHILD_SUBREAPER, prctl(2)), and ends with PARENT, the process that started it.

Exit status: that of the command; 124 after SECONDS of wall time; 128 + N if signal N ended the
command, as in a shell.
"""
from __future__ import annotations

import contextlib
import ctypes
import os
import signal
import subprocess
import sys
import time
from types import FrameType
from typing import Dict, List, Optional

TIMED_OUT = 124
_PR_SET_PDEATHSIG, _PR_SET_CHILD_SUBREAPER = 1, 36
_QUIT_S = 20.0  # roslaunch gives its nodes 15 s, then 2 s
_LEFT_S = 3.0   # for those whose parent has gone


class _EndedError(Exception):
    """A signal told this process to end."""


def main(words: List[str]) -> int:
    """Run the command line; returns the exit status."""
    parent, seconds, command = int(words[1]), float(words[2]), words[3:]
    for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
        signal.signal(number, _end)
    libc = ctypes.CDLL(None)
    libc.prctl(_PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    libc.prctl(_PR_SET_PDEATHSIG, signal.SIGTERM, 0, 0, 0)
    if os.getppid() != parent:  # it ended before this was asked for
        return 128 + signal.SIGTERM
    process: Optional["subprocess.Popen[bytes]"] = None
    try:
        process = subprocess.Popen(command, start_new_session=True)
        code = process.wait(seconds)
        return code if code >= 0 else 128 - code
    except subprocess.TimeoutExpired:
        return TIMED_OUT
    except _EndedError:
        return 128 + signal.SIGTERM
    finally:
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
            signal.signal(number, signal.SIG_IGN)
        if process is not None:
            _end_all(process)


def _end(_: int, __: Optional[FrameType]) -> None:
    raise _EndedError


def _end_all(process: "subprocess.Popen[bytes]") -> None:
    """End the command as Ctrl-C does, then what is left of it."""
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(_QUIT_S)
    _signal_all(signal.SIGTERM)
    deadline = time.monotonic() + _LEFT_S
    while descendants():
        if time.monotonic() > deadline:
            _signal_all(signal.SIGKILL)
        _reap()
        time.sleep(0.02)


def _signal_all(number: int) -> None:
    for pid in descendants():
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.kill(pid, number)


def _reap() -> None:
    with contextlib.suppress(ChildProcessError):
        while os.waitpid(-1, os.WNOHANG)[0]:
            pass


def descendants() -> List[int]:
    """All processes below this one (proc(5), stat), zombies included."""
    children: Dict[int, List[int]] = {}
    for name in os.listdir("/proc"):
        if name.isdigit():
            with contextlib.suppress(OSError):
                with open(f"/proc/{name}/stat", encoding="utf-8", errors="replace") as stat:
                    parent = int(stat.read().rpartition(")")[2].split()[1])
                children.setdefault(parent, []).append(int(name))
    found: List[int] = []
    waiting = [os.getpid()]
    while waiting:
        below = children.get(waiting.pop(), [])
        found += below
        waiting += below
    return found


if __name__ == "__main__":
    sys.exit(main(sys.argv))
