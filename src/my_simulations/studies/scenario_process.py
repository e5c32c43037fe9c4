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
from typing import Dict, List

TIMED_OUT = 124
_PR_SET_PDEATHSIG, _PR_SET_CHILD_SUBREAPER = 1, 36
_QUIT_S = 20.0  # roslaunch gives its nodes 15 s, then 2 s
_LEFT_S = 3.0   # for those whose parent has gone
_LOOK_S = 0.02
_ENDING = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP)


def main(words: List[str]) -> int:
    """Run the command line; returns the exit status."""
    parent, seconds, command = int(words[1]), float(words[2]), words[3:]
    # Blocked and waited for: the kernel sends one for each thread of PARENT that ends, and a
    # handler that raises would be called again while the first one is dealt with.
    signal.pthread_sigmask(signal.SIG_BLOCK, _ENDING)
    libc = ctypes.CDLL(None)
    libc.prctl(_PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    libc.prctl(_PR_SET_PDEATHSIG, signal.SIGTERM, 0, 0, 0)
    if os.getppid() != parent:  # it ended before this was asked for
        return 128 + signal.SIGTERM
    process = subprocess.Popen(command, start_new_session=True, preexec_fn=_unblock_signals)
    try:
        return _wait(process, seconds)
    finally:
        _end_all(process)


def _unblock_signals() -> None:
    signal.pthread_sigmask(signal.SIG_UNBLOCK, _ENDING)


def _wait(process: "subprocess.Popen[bytes]", seconds: float) -> int:
    """Wait for the command, its time or a signal that ends this process; returns the status."""
    until = time.monotonic() + seconds
    while True:
        code = process.poll()
        if code is not None:
            return code if code >= 0 else 128 - code
        if time.monotonic() >= until:
            return TIMED_OUT
        if signal.sigtimedwait(_ENDING, _LOOK_S) is not None:
            return 128 + signal.SIGTERM


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
        time.sleep(_LOOK_S)


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
