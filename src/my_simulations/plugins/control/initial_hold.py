"""Holds the joints of a robot until its controllers start, or are known not to come."""
from __future__ import annotations

from typing import Callable, List, Optional

from ..context import CallHandle, Context
from .hardware import Hardware

PATIENCE_S = 10.0
"""How long joints are held for the first controller, s of sim time."""

FURTHER_S = 1.0
"""How long they are held for further controllers after the first one has started."""


class InitialHold:
    """Holds joints from the first step on, so that a robot starts as it was spawned.

    Gazebo holds joints with a position or velocity interface at once, and lets those with an effort
    interface fall until their controller starts: how far depends on the speed of the machine. Here
    all are held. A controller takes its joints over. The others rest a while later: positions are
    held with the effort of the joint, rates and efforts are 0.

    Args:
        context: of the plugin.
        hardware: the joints.
        claimed: returns the names of the joints that controllers drive.
    """

    def __init__(self, context: Context, hardware: Hardware,
                 claimed: Callable[[], List[str]]) -> None:
        self._context, self._hardware, self._claimed = context, hardware, claimed
        self._timer: Optional[CallHandle] = None
        self._limited = False

    def begin(self) -> None:
        """Hold all joints, unless a controller drives some."""
        if self._claimed():
            return
        self._limited = False
        self._hardware.hold()
        self._wait(PATIENCE_S)

    def limit(self) -> None:
        """A controller has started: wait a little for others."""
        if not self._limited:
            self._limited = True
            self._wait(FURTHER_S)

    def _wait(self, seconds: float) -> None:
        if self._timer is not None:
            self._timer.end()
        self._timer = self._context.once(self._context.now_ns + round(seconds * 1e9), self._end)

    def _end(self) -> None:
        self._timer = None
        released = self._hardware.end_holds(but=self._claimed())
        if released and not self._limited:
            self._context.info(f"no controller has started within {PATIENCE_S:g} s of sim time; "
                               "these joints are not held any more, as they have an effort"
                               f" interface: {', '.join(released)}")
