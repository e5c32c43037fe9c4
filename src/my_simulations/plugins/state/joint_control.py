"""libJointControlPlugin.so: holds joints at an effort, a position or a rate.

Parameters are those of Gazebo: `<controller type="force|position|velocity">` with a `<target>`,
`<pid_gains>` and `<joint>`s, whose names are regular expressions. As there, the integral term of a
loop stays within 1 N m or N and its effort within 1000, and a controller without a target drives
nothing.
"""
from __future__ import annotations

import re
from typing import List

from ...engine.drive_commands import JointServo, PidGains
from ..base import Plugin
from ..context import PluginError
from ..parameters import Parameters

# Gazebo's joint controller: gains, limit of the integral term and of the effort, N m or N.
_USUAL = (1.0, 0.1, 0.01)
_MOST_INTEGRAL, _MOST_EFFORT = 1.0, 1000.0


class JointControl(Plugin):
    """Send the servos once; the engine does the rest."""

    def load(self) -> None:
        controllers = self.context.parameters.children("controller")
        if not controllers:
            raise PluginError("it has no <controller>")
        for controller in controllers:
            servo = self._servo(controller)
            for name in self._names(controller):
                if "target" in controller:
                    self.context.joint(name).set_servo(servo)

    def reset(self) -> None:
        """Keep the targets after a reset."""
        self.load()

    def _servo(self, p: Parameters) -> JointServo:
        kind, target = p.attribute("type"), p.number("target", 0.0)
        if kind == "force":
            return JointServo(0, "effort", target=target)
        if kind not in ("position", "velocity"):
            raise PluginError(f"there is no controller of type '{kind}'; there are force, position"
                              " and velocity")
        gains = PidGains(*p.vector("pid_gains", _USUAL), -_MOST_INTEGRAL, _MOST_INTEGRAL,
                         antiwindup=True)
        return JointServo(0, "effort", target=target, gains=gains, of_rate=kind == "velocity",
                          by_rates=kind == "position", most_effort=_MOST_EFFORT)

    def _names(self, p: Parameters) -> List[str]:
        names = [joint.name for joint in self.context.description.joints if joint.type != "fixed"]
        found: List[str] = []
        for wanted in p.texts("joint"):
            try:
                pattern = re.compile(wanted)
            except re.error as fault:
                raise PluginError(f"<joint> {wanted} is no regular expression: {fault}") from fault
            matching = [name for name in names if pattern.fullmatch(name)]
            if not matching:
                self.context.warn(f"<joint> {wanted} fits none of {', '.join(names)}")
            found += matching
        return found
