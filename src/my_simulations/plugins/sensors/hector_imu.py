"""libhector_gazebo_ros_imu.so: sensor_msgs/Imu of a link, with biases that drift.

Parameters, defaults and topics are those of hector_gazebo_plugins; `<rpyOffset>` rotates the
sensor on its link. dynamic_reconfigure and services of hector's own types are not supported.
"""
from __future__ import annotations

import math
from typing import Any, Iterable

from ...geometry import IDENTITY_QUAT, Pose, Quat, Vec3, multiply, normalised, rotate
from ..imu_meter import ImuMeter
from ..standard_messages import diagonal_covariance, imu_message
from .hector_errors import SensorErrors, rate_of
from .imu import Imu


class HectorImu(Imu):
    """On the link `<bodyName>`, or the model's own."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        link = context.link(p.text("bodyName"))
        self._meter = ImuMeter(context, link, Pose(orientation=p.turn("rpyOffset")))
        self._frame = (p.text("frameId") or link.name).lstrip("/")
        topic = p.text("topicName") or "imu"
        self._accel, self._rate = SensorErrors(context, "accel"), SensorErrors(context, "rate")
        self._yaw = SensorErrors(context, "yaw", 1)
        self._noises = [self._accel, self._rate, self._yaw]
        both = p.number("gaussianNoise", 0.0)
        if both:
            self._accel.noise, self._rate.noise = [both] * 3, [both] * 3
        self._topic = context.publish(topic, "sensor_msgs/Imu", 10)
        self._bias = context.publish(p.text("biasTopicName") or f"{topic}/bias",
                                     "sensor_msgs/Imu", 10)
        context.serve(p.text("serviceName") or f"{topic}/calibrate", "std_srvs/Empty",
                      lambda request, response: self._rate.reset(context.now_ns, (0.0,) * 3))
        context.observe(rate_of(p), self.update, [self._topic, self._bias],
                        resume=self._meter.restart)

    def update(self) -> None:
        """Measure, and publish on the topics that have a subscriber."""
        ns, sample = self.context.now_ns, self._meter.measure()
        accel = self._accel.apply(sample.linear_acceleration, ns)
        rate = self._rate.apply(sample.angular_velocity, ns)
        (yaw,) = self._yaw.apply((0.0,), ns)
        if self._topic.wanted:
            self._topic.publish(self._message(self._attitude(sample.orientation), rate, accel))
        if self._bias.wanted:
            self._bias.publish(self._message(IDENTITY_QUAT, self._rate.bias, self._accel.bias))

    def _attitude(self, orientation: Quat) -> Quat:
        """What a filter that trusts the biased accelerometer and compass would say."""
        gravity = math.sqrt(sum(part * part for part in self.context.gravity))
        yaw = self._yaw.bias[0]
        around: Quat = (0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2))
        tilt: Quat = (0.0, 0.0, 0.0, 1.0)
        if gravity > 0.0:
            bias: Vec3 = tuple(self._accel.bias)  # type: ignore[assignment]
            x, y, _ = rotate(orientation, bias)
            tilt = (0.5 * y / gravity, -0.5 * x / gravity, 0.0, 1.0)
        return multiply(normalised(multiply(around, tilt)), orientation)

    def _message(self, orientation: Quat, rate: Iterable[float], accel: Iterable[float]) -> Any:
        message = imu_message(self.context, self._frame, orientation, rate, accel)
        gravity = sum(part * part for part in self.context.gravity)
        tilt = [noise ** 2 / gravity if gravity > 0.0 else -1.0 for noise in self._accel.noise[:2]]
        message.orientation_covariance = diagonal_covariance([*tilt, self._yaw.noise[0] ** 2])
        message.angular_velocity_covariance, message.linear_acceleration_covariance = (
            diagonal_covariance([n ** 2 for n in one.noise]) for one in (self._rate, self._accel))
        return message
