"""libGimbalSmall2dPlugin.so: a loop that holds the tilt joint of a camera's gimbal.

The joint, its default name, the gain of 1 N m/rad, the limit of 1 N m and the angle of pi/2 rad are
those of Gazebo 11. Commands for another angle come there from a topic of Gazebo's own transport,
which does not exist here, so the joint stays at this angle.
"""
from __future__ import annotations

import math

from ...engine.drive_commands import JointServo, PidGains
from ..base import Plugin

_ANGLE = math.pi / 2.0   # rad
_MOST_EFFORT = 1.0       # N m


class Gimbal(Plugin):
    """Holds the joint `<joint>`."""

    def load(self) -> None:
        """Find the joint; begin to hold it."""
        name = self.context.parameters.text("joint") or "tilt_joint"
        self._joint = self.context.joint(name.rpartition("::")[2])
        self.reset()

    def reset(self) -> None:
        self._joint.set_servo(JointServo(0, "effort", target=_ANGLE, gains=PidGains(1.0),
                                         most_effort=_MOST_EFFORT))
