"""libgazebo_world_odometry.so and librobotnik_gazebo_ground_truth_odom.so: truth as odometry.

Parameters, defaults and topics are those of pal_gazebo_plugins (melodic) and of
robotnik_gazebo_plugins. Where they differ: noise of the first adds up at the rate of the plugin,
whether or not there are subscribers, and is drawn from the seed of the world; its offsets, which
dynamic_reconfigure sets there, are 0. The second gives a velocity in the axes that the link has now
(original: those of the message before), and rotates in the frame of `<worldBodyName>` the right
way.

libcatvehiclegazebo.so: what the car of catvehicle reports of its motion.

Topics, frames and fields are those of catvehicle's CatSteering. It publishes at its rate, and not
with the messages of /gazebo/model_states.
"""
from __future__ import annotations

from typing import Optional

from ...geometry import (
    Pose,
    Twist,
    add,
    compose,
    conjugate,
    inverse,
    multiply,
    normalised,
    quat_from_rpy,
    rotate,
    rpy_from_quat,
    subtract,
)
from ...geometry_messages import fill_twist
from ..base import Plugin
from ..context import Link, PluginError
from ..frames import add_tf_prefix
from ..noise import WhiteNoise
from ..standard_messages import diagonal_covariance, odometry_message

_WORLD = ("", "world", "/world", "map", "/map")
_EXACT = (diagonal_covariance((0.0,) * 6),) * 2   # of pose and twist
_ROBOTNIK_COVARIANCES = (diagonal_covariance((0.1,) * 6),) * 2


class PalWorldOdometry(Plugin):
    """Publishes nav_msgs/Odometry of `<bodyName>` in the world."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        self._frame = p.text("frameName", "world")
        self._link = context.link(p.text("bodyName", self._frame))
        self._noise = WhiteNoise(context.seed, f"{context.model}::{self._link.name}::odometry",
                                 p.number("gaussianNoise", 0.0))
        self._topic = context.publish(p.text("topicName", "ft_data"), "nav_msgs/Odometry", 100)
        self.reset()
        context.observe(p.number("updateRate", 1000.0), self.update, [self._topic],
                        remembers=p.number("gaussianNoise", 0.0) > 0.0)

    def reset(self) -> None:
        """There is no error yet."""
        self._error = (0.0, 0.0, 0.0)

    def update(self) -> None:
        context, pose, twist = self.context, self._link.pose, self._link.twist
        x, y, yaw = self._noise.draw(3, context.now_ns)
        self._error = add(self._error, (x, y, yaw))
        roll, pitch, heading = rpy_from_quat(pose.orientation)
        here = Pose(add(pose.position, (self._error[0], self._error[1], 0.0)),
                    quat_from_rpy(roll, pitch, heading + self._error[2]))
        spin = rotate(conjugate(pose.orientation), twist.angular)
        self._topic.publish(odometry_message(context, (self._frame, self._link.name), here,
                                             Twist(twist.linear, spin), _EXACT))


class RobotnikGroundTruthOdometry(Plugin):
    """Publishes nav_msgs/Odometry of `<bodyName>`, and with `<broadcastTF>` its transform."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        for name in ("bodyName", "topicName"):
            if name not in p:
                raise PluginError(f"it has no <{name}>")
        self._link = context.link(p.text("bodyName"))
        world = p.text("worldBodyName", "world")
        self._parent: Optional[Link] = None if world in _WORLD else context.link(world)
        self._frames = (add_tf_prefix(context, p.text("worldFrameName", world)),
                        p.text("frameName", self._link.name))
        self._offset = Pose(p.vector("xyzOffset"), p.turn("rpyOffset"))
        self._noise = WhiteNoise(context.seed, f"{context.model}::{self._link.name}::truth",
                                 p.number("gaussianNoise", 0.0))
        self._broadcasts = p.flag("broadcastTF", False)
        topic = p.text("topicName")
        self._topic = context.publish(topic, "nav_msgs/Odometry")
        if topic:
            context.observe(p.number("updateRate", 0.0), self.update, [self._topic],
                            transforms=self._broadcasts)

    def update(self) -> None:
        context, pose, twist = self.context, self._link.pose, self._link.twist
        back = conjugate(pose.orientation)
        linear, angular = twist.linear, twist.angular
        if self._parent is not None:
            motion = self._parent.twist
            linear, angular = (subtract(linear, motion.linear), subtract(angular, motion.angular))
            pose = compose(inverse(self._parent.pose), pose)
        pose = Pose(add(pose.position, self._offset.position),
                    normalised(multiply(self._offset.orientation, pose.orientation)))
        noise = self._noise.draw(6, context.now_ns)
        moving = Twist(add(rotate(back, linear), (noise[0], noise[1], noise[2])),
                       add(rotate(back, angular), (noise[3], noise[4], noise[5])))
        if self._topic.wanted:
            self._topic.publish(odometry_message(context, self._frames, pose, moving,
                                                 _ROBOTNIK_COVARIANCES))
        if self._broadcasts:
            context.transform(*self._frames, pose)


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
        frames = (f"{self._scope}/odom", f"{self._scope}/base_link")
        context.transform(*frames, pose)
        self._odom.publish(odometry_message(context, frames, pose, twist, _EXACT))
