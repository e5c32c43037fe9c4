"""libgazebo_ros_p3d.so: ground truth of a link as odometry.

Parameters, defaults and topic are those of gazebo_plugins. In another frame than the world, pose
and twist are given in that frame's axes (original: they are rotated by the wrong sign).
"""
from __future__ import annotations

from typing import Optional

from ...geometry import Pose, Twist, add, compose, conjugate, inverse, multiply, rotate, subtract
from ..base import Plugin
from ..context import Link, PluginError
from ..frames import add_tf_prefix
from ..noise import WhiteNoise
from ..standard_messages import diagonal_covariance, odometry_message

_WORLD = ("", "world", "/world", "map", "/map")


class P3d(Plugin):
    """Publishes nav_msgs/Odometry of a link while there are subscribers."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        if "topicName" not in p:   # an empty one is legal: nothing is published
            raise PluginError("it has no <topicName>")
        name = p.text("bodyName")
        self._link = context.link(name)
        frame = p.text("frameName", "world")
        self._frame: Optional[Link] = None if frame in _WORLD else context.link(frame)
        self._offset = Pose(p.vector("xyzOffset", p.vector("xyzOffsets")),
                            p.turn("rpyOffset", p.turn("rpyOffsets")))
        self._stddev = p.number("gaussianNoise", 0.0)
        self._noise = WhiteNoise(context.seed, f"{context.model}::{name}::p3d", self._stddev)
        # The original puts the prefix before the first alone.
        self._frames = (add_tf_prefix(context, frame), name)
        self._topic = context.publish(p.text("topicName"), "nav_msgs/Odometry")
        context.observe(p.number("updateRate", 0.0), self.update, [self._topic])

    def update(self) -> None:
        pose, twist = self._link.pose, self._link.twist
        if self._frame is not None:
            at, motion = self._frame.pose, self._frame.twist
            back = conjugate(at.orientation)
            pose = compose(inverse(at), pose)
            twist = Twist(rotate(back, subtract(twist.linear, motion.linear)),
                          rotate(back, subtract(twist.angular, motion.angular)))
        x, y, z, roll, pitch, yaw = self._noise.draw(6, self.context.now_ns)
        covariance = diagonal_covariance([self._stddev ** 2] * 6)
        self._topic.publish(odometry_message(
            self.context, self._frames,
            Pose(add(pose.position, self._offset.position),
                 multiply(self._offset.orientation, pose.orientation)),
            Twist(add(twist.linear, (x, y, z)), add(twist.angular, (roll, pitch, yaw))),
            (covariance, covariance)))
