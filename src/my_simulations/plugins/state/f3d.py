"""libgazebo_ros_f3d.so: the total wrench on a link, as geometry_msgs/WrenchStamped.

Parameters, topic and header are those of gazebo_plugins: N and N m in world axes. It is mass times
acceleration, and the change of the angular momentum about the centre of mass, over the time between
two messages: all forces, including gravity and contacts (the original publishes the forces that
its engine has accumulated).
"""
from __future__ import annotations

from typing import Optional, Tuple

from ...geometry import Quat, Vec3, conjugate, multiply, rotate, scale, subtract
from ...sensing.sensor_models import velocity_at
from ..base import Plugin
from ..frames import add_tf_prefix
from ..standard_messages import wrench_message


class F3d(Plugin):
    """Publishes after each step while there are subscribers."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        body, topic = map(self.required_text, ("bodyName", "topicName"))
        self._link = context.link(body)
        self._frame = add_tf_prefix(context, p.text("frameName", "world"))
        self._topic = context.publish(topic, "geometry_msgs/WrenchStamped")
        self.reset()
        context.observe(0.0, self.update, [self._topic], resume=self._resume)

    def reset(self) -> None:
        """Forget the momenta of the last step."""
        self._before: Optional[Tuple[int, Vec3, Vec3]] = None

    clock_set = reset

    def _resume(self) -> None:
        self.reset()
        self.update()

    def update(self) -> None:
        """Publish the change of the momenta per second since the last step."""
        linear, angular = self._momenta()
        before, now = self._before, self.context.now_ns
        self._before = (now, linear, angular)
        if before is None or before[0] == now:
            return
        per_second = 1e9 / (now - before[0])
        self._topic.publish(wrench_message(self.context, self._frame, (
            scale(subtract(linear, before[1]), per_second),
            scale(subtract(angular, before[2]), per_second))))

    def _momenta(self) -> Tuple[Vec3, Vec3]:
        """Linear, kg m/s, and angular about the centre of mass, kg m^2/s; world axes."""
        link, inertial = self._link, self._link.inertial
        velocity = velocity_at(link.pose, link.twist, inertial.pose)
        turn: Quat = multiply(link.pose.orientation, inertial.pose.orientation)
        x, y, z = rotate(conjugate(turn), link.twist.angular)
        i = inertial
        momentum = (i.ixx * x + i.ixy * y + i.ixz * z, i.ixy * x + i.iyy * y + i.iyz * z,
                    i.ixz * x + i.iyz * y + i.izz * z)
        return scale(velocity, inertial.mass), rotate(turn, momentum)
