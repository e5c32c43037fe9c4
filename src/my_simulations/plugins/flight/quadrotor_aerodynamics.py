"""libhector_gazebo_quadrotor_aerodynamics.so: drag of a quadrotor in the wind.

Parameters, topics and law are those of hector_quadrotor_gazebo_plugins and hector_quadrotor_model:
with the velocity v of the body relative to the wind and its angular velocity w, both in its axes,
the drag is (C_wxy v_x, C_wxy v_y, C_wz v_z) |v| and the moment (C_mxy w_x, C_mxy w_y, C_mz w_z)
|w|, against the motion. Where it differs: the axes are those of the body at any roll angle (the
original turns them the wrong way about x); the wind of the world counts until one comes on
`<windTopicName>`.
"""
from __future__ import annotations

from typing import Any, List, Optional

from ...geometry import Vec3, conjugate, norm, rotate, subtract
from ..base import Plugin
from ..context import Context, PluginError
from ..finite_messages import finite_only
from ..frames import stamped
from ..parameters import namespace_or
from .body_wrench import clamped_vector, fill_wrench, push_at_origin

MOST_VELOCITY = 100.0   # m/s and rad/s: faster motion counts as this (hector_quadrotor_model)


class QuadrotorAerodynamics(Plugin):
    """Acts on the first link of the model."""

    def load(self) -> None:
        """Read parameters."""
        context, p = self.context, self.context.parameters
        context.use_namespace(namespace_or(p, ""))
        self._link = context.link("")
        self._linear_x_y, self._linear_z, self._angular_x_y, self._angular_z = model_parameters(
            context, p.text("paramNamespace", "quadrotor_aerodynamics"),
            ["C_wxy", "C_wz", "C_mxy", "C_mz"])
        self._wind: Optional[Vec3] = None
        topic = p.text("windTopicName", "/wind")
        if topic:
            context.subscribe(topic, "geometry_msgs/Vector3",
                              finite_only(context, topic, self._receive))
        self._frame = p.text("frameId", self._link.name)
        self._wrenches = context.publish(p.text("wrenchTopic", "aerodynamics/wrench"),
                                         "geometry_msgs/WrenchStamped", 10)
        context.every(0.0, self.update)

    def reset(self) -> None:
        """The wind is that of the world."""
        self._wind = None

    def _receive(self, message: Any) -> None:
        self._wind = (message.x, message.y, message.z)

    def update(self) -> None:
        """Before each step."""
        context, twist = self.context, self._link.twist
        wind = context.wind if self._wind is None else self._wind
        back = conjugate(self._link.pose.orientation)
        velocity = rotate(back, clamped_vector(subtract(twist.linear, wind), MOST_VELOCITY))
        spin = rotate(back, clamped_vector(twist.angular, MOST_VELOCITY))
        wrench = (_drag(velocity, self._linear_x_y, self._linear_z),
                  _drag(spin, self._angular_x_y, self._angular_z))
        push_at_origin(context, self._link, wrench)
        if self._wrenches.wanted:
            message = stamped(context, "geometry_msgs/WrenchStamped", self._frame)
            fill_wrench(message.wrench, wrench)
            self._wrenches.publish(message)


def _drag(velocity: Vec3, across: float, along: float) -> Vec3:
    speed = norm(velocity)
    return (-across * speed * velocity[0], -across * speed * velocity[1],
            -along * speed * velocity[2])


def model_parameters(context: Context, namespace: str, names: List[str]) -> List[float]:
    """Numbers of the parameter server below a namespace.

    Raises PluginError if one is missing or not a number.
    """
    found = []
    for name in names:
        value = context.parameter(f"{namespace}/{name}", None)
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise PluginError(f"parameter {namespace}/{name} must be a number, it is {value!r}: is"
                              " the parameter file of the model loaded?")
        found.append(float(value))
    return found
