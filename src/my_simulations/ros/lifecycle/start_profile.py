"""Measures the phases of the start, for benchmarks."""
from __future__ import annotations

import os
import time
from typing import List, Tuple

VARIABLE = "MY_SIMULATIONS_PROFILE"
"""Environment variable; if 1, the node prints its phase times to standard error."""


class StartProfile:
    """Phases of a start, in seconds since the process began."""

    def __init__(self) -> None:
        self.wanted = os.environ.get(VARIABLE, "") not in ("", "0")
        self._zero = _process_start() if self.wanted else 0.0
        self.phases: List[Tuple[str, float]] = []

    def mark(self, phase: str) -> None:
        if self.wanted:
            self.phases.append((phase, time.clock_gettime(time.CLOCK_BOOTTIME) - self._zero))

    def lines(self) -> List[str]:
        """One line per phase: time of its end, and its duration, in s."""
        found, last = [], 0.0
        for phase, at in self.phases:
            found.append(f"{at:7.3f} s  +{at - last:.3f}  {phase}")
            last = at
        return found


def _process_start() -> float:
    """Start time of this process, in seconds since boot (proc(5), stat, field 22)."""
    with open("/proc/self/stat", encoding="ascii", errors="replace") as stat:
        fields = stat.read().rpartition(")")[2].split()
    return int(fields[19]) / os.sysconf("SC_CLK_TCK")
