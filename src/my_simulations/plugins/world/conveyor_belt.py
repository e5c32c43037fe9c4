"""libROSConveyorBeltPlugin.so: a belt that carries bodies.

Parameters, defaults, service and topic are those of the plugin of the ARIAC competition and its
copies. It differs in this: the belt is always enabled, because `<enable_topic>` is one of Gazebo's
own transport, and a plugin that populates the belt is not notified.
"""
from __future__ import annotations

from typing import Any

from ..base import Plugin
from ..context import PluginError
from ..moving_surface import MovingSurface

PACKAGES = ("osrf_gear", "nist_gear", "gazebo_conveyor", "conveyor_gazebo")
"""Packages with the messages of the plugin, which each copy of it has renamed."""

_FASTEST = 0.2        # m/s at full power
_STATE_HZ = 100.0


class ConveyorBelt(Plugin):
    """Moves the joint `<joint>`, `belt_joint` by default."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        if p.text("robot_namespace"):
            context.use_namespace(p.text("robot_namespace"))
        self._surface = MovingSurface(
            context, (p.text("joint") or "belt_joint").rpartition("::")[2])
        self._fastest = p.number("max_velocity", p.number("max_belt_linear_vel", _FASTEST))
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
        self._power = power
        self._surface.set_velocity(self._fastest * power / 100.0)

    def _publish(self) -> None:
        message = self.context.message(self._kind)
        message.enabled, message.power = True, self._power
        self._states.publish(message)


def power_of(request: Any) -> float:
    """Per cent: some copies ask for a power, that of 2017 asks for a state that has one."""
    return float(request.power if hasattr(request, "power") else request.state.power)
