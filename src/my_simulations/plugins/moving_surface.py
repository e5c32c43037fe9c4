"""A surface that moves at a velocity, such as a conveyor belt."""
from __future__ import annotations

from ..description.model import INFINITE
from .call_slot import CallSlot
from .context import Context

_EFFORT = 1e6         # N: the surface keeps its velocity, whatever lies on it
_CHECKS = 20.0        # between two jumps


class MovingSurface:
    """Moves a long link at a velocity: bodies that lie on it are carried by friction.

    The link is the child of a prismatic joint. Before the joint reaches a limit, it jumps back in
    one step and keeps its velocity. The link must be longer than the way of the joint, so that
    bodies stay on it.

    Args:
        context: of the plugin.
        joint: the name of the joint.

    Raises PluginError if the model has no such joint.
    """

    def __init__(self, context: Context, joint: str) -> None:
        self._context, self._joint = context, context.joint(joint)
        axis = self._joint.spec.axis
        self._lower, self._upper = (0.0, INFINITE) if axis is None else (axis.lower, axis.upper)
        self._timer = CallSlot()
        self.velocity = 0.0

    def set_velocity(self, velocity: float) -> None:
        """Keep a velocity along the axis of the joint, m/s, from the next step on."""
        self.velocity = velocity
        self._joint.drive(velocity, _EFFORT)
        self._timer.end()
        span = abs(self._end() - self._start())
        if velocity and 0.0 < span < INFINITE:
            self._timer.set(self._context.every(_CHECKS * abs(velocity) / span, self._jump_back))

    def _start(self) -> float:
        """The position to which the joint jumps back."""
        if self.velocity < 0.0:
            return self._upper
        return 0.0 if self._lower < 0.0 < self._upper else self._lower

    def _end(self) -> float:
        return self._lower if self.velocity < 0.0 else self._upper

    def _jump_back(self) -> None:
        start, end = self._start(), self._end()
        if abs(end - self._joint.position) < 2.0 * abs(end - start) / _CHECKS:
            self._context.set_joint_positions({self._joint.name: start})
            self._joint.drive(self.velocity, _EFFORT)
