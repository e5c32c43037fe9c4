"""librotors_gazebo_odometry_plugin.so: pose and velocity of a link, with noise and delay.

Parameters, defaults and topics are those of rotors_gazebo_plugins. Pose and velocity are those of
`<linkName>` in `<parentFrameId>`, a link of the model or the world; the velocity is in the axes of
the link. Where it differs: `<unknownDelay>` is added to stamps in seconds (original: also in
nanoseconds); noise depends on the seed of the world, not on `<randomEngineSeed>`;
`<covarianceImage>` is not supported.
"""
from __future__ import annotations

import math
from collections import deque
from typing import Deque, List, Optional, Tuple

from ...geometry import (
    Pose,
    Quat,
    Twist,
    Vec3,
    add,
    compose,
    conjugate,
    cross,
    inverse,
    multiply,
    normalised,
    rotate,
    subtract,
)
from ...geometry_messages import fill_pose, fill_quaternion, fill_vector
from ...sensing.noise import SampleGenerator
from ..base import Plugin
from ..context import Link, Publication
from ..frames import stamp_message
from ..standard_messages import diagonal_covariance, odometry_message, point_message

_WORLD = "world"
_QUANTITIES = ("Position", "Quaternion", "LinearVelocity", "AngularVelocity")

Motion = Tuple[Pose, Twist]
"""Pose of a link in the parent frame, and its twist in its own axes."""


class RotorsOdometry(Plugin):
    """Publishes five types of messages and a transform."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        self._link = context.link(p.text("linkName", "odometry_sensor_link"))
        self._frames = (p.text("parentFrameId", _WORLD), p.text("childFrameId", "odometry_sensor"))
        self._parent: Optional[Link] = None if self._frames[0] == _WORLD \
            else context.link(self._frames[0])
        self._normal = [p.vector(f"noiseNormal{name}") for name in _QUANTITIES]
        self._uniform = [p.vector(f"noiseUniform{name}") for name in _QUANTITIES]
        self._noisy = any(any(vector) for vector in (*self._normal, *self._uniform))
        self._draws = SampleGenerator(context.seed, f"{context.model}::{self._link.name}",
                                      self._frames[1])
        self._covariances = [
            diagonal_covariance([value ** 2 for vector in pair for value in vector])
            for pair in (self._normal[:2], self._normal[2:])]
        self._delay = max(0, p.integer("measurementDelay", 0))
        self._stamp_ns = round(p.number("unknownDelay", 0.0) * 1e9)
        if p.text("covarianceImage"):
            context.warn("<covarianceImage> is not supported; odometry is published everywhere")
        self._pose, self._posed, self._position, self._transform, self._odometry = (
            context.publish(p.text(f"{name}Topic", default), kind) for name, default, kind in (
                ("pose", "pose", "geometry_msgs/Pose"),
                ("poseWithCovariance", "pose_with_covariance",
                 "geometry_msgs/PoseWithCovarianceStamped"),
                ("position", "position", "geometry_msgs/PointStamped"),
                ("transform", "transform", "geometry_msgs/TransformStamped"),
                ("odometry", "odometry", "nav_msgs/Odometry")))
        topics: Tuple[Publication, ...] = (self._pose, self._posed, self._position,
                                           self._transform, self._odometry)
        self.reset()
        divisor = max(1, p.integer("measurementDivisor", 1))
        context.observe(1.0 / (divisor * context.step_size) if divisor > 1 else 0.0, self.update,
                        topics, transforms=True, remembers=self._delay > 0)

    def reset(self) -> None:
        """Measurements that are not published yet are lost."""
        self._queue: Deque[Tuple[int, int, Motion]] = deque()

    clock_set = reset

    def update(self) -> None:
        """Measure, and publish what was measured `<measurementDelay>` steps ago."""
        context = self.context
        self._queue.append((context.step + self._delay, context.now_ns, self._measured()))
        while self._queue and self._queue[0][0] <= context.step:
            _, ns, motion = self._queue.popleft()
            self._publish(self._with_noise(motion, ns), ns + self._stamp_ns)

    def _measured(self) -> Motion:
        pose, twist = self._link.pose, self._link.twist
        centre = Pose(add(pose.position, rotate(pose.orientation,
                                                self._link.inertial.pose.position)),
                      pose.orientation)
        linear, angular = twist.linear, twist.angular
        if self._parent is not None:
            at, motion = self._parent.pose, self._parent.twist
            arm = subtract(centre.position, at.position)
            linear = subtract(linear, add(motion.linear, cross(motion.angular, arm)))
            angular = subtract(angular, motion.angular)
            centre = compose(inverse(at), centre)
        back = conjugate(pose.orientation)
        return centre, Twist(rotate(back, linear), rotate(back, angular))

    def _with_noise(self, motion: Motion, ns: int) -> Motion:
        if not self._noisy:
            return motion
        pose, twist = motion
        draws = self._draws.at(ns)
        normal, uniform = draws.standard_normal(12), draws.uniform(-1.0, 1.0, 12)
        errors: List[Vec3] = []
        for number, (stddev, width) in enumerate(zip(self._normal, self._uniform)):
            x, y, z = (float(stddev[axis] * normal[3 * number + axis]
                             + width[axis] * uniform[3 * number + axis]) for axis in range(3))
            errors.append((x, y, z))
        turned = normalised(multiply(pose.orientation, small_rotation(errors[1])))
        return (Pose(add(pose.position, errors[0]), turned),
                Twist(add(twist.linear, errors[2]), add(twist.angular, errors[3])))

    def _publish(self, motion: Motion, ns: int) -> None:
        context, (pose, twist), (parent, child) = self.context, motion, self._frames
        if self._pose.wanted:
            message = context.message("geometry_msgs/Pose")
            fill_pose(message, pose)
            self._pose.publish(message)
        if self._posed.wanted:
            message = stamp_message(context, "geometry_msgs/PoseWithCovarianceStamped", parent, ns)
            fill_pose(message.pose.pose, pose)
            message.pose.covariance = list(self._covariances[0])
            self._posed.publish(message)
        if self._position.wanted:
            self._position.publish(point_message(context, parent, pose.position, ns))
        if self._transform.wanted:
            message = stamp_message(context, "geometry_msgs/TransformStamped", parent, ns)
            message.child_frame_id = child
            fill_vector(message.transform.translation, pose.position)
            fill_quaternion(message.transform.rotation, pose.orientation)
            self._transform.publish(message)
        if self._odometry.wanted:
            self._odometry.publish(odometry_message(context, self._frames, pose, twist,
                                                    self._covariances, ns))
        context.transform(parent, child, pose)


def small_rotation(angles: Vec3) -> Quat:
    """The quaternion of a small rotation about x, y and z, rad."""
    x, y, z = (angle / 2.0 for angle in angles)
    return x, y, z, math.sqrt(max(0.0, 1.0 - x * x - y * y - z * z))
