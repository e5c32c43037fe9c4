"""libleo_gazebo_differential_plugin.so and libwarthog_suspension_plugin.so: springs at joints.

Parameters and laws are those of leo_gazebo_plugins and warthog_gazebo. The engine evaluates the
springs of the second in every step.

libroboticsgroup_gazebo_mimic_joint_plugin.so: a joint that follows another one.

Parameters and defaults are those of roboticsgroup_gazebo_plugins and of its copies
(libroboticsgroup_upatras_gazebo_mimic_joint_plugin.so): q_mimicJoint = multiplier q_joint + offset.
The physics engine keeps that exactly in every step, so `maxEffort`, `sensitiveness` and PID gains
are not needed.
"""
from __future__ import annotations

from ...engine.drive_commands import JointServo, PidGains
from ..base import Plugin

_SUSPENSIONS = ("left_diff_unit_joint", "right_diff_unit_joint")


class Differential(Plugin):
    """A bar between two rockers: efforts -k (a - b) on `<jointA>` and k (a - b) on `<jointB>`."""

    def load(self) -> None:
        p = self.context.parameters
        one, other, _ = map(self.required_text, ("jointA", "jointB", "forceConstant"))
        self._one, self._other = self.context.joint(one), self.context.joint(other)
        self._constant = p.number("forceConstant", 0.0)
        self.context.every(0.0, self.update)

    def update(self) -> None:
        effort = self._constant * (self._one.position - self._other.position)
        self._one.set_servo(JointServo(0, "effort", target=-effort))
        self._other.set_servo(JointServo(0, "effort", target=effort))


class WarthogSuspension(Plugin):
    """Springs of `<suspension_k>` and dampers of `<suspension_b>` about 0."""

    def load(self) -> None:
        p = self.context.parameters
        gains = PidGains(p.number("suspension_k", 0.0), d=p.number("suspension_b", 0.0))
        for name in _SUSPENSIONS:
            self.context.joint(name).set_servo(JointServo(0, "effort", gains=gains, by_rates=True))

    def reset(self) -> None:
        self.load()


class MimicJoint(Plugin):
    """Couples `<mimicJoint>` to `<joint>`."""

    def load(self) -> None:
        p = self.context.parameters
        leader, follower = self.required_text("joint"), self.required_text("mimicJoint")
        self.context.mimic(follower, leader, p.number("multiplier", 1.0), p.number("offset", 0.0))
