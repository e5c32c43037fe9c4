"""libhector_gazebo_quadrotor_aerodynamics.so: drag of a quadrotor in the wind.

Parameters, topics and law are those of hector_quadrotor_gazebo_plugins and hector_quadrotor_model:
with the velocity v of the body relative to the wind and its angular velocity w, both in its axes,
the drag is (C_wxy v_x, C_wxy v_y, C_wz v_z) |v| and the moment (C_mxy w_x, C_mxy w_y, C_mz w_z)
|w|, against the motion. Where it differs: the axes are those of the body at any roll angle (the
original turns them the wrong way about x); the wind of the world counts until one comes on
`<windTopicName>`.
"""
from __future__ import annotations

from dataclasses import replace
from typing import Any, List, Optional

from ...engine.wrench_laws import BodyDrag
from ...geometry import Vec3
from ..base import Plugin
from ..context import Context, PluginError
from ..finite_messages import finite_only
from ..frames import stamp_message
from ..parameters import namespace_or
from .body_wrench import fill_wrench

MOST_VELOCITY = 100.0   # m/s and rad/s: faster motion counts as this (hector_quadrotor_model)


class QuadrotorAerodynamics(Plugin):
    """Acts on the first link of the model."""

    def load(self) -> None:
        context, p = self.context, self.context.parameters
        context.use_namespace(namespace_or(p, ""))
        self._link = context.link("")
        across, along, turn_across, turn_along = model_parameters(
            context, p.text("paramNamespace", "quadrotor_aerodynamics"),
            ["C_wxy", "C_wz", "C_mxy", "C_mz"])
        self._drag = BodyDrag((across, across, along), (turn_across, turn_across, turn_along),
                              context.wind, MOST_VELOCITY)
        context.set_wrench_law(self._link.name, self._drag)
        self._wind: Optional[Vec3] = None
        topic = p.text("windTopicName", "/wind")
        if topic:
            context.subscribe(topic, "geometry_msgs/Vector3",
                              finite_only(context, topic, self._receive))
        self._frame = p.text("frameId", self._link.name)
        self._wrenches = context.publish(p.text("wrenchTopic", "aerodynamics/wrench"),
                                         "geometry_msgs/WrenchStamped", 10)
        context.observe(0.0, self._publish, [self._wrenches])
        context.on_world_change(self.update)

    def reset(self) -> None:
        """Drag ended with the reset. The wind is that of the world."""
        self._wind = None
        self._drag = replace(self._drag, wind=self.context.wind)
        self.context.set_wrench_law(self._link.name, self._drag)

    def _receive(self, message: Any) -> None:
        self._wind = (message.x, message.y, message.z)
        self.update()

    def update(self) -> None:
        wind = self.context.wind if self._wind is None else self._wind
        if wind != self._drag.wind:
            self._drag = replace(self._drag, wind=wind)
            self.context.set_wrench_law(self._link.name, self._drag)

    def _publish(self) -> None:
        message = stamp_message(self.context, "geometry_msgs/WrenchStamped", self._frame)
        fill_wrench(message.wrench, self._drag.in_body_axes(self._link.pose, self._link.twist))
        self._wrenches.publish(message)


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
