"""Decides when a program has done what follows from a step: nothing of it can run any further.

A program has done its part when all its threads wait, and no byte is on its way between it and the
world. Sim time advances only then, so a busy machine gives the same mark as an idle one. A program
that never waits gets as much processor time as sim time passes; one that waits may use more for a
single step, because the same work takes more processor time on a busy machine.
"""
from __future__ import annotations

import contextlib
import os
import threading
import time
from typing import Callable, Optional, Set

from .program import Program
from .thread_states import ThreadStates

_LOOK_S = 0.0005
_BUSY_LOOK_S = 0.002
_LOOK_SHARE = 0.1     # of the time, at most, is spent on looking
_STUCK_LOOKS = 400    # all wait, but bytes stay unread
_LONGEST_S = 60.0     # wall time of one wait, whatever the program does
_FIRST_S = 1.0        # wall time in which a program sees the first step
_START_S = 10.0       # processor time to start, s
_START_SHARE = 0.25   # of the processor time of the program, at most, to start
_MOST_SAVED_S = 0.5   # processor time that a program may use later than it was given
_FEWEST_STEPS = 20    # until a program counts as one that never waits
_BUSY_SHARE = 0.9     # of the steps


class Lockstep:
    """Waits until one program has processed each step of the world.

    Args:
        program: the program.
        judge: process id of the process that steps the world.
        processor_seconds: that the program may use in all.
        permit: lets the ROS master send notices, once the program waits; returns whether there
            were any.
    """

    def __init__(self, program: Program, judge: int, processor_seconds: float,
                 permit: Callable[[], bool]) -> None:
        self._program, self._permit = program, permit
        self._start_seconds = min(_START_S, _START_SHARE * processor_seconds)
        main = threading.get_native_id()
        self._threads = ThreadStates(judge, lambda: {main, program.watcher})
        self._has_network = "network" in os.environ.get("BOX_ISOLATION", "").split(",")
        """Of its own: all its connections are those of the program and the world."""
        self._sim = 0.0
        self._began: Optional[float] = None
        self._steps, self._busy_steps = 0, 0
        self._saved_s = self._spent_s = 0.0
        """Processor time that the program may use, and that it has used since the last step, s."""

    @property
    def never_waits(self) -> bool:
        """Whether the program has hardly ever waited for the world."""
        return self._steps >= _FEWEST_STEPS and self._busy_steps > _BUSY_SHARE * self._steps

    def start(self, step: Callable[[], object]) -> None:
        """Wait until the program has started and waits for the world.

        `step` makes the first step: rospy looks for a sim time above 0 every 0.3 s of wall time,
        after it has received that time. A program that never waits is waited for only once.
        """
        waits = self._wait(self._start_seconds)
        step()
        if waits and self._wait(self._start_seconds):
            time.sleep(_FIRST_S if self._program.running else 0.0)
            self._wait(self._start_seconds)
        self._began = time.monotonic()

    def wait(self, seconds: float) -> None:
        """Wait after steps of `seconds` of sim time; not faster than real time."""
        if not self._program.running:
            return
        self._steps += 1
        self._saved_s = min(self._saved_s + seconds, _MOST_SAVED_S)
        self._busy_steps += not self._wait(self._saved_s)
        self._saved_s = max(0.0, self._saved_s - self._spent_s)
        self._sim += seconds
        if self._began is not None:
            time.sleep(max(0.0, self._began + self._sim - time.monotonic()))

    def _wait(self, processor_seconds: float) -> bool:
        """Whether the program waits now; False if its processor time is used up."""
        first: Optional[float] = None
        self._spent_s = 0.0
        deadline = time.monotonic() + _LONGEST_S
        waiting, is_quiet = 0, False
        pause = _LOOK_S
        self._threads.refresh()
        while self._program.running:
            time.sleep(pause)
            began = time.monotonic()
            if self._threads.any_runs():
                waiting, is_quiet = 0, False
                used = self._read_processor_time()
                first = used if first is None else first
                self._spent_s = used - first
                if self._spent_s >= processor_seconds or began > deadline:
                    self._permit()
                    return False
                took = time.monotonic() - began
                pause = max(_BUSY_LOOK_S, min(took / _LOOK_SHARE, processor_seconds))
                continue
            waiting, pause = waiting + 1, _LOOK_S
            has_started = self._threads.refresh()   # such threads are looked at the next time
            # Two looks: threads are looked at one after the other, and hand work to each other.
            if waiting >= _STUCK_LOOKS or is_quiet and not has_started:
                if not self._permit():
                    return True
                waiting, is_quiet = 0, False
                continue
            is_quiet = not self._bytes_under_way()
        self._permit()
        return True

    def close(self) -> None:
        """Close the files of the thread states."""
        self._threads.close()

    def _read_processor_time(self) -> float:
        """Processor time of the program so far, s: of its threads, and of processes that ended."""
        total = 0.0
        for pid in self._program.processes.pids():
            with contextlib.suppress(OSError, ValueError, IndexError):
                with open(f"/proc/{pid}/stat", encoding="utf-8", errors="replace") as stat:
                    ended = stat.read().rpartition(")")[2].split()[13:15]
                total += sum(map(int, ended)) / os.sysconf("SC_CLK_TCK")
                for thread in os.listdir(f"/proc/{pid}/task"):
                    with open(f"/proc/{pid}/task/{thread}/schedstat", encoding="ascii") as stat:
                        total += int(stat.read().split()[0]) * 1e-9
        return total

    def _bytes_under_way(self) -> bool:
        """Whether a TCP connection has bytes that were not read or not acknowledged."""
        found: Set[str] = set()
        for name in ("tcp", "tcp6"):
            with contextlib.suppress(OSError):
                with open(f"/proc/net/{name}", encoding="ascii") as table:
                    next(table)
                    found.update(words[9] for words in map(str.split, table)
                                 if words[4] != "00000000:00000000")
        return bool(found) and (self._has_network or bool(found & self._threads.sockets()))
