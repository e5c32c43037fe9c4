"""libgazebo_ros_range.so: sensor_msgs/Range, the nearest of all rays.

Parameters, defaults, topic and frame are those of gazebo_plugins.
"""
from __future__ import annotations

from typing import Any

from ..frames import add_tf_prefix
from ..noise import WhiteNoise
from ..parameters import lowest_rate
from ..standard_messages import INFRARED, ULTRASOUND, range_message
from .rays import RayPlugin


class Range(RayPlugin):
    """Publishes while there are subscribers; without a hit, the maximum range."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        self.read_ray_element()
        self._frame = add_tf_prefix(context, p.text("frameName", "/world"))
        self._kind = ULTRASOUND if p.text("radiation", "ultrasound") == "ultrasound" else INFRARED
        self._view = p.number("fov", 0.05)
        self._noise = WhiteNoise(context.seed, f"{context.model}::{context.sensor_link}::"
                                 f"{self._sensor.name}::range",
                                 p.number("gaussianNoise", 0.0))
        self._topic = context.publish(p.text("topicName", "/range"), "sensor_msgs/Range")
        self.follow(lowest_rate(p.number("updateRate", 0.0), self._sensor.update_rate))

    def _publish(self, returns: Any, ns: int) -> None:
        most = self._ray.max_range
        nearest = min(float(min(returns.ranges)), most)
        if nearest < most:
            nearest = min(most, nearest + self._noise.draw(1, ns)[0])
        self._topic.publish(range_message(self.context, self._frame, ns, self._kind, self._view,
                                          (self._ray.min_range, most), nearest))
