"""The topic `wheel_joint_controller_state` of diff_drive_controller."""
from __future__ import annotations

import math
from typing import List, Sequence, Tuple

from ..context import Context, Publication
from ..frames import stamped
from .hardware import HardwareJoint


class WheelStates:
    """Publishes commanded and present states of the wheels, left wheels first.

    Args:
        context: of the plugin.
        sides: the left and the right wheels.
        publication: of the type control_msgs/JointTrajectoryControllerState.
    """

    def __init__(self, context: Context, sides: Sequence[Sequence[HardwareJoint]],
                 publication: Publication) -> None:
        self._context, self._sides, self.publication = context, sides, publication
        self._wheels = [wheel for side in sides for wheel in side]
        self._ahead = [0.0] * len(self._wheels)   # positions by the commands, rad
        self._before: List[Tuple[float, float]] = [(0.0, 0.0)] * len(self._wheels)
        self._told_ns = context.now_ns

    def publish(self, rates: Tuple[float, float]) -> None:
        """Publish the state; `rates` are commanded for the left and right wheels, rad/s."""
        message = stamped(self._context, "control_msgs/JointTrajectoryControllerState")
        message.joint_names = [wheel.name for wheel in self._wheels]
        now = self._context.now_ns
        dt, self._told_ns = (now - self._told_ns) * 1e-9, now
        wanted = [rate for side, rate in zip(self._sides, rates) for _ in side]
        turning = [wheel.velocity for wheel in self._wheels]
        self._ahead = [at + rate * dt for at, rate in zip(self._ahead, wanted)]
        desired, actual, error = message.desired, message.actual, message.error
        desired.positions, desired.velocities = list(self._ahead), wanted
        actual.positions, actual.velocities = [w.position for w in self._wheels], turning
        desired.accelerations, actual.accelerations = (
            [(new - old[which]) / dt if dt > 0.0 else 0.0
             for new, old in zip(rates_now, self._before)]
            for which, rates_now in enumerate((wanted, turning)))
        desired.effort = [math.nan] * len(self._wheels)
        for field in ("positions", "velocities", "accelerations"):
            setattr(error, field, [a - b for a, b in zip(getattr(desired, field),
                                                         getattr(actual, field))])
        self._before = list(zip(wanted, turning))
        self.publication.publish(message)
