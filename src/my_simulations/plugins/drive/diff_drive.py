"""libgazebo_ros_diff_drive.so: two driven wheels, odometry, tf.

Parameters, defaults, topics and laws are those of gazebo_plugins. Where it differs: wheel frames
are given in the links that carry the wheels (original: in the model); encoder odometry comes from
the positions of the wheels, so that it has no drift of its own; its forward velocity has a sign.
"""
from __future__ import annotations

from ...engine.drive_commands import RateRamp
from .odometry import WheelCounter
from .velocity_drive import OdometryDrive

_REACHED = 0.01  # m/s: a wheel that is so near to its speed has it (gazebo_plugins)


class DiffDrive(OdometryDrive):
    def load(self) -> None:
        context, p = self.enter_namespace(self.context.model)
        self._separation = p.positive("wheelSeparation", 0.34)
        self._radius = p.positive("wheelDiameter", 0.15) / 2.0
        acceleration = p.number("wheelAcceleration", 0.0)
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
        self._ramp = None if acceleration <= 0.0 else RateRamp(
            acceleration / self._radius, _REACHED / self._radius, hertz,
            f"{context.model} {self._joints[0].name}")
        # The engine makes the steps of a ramp: it can begin at once.
        self.follow_commands(hertz, at_once=self._ramp is not None)
        self.reset()
        # Encoders count at all updates, with and without subscribers.
        transforms = self._publishes and self._broadcasts or self._frames is not None
        if self.topics or transforms:
            context.observe(hertz, self.publish, self.topics, transforms=transforms,
                            remembers=self._encoder and self._publishes)

    def _drive(self) -> None:
        for joint, speed in zip(self._joints, self._command.wheel_speeds(self._separation)):
            joint.drive(speed / self._radius, self._torque, self._ramp)

    def reset(self) -> None:
        super().reset()
        for joint in self._joints:   # at once
            joint.drive(0.0, self._torque)
