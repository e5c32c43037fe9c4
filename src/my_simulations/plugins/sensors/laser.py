"""libgazebo_ros_laser.so and libgazebo_ros_gpu_laser.so: sensor_msgs/LaserScan.

Parameters, defaults, topic and frame are those of gazebo_plugins; of the ranges, what is at the
maximum or beyond is +inf, at the minimum or nearer -inf (Gazebo 11), and noise leaves both alone.
"""
from __future__ import annotations

from typing import Any

from ..frames import prefixed, stamped
from ..parameters import namespace_or
from .rays import RayPlugin, SampledNoise


class Laser(RayPlugin):
    """Publishes scans while there are subscribers."""

    def load(self) -> None:
        context, p = self.context, self.context.parameters
        self.read_ray_element()
        context.use_namespace(namespace_or(
            p, context.model if "robotNamespace" in p else ""))
        self._frame = prefixed(context, p.text("frameName", "/world"))
        self._noise = SampledNoise(context, self._ray.noise, "range")
        self._topic = context.publish(p.text("topicName", "/world"), "sensor_msgs/LaserScan")
        assert context.sensor is not None
        self.follow(context.sensor.update_rate)

    def reset(self) -> None:
        self._noise.reset(self.context.now_ns)

    clock_set = reset

    def _publish(self, returns: Any, ns: int) -> None:
        import numpy as np

        ray, fan, context = self._ray, self._fan, self.context
        true = np.asarray(returns.ranges)
        noisy = np.clip(self._noise.apply(true, ns), fan.near, fan.far)
        ranges = np.where(true >= fan.far, np.inf, np.where(true <= fan.near, -np.inf, noisy))
        message = stamped(context, "sensor_msgs/LaserScan", self._frame, ns)
        message.angle_min, message.angle_max = ray.horizontal.min_angle, ray.horizontal.max_angle
        message.angle_increment = ((message.angle_max - message.angle_min)
                                   / max(1, fan.samples - 1))
        message.time_increment = message.scan_time = 0.0
        message.range_min, message.range_max = ray.min_range, ray.max_range
        message.ranges = ranges.tolist()
        message.intensities = np.asarray(returns.retro).tolist()
        self._topic.publish(message)
