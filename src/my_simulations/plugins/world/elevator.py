"""libElevatorPlugin.so and libgazebo_ros_elevator.so: a lift with a door that goes to floors.

Parameters, gains and the sequence are those of Gazebo: close the door, go to the floor, open the
door, wait, close it; further calls are ignored meanwhile. A floor is a number in a
std_msgs/String. The wait passes in sim time.
"""
from __future__ import annotations

import math
from typing import Any, Callable, List

from ...engine.drive_commands import JointServo, PidGains
from ..base import Plugin
from ..context import Joint
from ..stepwise_change import StepwiseChange
from ..time_out import TimeOut

_HERTZ = 100.0
_DOOR_GAINS, _LIFT_GAINS = PidGains(2.0, 0.0, 1.0), PidGains(1e5, 0.0, 1e5)
_OPEN, _CLOSED = 1.0, 0.0        # m, of the door's joint
_DOOR_NEAR, _LIFT_NEAR = 0.05, 0.15   # m

Stage = Callable[[], bool]
"""Is called until it says that it is over."""


class Elevator(Plugin):
    """Drives the joints `<lift_joint>` and `<door_joint>`."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        self._lift, self._door = self._joint("lift_joint"), self._joint("door_joint")
        self._height = p.number("floor_height", 3.0)
        self._wait = TimeOut(context, p.number("door_wait_time", 5.0))
        context.subscribe(p.text("topic") or "elevator", "std_msgs/String", self._receive)
        self._change = StepwiseChange(context, _HERTZ, self._update)
        self.reset()

    def _joint(self, name: str) -> Joint:
        return self.context.joint(self.required_text(name).rpartition("::")[2])

    def reset(self) -> None:
        """On the ground, with a closed door."""
        self._change.end()
        self._stages: List[Stage] = []
        self._move_to_floor(0)
        self._move_door(_CLOSED)

    def _receive(self, message: Any) -> None:
        try:
            floor = int(str(message.data).strip())
            float(floor)
        except (ValueError, OverflowError):
            self.context.warn(f"'{message.data}' is no floor; a floor is a number")
            return
        if not self._stages:
            self._stages = [self._door_stage(_CLOSED), self._lift_stage(floor),
                            self._door_stage(_OPEN), self._waiting(), self._door_stage(_CLOSED)]
            self._change.begin()

    def _update(self, dt: float) -> bool:
        """Go on with the stages of a call; whether all are over."""
        if self._stages and self._stages[0]():
            self._stages.pop(0)
        return not self._stages

    def _move_to_floor(self, floor: int) -> None:
        self._level = floor * self._height
        self._lift.set_servo(_servo(self._lift, _LIFT_GAINS, self._level))

    def _move_door(self, place: float) -> None:
        self._door.set_servo(_servo(self._door, _DOOR_GAINS, place))

    def _door_stage(self, place: float) -> Stage:
        def go_on() -> bool:
            self._move_door(place)
            return abs(self._door.position - place) < _DOOR_NEAR

        return go_on

    def _lift_stage(self, floor: int) -> Stage:
        def go_on() -> bool:
            self._move_to_floor(floor)
            return abs(self._lift.position - self._level) < _LIFT_NEAR

        return go_on

    def _waiting(self) -> Stage:
        begun = False

        def go_on() -> bool:
            nonlocal begun
            if not begun:
                begun = True
                self._wait.begin()
            return self._wait.is_over

        return go_on


def _servo(joint: Joint, gains: PidGains, target: float) -> JointServo:
    axis = joint.spec.axis
    most = axis.effort if axis is not None and axis.effort > 0.0 else math.inf
    return JointServo(0, "effort", target=target, gains=gains, by_rates=True, most_effort=most)
