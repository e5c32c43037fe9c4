"""steer_bot_hardware_gazebo: a car that a controller drives as one wheel and one steering axis.

Parameters are those of steer_drive_ros, below `steer_bot_hardware_gazebo`: the joint `rear_wheel`
stands for `virtual_rear_wheels` and `virtual_front_wheels`, which all turn at its rate, the joint
`front_steer` for `virtual_front_steers`. Where it differs: the places of the steering axes decide
left and right (original: their order); with `enable_ackermann_link` the wheels are steered by the
geometry of Ackermann, tan(angle) = h tan(a) / (h +- w/2 tan(a)), else both by the commanded angle
(the original steers them by half of the difference, and without the link the left one by twice the
angle); `gains` are not used, motors without limits of effort and rate turn the joints.
"""
from __future__ import annotations

import math
from typing import Callable, Dict, List, Sequence, Tuple

from ...description.transmission import Transmission
from ..context import Context, PluginError
from .hardware import POSITION, VELOCITY, Hardware, HardwareJoint
from .limits import JointLimits, joint_origin, limits_of
from .settings import Settings

_NAMESPACE = "steer_bot_hardware_gazebo"

Part = Tuple[HardwareJoint, Callable[[float], float]]
"""A joint, and its command by that of the joint that it is a part of."""


class JointGroup(HardwareJoint):
    """Several joints that follow one command; its state is the mean of the first `counted`."""

    def __init__(self, name: str, interface: str, parts: Sequence[Part], counted: int) -> None:
        self.name, self.interface, self.limits = name, interface, JointLimits()
        self.halted = self.is_held = False
        self._parts, self._value = list(parts), 0.0
        self._counted = [joint for joint, _ in parts[:counted]]

    @property
    def position(self) -> float:
        """rad."""
        return sum(joint.position for joint in self._counted) / len(self._counted)

    @property
    def velocity(self) -> float:
        """rad/s."""
        return sum(joint.velocity for joint in self._counted) / len(self._counted)

    @property
    def drive_gains(self) -> None:
        """None: the joints have no gains."""
        return None

    def command(self, value: float) -> None:
        """Command a rate or a position."""
        if not self.halted:
            self._value, self.is_held = value, False
            for joint, share in self._parts:
                joint.command(share(value))

    def read_command(self, step: int, step_size: float) -> float:
        return self._value

    def hold(self) -> None:
        for joint, _ in self._parts:
            joint.hold()
        self.is_held = True

    def set_idle(self) -> None:
        """Hold positions, or command rate 0."""
        if not self.halted:
            for joint, _ in self._parts:
                joint.set_idle()
            self.is_held = False


class SteerBotHardware(Hardware):
    """The joints of the parameters; transmissions do not count."""

    needs_transmissions = False

    def __init__(self, context: Context, transmissions: Sequence[Transmission]) -> None:
        super().__init__(context, [])
        s = Settings(context, _NAMESPACE)
        rear = [self._make_joint(name, VELOCITY) for name in s.texts("virtual_rear_wheels")]
        front = [self._make_joint(name, VELOCITY) for name in s.texts("virtual_front_wheels", [])]
        steers = [self._make_joint(name, POSITION) for name in s.texts("virtual_front_steers")]
        if len(steers) != 2:
            raise PluginError(f"parameter {_NAMESPACE}/virtual_front_steers must name two joints,"
                              f" right and left; it names {len(steers)}")
        steers.sort(key=self._place)
        groups: Dict[str, JointGroup] = {}
        name = s.text("rear_wheel")
        groups[name] = JointGroup(name, VELOCITY, [(one, _same) for one in rear + front],
                                  len(rear))
        name = s.text("front_steer")
        groups[name] = JointGroup(name, POSITION, list(zip(steers, _steering(s))), 2)
        self.names = [one.name for one in rear + front + steers]
        for name, group in groups.items():
            self._all[(group.interface, name)] = group
            self._active[name] = group

    def _place(self, joint: HardwareJoint) -> float:
        """Return the y coordinate of a joint in the model, m."""
        return joint_origin(self._context.joint(joint.name).spec, self._context.description)[1]

    def _make_joint(self, name: str, interface: str) -> HardwareJoint:
        joint = self._context.joint(name)
        limits = limits_of(joint.spec, self._context)
        return HardwareJoint(joint, interface, JointLimits(limits.lower, limits.upper), None, 0.0)


def _same(value: float) -> float:
    return value


def _steering(s: Settings) -> List[Callable[[float], float]]:
    """The angles of the right and the left wheel by that of the middle of the axle."""
    if not s.flag("enable_ackermann_link", False):
        return [_same, _same]
    base, width = s.number("wheel_separation_h", 0.0), s.number("wheel_separation_w", 0.0)
    if base <= 0.0:
        raise PluginError(f"parameter {_NAMESPACE}/wheel_separation_h must be above 0 m, it is"
                          f" {base:g}")

    def turned(side: float) -> Callable[[float], float]:
        return lambda angle: math.atan2(base * math.sin(angle), base * math.cos(angle)
                                        + side * width / 2.0 * math.sin(angle))

    return [turned(1.0), turned(-1.0)]
