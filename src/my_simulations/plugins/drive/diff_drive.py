"""libgazebo_ros_diff_drive.so: two driven wheels, odometry, tf.

Parameters, defaults, topics and laws are those of gazebo_plugins. Where it differs: wheel frames
are given in the links that carry the wheels (original: in the model); encoder odometry comes from
the positions of the wheels, so that it has no drift of its own; its forward velocity has a sign.
"""
from __future__ import annotations

from typing import Tuple

from .odometry import WheelCounter
from .velocity_drive import OdometryDrive

_REACHED = 0.01  # m/s: a wheel that is so near to its speed has it (gazebo_plugins)


class DiffDrive(OdometryDrive):
    def load(self) -> None:
        context, p = self.enter_namespace(self.context.model)
        self._separation = p.positive("wheelSeparation", 0.34)
        self._radius = p.positive("wheelDiameter", 0.15) / 2.0
        self._acceleration = p.number("wheelAcceleration", 0.0)
        self._torque = p.number("wheelTorque", 5.0)
        self._encoder = p.choice("odometrySource", {"encoder": True, "world": False}, False)
        self._publishes = p.flag("publishTf", True)
        self._broadcasts = p.flag("publishOdomTF", True)
        # <legacyMode> of Kinetic has no effect in Melodic and Noetic.
        self._joints = (context.joint(p.text("leftJoint", "left_joint")),
                        context.joint(p.text("rightJoint", "right_joint")))
        self._counter = WheelCounter(*self._joints, self._radius, self._separation)
        self._odometer = self.make_odometer(publishes=self._publishes)
        self.offer_wheels(self._joints)
        hertz = p.number("updateRate", 100.0)
        self.follow_commands(hertz)
        self.reset()
        # Encoders count at all updates, with and without subscribers.
        transforms = self._publishes and self._broadcasts or self._frames is not None
        if self.topics or transforms:
            context.observe(hertz, self.publish, self.topics, transforms=transforms,
                            remembers=self._encoder and self._publishes)

    def reset(self) -> None:
        self._instructed = [0.0, 0.0]
        super().reset()

    def _follow(self, dt: float) -> bool:
        """Approach the command; return whether the wheel speeds have reached it."""
        speeds = self._speeds(dt)
        self._drive(speeds)
        return speeds == self._command.wheel_speeds(self._separation)

    def _speeds(self, dt: float) -> Tuple[float, float]:
        """Of the rims, m/s, within the acceleration."""
        wanted = self._command.wheel_speeds(self._separation)
        if self._acceleration <= 0.0:
            return wanted
        present = [joint.velocity * self._radius for joint in self._joints]
        if any(abs(a - b) < _REACHED for a, b in zip(wanted, present)):
            self._instructed = list(wanted)
            return wanted
        most = self._acceleration * dt
        for n in (0, 1):
            before = self._instructed[n]
            after = before + max(-most, min(most, wanted[n] - present[n]))
            # Clamp to the command, so that a blocked wheel causes no wind-up.
            self._instructed[n] = min(max(after, min(before, wanted[n])), max(before, wanted[n]))
        return self._instructed[0], self._instructed[1]

    def _drive(self, speeds: Tuple[float, float] = (0.0, 0.0)) -> None:
        for joint, speed in zip(self._joints, speeds):
            joint.drive(speed / self._radius, self._torque)
