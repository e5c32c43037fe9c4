"""libroboticsgroup_gazebo_mimic_joint_plugin.so: a joint that follows another one.

Parameters and defaults are those of roboticsgroup_gazebo_plugins and of its copies
(libroboticsgroup_upatras_gazebo_mimic_joint_plugin.so): q_mimicJoint = multiplier q_joint + offset.
The physics engine keeps that exactly in every step, so `maxEffort`, `sensitiveness` and PID gains
are not needed.
"""
from __future__ import annotations

from ..base import Plugin
from ..context import PluginError


class MimicJoint(Plugin):
    """Couples `<mimicJoint>` to `<joint>`."""

    def load(self) -> None:
        p = self.context.parameters
        leader, follower = p.text("joint"), p.text("mimicJoint")
        for name, value in (("joint", leader), ("mimicJoint", follower)):
            if not value:
                raise PluginError(f"it has no <{name}>")
        self.context.mimic(follower, leader, p.number("multiplier", 1.0), p.number("offset", 0.0))
