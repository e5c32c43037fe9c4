"""libROSConveyorBeltPlugin.so: a belt that carries bodies.

Parameters, defaults, service and topic are those of the plugin of the ARIAC competition and its
copies. The belt is a link on a prismatic joint; the joint moves, and jumps back before its upper
limit, which bodies on a long belt do not notice. Where it differs: the belt is always enabled, for
`<enable_topic>` is one of Gazebo's own transport; nothing is told to a plugin that populates it.
"""
from __future__ import annotations

from typing import Any, Optional

from ...description.model import INFINITE
from ..base import Plugin
from ..context import CallHandle, PluginError
from ..parameters import namespace_or

PACKAGES = ("osrf_gear", "nist_gear", "gazebo_conveyor", "conveyor_gazebo")
"""Packages with the messages of the plugin, which each copy of it has renamed."""

_FASTEST = 0.2        # m/s at full power
_EFFORT = 1e6         # N: the belt keeps its velocity, whatever lies on it
_STATE_HZ = 100.0
_CHECKS = 20.0        # between two jumps


class ConveyorBelt(Plugin):
    """Moves the joint `<joint>`, `belt_joint` by default."""

    def load(self) -> None:
        context, p = self.context, self.context.parameters
        context.use_namespace(p.text("robot_namespace") or namespace_or(p, ""))
        self._joint = context.joint((p.text("joint") or "belt_joint").rpartition("::")[2])
        self._fastest = p.number("max_velocity", p.number("max_belt_linear_vel", _FASTEST))
        axis = self._joint.spec.axis
        self._lower, self._upper = (0.0, INFINITE) if axis is None else (
            max(0.0, axis.lower), axis.upper)
        self._timer: Optional[CallHandle] = None
        self._initial_power = self._checked(p.number("power", 0.0))
        self._offer(p.text("control_topic") or "conveyor/control",
                    p.text("state_topic") or "conveyor/state")
        self.reset()

    def _checked(self, power: float) -> float:
        if not 0.0 <= power <= 100.0:
            raise PluginError(f"<power> must be 0 to 100, it is {power}")
        return power

    def _offer(self, control: str, state: str) -> None:
        context = self.context
        for package in PACKAGES:
            try:
                context.serve(control, f"{package}/ConveyorBeltControl", self._set_asked)
            except PluginError:
                continue
            self._kind = f"{package}/ConveyorBeltState"
            self._states = context.publish(state, self._kind)
            context.observe(_STATE_HZ, self._publish, [self._states])
            return
        context.warn("the power of the belt stays: none of the packages with"
                     f" ConveyorBeltControl is installed ({', '.join(PACKAGES)})")

    def reset(self) -> None:
        """Run with the power of the description."""
        self._set(self._initial_power)

    def _set_asked(self, request: Any, response: Any) -> None:
        power = power_of(request)
        response.success = 0.0 <= power <= 100.0
        if response.success:
            self._set(power)
        else:
            self.context.warn(f"the power of a belt is 0 to 100, {power} was asked for")

    def _set(self, power: float) -> None:
        self._power, self._velocity = power, self._fastest * power / 100.0
        self._joint.drive(self._velocity, _EFFORT)
        if self._timer is not None:
            self._timer.end()
            self._timer = None
        span = self._upper - self._lower
        if self._velocity > 0.0 and 0.0 < span and self._upper < INFINITE:
            self._timer = self.context.every(_CHECKS * self._velocity / span, self._jump_back)

    def _jump_back(self) -> None:
        """Go back to the beginning before the limit stops the belt."""
        ahead = 2.0 * (self._upper - self._lower) / _CHECKS
        if self._joint.position > self._upper - ahead:
            self.context.set_joint_positions({self._joint.name: self._lower})
            self._joint.drive(self._velocity, _EFFORT)

    def _publish(self) -> None:
        message = self.context.message(self._kind)
        message.enabled, message.power = True, self._power
        self._states.publish(message)


def power_of(request: Any) -> float:
    """Per cent: some copies ask for a power, that of 2017 asks for a state that has one."""
    return float(request.power if hasattr(request, "power") else request.state.power)
