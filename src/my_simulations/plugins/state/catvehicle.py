"""libcatvehiclegazebo.so: what the car of catvehicle reports of its motion.

Topics, frames and fields are those of catvehicle's CatSteering. It publishes at its rate, and not
with the messages of /gazebo/model_states.
"""
from __future__ import annotations

from ...geometry import Twist, conjugate, rotate
from ...geometry_messages import fill_twist
from ..base import Plugin
from .world_odometry import odometry_message


class CatVehicle(Plugin):
    """Publishes `vel`, `steering` and `odom`, and broadcasts odom to tf."""

    def load(self) -> None:
        context, p = self.context, self.context.parameters
        namespace = p.text("robotNamespace")
        context.use_namespace(namespace)
        self._scope = namespace.strip("/")
        self._steering = [context.joint(f"front_{side}_steering_joint")
                          for side in ("left", "right")]
        self._velocity = context.publish("vel", "geometry_msgs/Twist")
        self._angle = context.publish("steering", "geometry_msgs/Wrench")
        self._odom = context.publish("odom", "nav_msgs/Odometry")
        context.observe(p.number("updateRate", 100.0), self._publish,
                        [self._velocity, self._angle, self._odom], transforms=True)

    def _publish(self) -> None:
        context, pose, twist = self.context, self.context.pose, self.context.twist
        back = conjugate(pose.orientation)
        velocity = context.message("geometry_msgs/Twist")
        fill_twist(velocity, Twist(rotate(back, twist.linear), rotate(back, twist.angular)))
        self._velocity.publish(velocity)
        steering = context.message("geometry_msgs/Wrench")
        steering.torque.z = sum(joint.position for joint in self._steering) / 2.0   # rad
        self._angle.publish(steering)
        frame, base = f"{self._scope}/odom", f"{self._scope}/base_link"
        context.transform(frame, base, pose)
        self._odom.publish(odometry_message(context, frame, base, pose, twist, 0.0))
