"""What drives with two wheels and odometry share: time between updates, and how the robot moved."""
from __future__ import annotations

from typing import Tuple

from ...geometry import Pose
from ..base import Plugin
from .odometry import WheelCounter, in_base


class OdometryDrive(Plugin):
    """Integrates wheel odometry, and publishes it or the true motion."""

    _counter: WheelCounter
    _encoder: bool   # publish wheel odometry, else the true pose

    def clock_set(self) -> None:
        """Measure time from now; keep the odometry pose."""
        self._last_ns = self.context.now_ns
        self._counter.discard_rotation()

    def elapsed(self) -> float:
        """Sim time since the last call, or since `clock_set`, s."""
        before, self._last_ns = self._last_ns, self.context.now_ns
        return (self._last_ns - before) * 1e-9

    def motion(self) -> Tuple[Pose, Tuple[float, float, float]]:
        """Return the pose and the (forward, sideways, yaw) velocity to publish.

        The velocity of encoders is the mean since the last call.
        """
        if self._encoder:
            velocity = self._counter.count(self.elapsed())
            return self._counter.pose, velocity
        return self.context.pose, in_base(self.context.pose, self.context.twist)
