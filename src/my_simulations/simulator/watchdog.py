"""Detects an engine that hangs, as opposed to one that gets no processor time."""
from __future__ import annotations

import os
import time
from typing import Callable, Optional, Tuple

PERIOD_S = 2.0
"""Longest time between two checks; a longer one means that this process was stopped, too."""

_STALL_S = 30.0     # of processor time without a sign of life, or asleep
_START_S = 90.0     # the same until the first sign of life; imports give none
_WALL_S = 900.0     # regardless of processor time
_WAITS = "RD"       # states of a process that waits for a processor or is stopped (proc(5))

Probe = Callable[[int], Optional[Tuple[float, str]]]


def process_time(pid: int) -> Optional[Tuple[float, str]]:
    """Processor time (s) and state of a process (proc(5), stat); None if it does not exist."""
    try:
        with open(f"/proc/{pid}/stat", encoding="ascii", errors="replace") as stat:
            fields = stat.read().rpartition(")")[2].split()
    except OSError:
        return None
    ticks = int(fields[11]) + int(fields[12])
    return ticks / os.sysconf("SC_CLK_TCK"), fields[0]


def resident_bytes(pid: int) -> int:
    """Memory of a process that is in use (proc(5), statm); 0 if it does not exist."""
    try:
        with open(f"/proc/{pid}/statm", encoding="ascii") as statm:
            return int(statm.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except (OSError, IndexError):
        return 0


class Watchdog:
    """Checks an engine periodically.

    Time counts against an engine only while it computes or sleeps: an engine that waits for a
    processor on a busy machine, or is stopped together with the whole node, does not hang.
    """

    def __init__(self, probe: Probe = process_time,
                 clock: Callable[[], float] = time.monotonic) -> None:
        self._probe = probe
        self._clock = clock
        self._sign: object = None
        self._starting = True
        self._looked = clock()
        self._cpu = self._used = self._asleep = self._wall = 0.0

    def begin(self) -> None:
        """Start over for a new engine, which may take longer to start."""
        self._starting = True
        self._forget(0.0)
        self._looked = self._clock()

    def check(self, pid: int, sign: object) -> str:
        """For how long the engine has hung; "" if it does not.

        Args:
            pid: its process id; 0 for an engine without a process, for which wall time counts.
            sign: a value that changes while it works.
        """
        now = self._clock()
        passed, self._looked = min(now - self._looked, 2.0 * PERIOD_S), now
        cpu, state = self._probe(pid) or (self._cpu, "S")
        if sign != self._sign:
            self._starting = self._starting and self._sign is None
            self._sign = sign
            self._forget(cpu)
            return ""
        self._wall += passed
        if cpu == self._cpu and state not in _WAITS:
            self._asleep += passed
        self._used += max(0.0, cpu - self._cpu)
        self._cpu = cpu
        limit = _START_S if self._starting else _STALL_S
        if self._used > limit:
            return f"{limit:.0f} s of processor time"
        if self._asleep > limit:
            return f"{limit:.0f} s while idle"
        return f"{_WALL_S:.0f} s" if self._wall > _WALL_S else ""

    def _forget(self, cpu: float) -> None:
        self._cpu = cpu
        self._used = self._asleep = self._wall = 0.0
