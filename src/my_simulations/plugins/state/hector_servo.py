"""libhector_servo_plugin.so: up to three servos point a sensor in a direction of a tf frame.

Source: hector_gazebo_plugins, servo_plugin.cpp. The loops run in the physics engine in every step;
`<controlRate>` is the rate of the joint states only.
"""
from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, List, Optional, Tuple

from ...engine.drive_commands import JointServo, PidGains
from ...geometry import IDENTITY_QUAT, Quat, Vec3, conjugate, multiply, normalised, rpy_from_quat
from ..base import Plugin
from ..context import PluginError
from ..finite_messages import subscribe_finite
from ..standard_messages import joint_state_message
from ..transforms import Transforms

_BASE, _LEVEL = "base_link", "base_stabilized"
_X, _Y, _Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
_X_FIRST = ((_Y,), (_X, _Y), (_X, _Y, _Z))      # axes of the servos, from the base outwards
_Z_FIRST = ((_Z, _Y), (_Z, _Y, _X))


class HectorServo(Plugin):
    """Follows the orientation in the last geometry_msgs/QuaternionStamped."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        names, axes = self._servos()
        self._joints = [context.joint(name) for name in names]
        if axes not in (*_X_FIRST, *_Z_FIRST):
            raise PluginError("the axes of its servos must be y, x y, z y, x y z or z y x")
        self._z_first, self._is_single = axes in _Z_FIRST, len(axes) == 1
        rate, torque = p.number("maxVelocity", 0.0), p.number("torque", 0.0)
        self._gains = PidGains(p.number("proportionalControllerGain", 8.0),
                               d=p.number("derivativeControllerGain", 0.0))
        self._servo = JointServo(0, "velocity", by_rates=True, most_rate=_or_unlimited(rate),
                                 most_effort=_or_unlimited(torque))
        topic = p.text("topicName", "drive")
        if topic:
            subscribe_finite(context, topic, "geometry_msgs/QuaternionStamped", self._receive)
        self._transforms = Transforms(context, self._follow)
        states = p.text("jointStateName", "joint_states")
        if states:
            self._states = context.publish(states, "sensor_msgs/JointState", 10)
            context.observe(p.number("controlRate", 0.0), self._publish, [self._states],
                            efforts=names)
        self.reset()

    def _servos(self) -> Tuple[List[str], Tuple[Vec3, ...]]:
        """The joints and axes of the servos, from the base outwards. Raises PluginError."""
        p = self.context.parameters
        places = ("first", "second", "third")
        names = [p.text(f"{place}ServoName") for place in places]
        while names and not names[-1]:
            names.pop()
        if not names or not all(names):
            raise PluginError("its servos must be named in order, from <firstServoName> on")
        return names, tuple(p.vector(f"{place}ServoAxis") for place, _ in zip(places, names))

    def reset(self) -> None:
        self._frame, self._turn = _LEVEL, IDENTITY_QUAT
        self._targets: Optional[Tuple[float, ...]] = None
        self._stop()
        self._follow()

    def _receive(self, message: Any) -> None:
        turn = message.quaternion
        wanted = (turn.x, turn.y, turn.z, turn.w)
        if wanted == (0.0,) * 4:
            self.context.warn("an orientation of four zeros is ignored")
            return
        self._frame, self._turn = message.header.frame_id, normalised(wanted)
        self._follow()

    def _follow(self) -> None:
        """Update the targets of the servos after a command or a change of tf."""
        frame = self._transforms.look_up(_BASE, self._frame)
        targets = None if frame is None else self._angles(multiply(frame.orientation, self._turn))
        if targets == self._targets:
            return
        self._targets = targets
        if targets is None:
            self._stop()
            return
        for joint, target in zip(self._joints, targets):
            joint.set_servo(self._servo_to(target))

    def _servo_to(self, target: float) -> JointServo:
        return replace(self._servo, target=target, gains=self._gains)

    def _stop(self) -> None:
        """Let the joints stand still, as without a transform."""
        for joint in self._joints:
            joint.set_servo(self._servo)

    def _angles(self, turn: Quat) -> Tuple[float, ...]:
        """The angles of the servos for an orientation in the base, rad."""
        if self._z_first:
            return rpy_from_quat(turn)[::-1][:len(self._joints)]
        # R = Rx(a) Ry(b) Rz(c), so its inverse has the angles -a, -b, -c of roll, pitch and yaw.
        a, b, c = (-angle for angle in rpy_from_quat(conjugate(turn)))
        return (b,) if self._is_single else (a, b, c)[:len(self._joints)]

    def _publish(self) -> None:
        self._states.publish(joint_state_message(
            self.context, self._joints, self.context.link("").name,
            self.context.efforts([joint.name for joint in self._joints])))


def _or_unlimited(limit: float) -> float:
    """A limit; 0, the default, is none: Gazebo sets the velocities of joints directly."""
    return limit if limit > 0.0 else math.inf
