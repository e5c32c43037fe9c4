"""When an engine that makes steps reads its states out, and when it serves commands in a row."""
from __future__ import annotations

import time
from typing import Callable

from .ring import DEMAND_NS, POSE_DEMAND_NS, WAKE_REQUESTED

NOTHING, POSES, STATES = range(3)

_MAKE_UP_S = 0.05        # of read-outs on demand, after a delay
_MOST_OWED_S = 0.01      # or the last read-out, if that took longer: its cost is made up for
_MOST_SAVED_S = 0.01
_WAKE_PERIOD_S = 0.0005
_HEAVY_S = 0.0003        # a late world with steps like this serves clients that ask in a row first
_PATIENCE_S = 0.0015     # how long it waits for a second command
_MOST_PATIENCE_S = 0.005 # and for the third and further ones: a step's time, but no longer
_PATIENT_SHARE = 0.5     # of the wall time at most
_LONGEST_ROW_S = 0.02    # without a step in between


class ReadoutSchedule:
    """Read-outs on demand, and others for a share of the wall time.

    Args:
        words: of the ring's control page, with the demands.
    """

    def __init__(self, words: memoryview) -> None:
        self._words = words
        self._allowance = 0.0
        self._allowed_at = time.perf_counter()
        self._demanded_at = self._posed_at = self._woken_at = 0.0

    def next(self, now: float, share: float) -> int:
        """What is to be read after a step: STATES, POSES or NOTHING.

        `share` of the wall time is for read-outs without a demand.
        """
        self._allowance = min(self._allowance + (now - self._allowed_at) * share, _MOST_SAVED_S)
        self._allowed_at = now
        demand, poses = self._words[DEMAND_NS], self._words[POSE_DEMAND_NS]
        demanded = _is_due(self._demanded_at, demand, now)
        if demanded or self._allowance > 0.0:
            if demanded:
                # From when it was due: steps that are made up after a delay are shown, too.
                self._demanded_at = max(self._demanded_at + demand * 1e-9, now - _MAKE_UP_S)
            self._posed_at = now
            return STATES
        if _is_due(self._posed_at, poses, now):
            self._posed_at = max(self._posed_at + poses * 1e-9, now - _MAKE_UP_S)
            return POSES
        return NOTHING

    def spend(self, seconds: float) -> None:
        """Count the wall time of a read-out of states."""
        self._allowance = max(self._allowance - seconds, -max(seconds, _MOST_OWED_S))

    def is_wake_due(self, now: float) -> bool:
        """Whether the waiting thread must be woken after a step."""
        if not self._words[WAKE_REQUESTED] or now - self._woken_at < _WAKE_PERIOD_S:
            return False
        self._woken_at = now
        return True


def _is_due(last: float, every_ns: int, now: float) -> bool:
    """Whether a read-out `every_ns` (0: never), the last one at `last` s, is due."""
    return every_ns > 0 and (now - last) * 1e9 >= every_ns - 2e5


class CommandRows:
    """Serves a row of commands without a step between each two, while steps are heavy.

    Otherwise a client that sends a thousand commands one after the other would wait a thousand
    steps of a world that is late anyway.
    """

    def __init__(self) -> None:
        self._left = 0.0   # s
        self._at = time.perf_counter()

    def serve(self, step_cost: float, serve: Callable[[float], bool],
              goes_on: Callable[[], bool]) -> None:
        """Serve what follows a command.

        Args:
            step_cost: s that a step takes.
            serve: waits for commands, s; returns whether some came.
            goes_on: whether the world still runs.
        """
        now = time.perf_counter()
        between = now - self._at
        self._left = min(_LONGEST_ROW_S, self._left
                         + between * _PATIENT_SHARE / (1.0 - _PATIENT_SHARE))
        self._at = now
        if step_cost < _HEAVY_S:
            return
        wait = _PATIENCE_S
        came = True
        while came and self._left > 0.0 and goes_on():
            came = serve(wait)
            spent = time.perf_counter() - now
            self._left -= spent
            now += spent
            # A client that sends the next one at once is worth a step's time.
            wait = max(_PATIENCE_S, min(_MOST_PATIENCE_S, step_cost))
        self._at = time.perf_counter()
