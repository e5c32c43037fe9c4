"""libgazebo_ros_ray_sensor.so: rays as a scan, as points or as a range, by `<outputType>`.

Parameters, defaults and messages are those of gazebo_ros_ray_sensor for ROS 1. Where it differs:
rays that meet nothing are left out of PointCloud2 (original: their points are infinite), and points
are row by row.
"""
from __future__ import annotations

from typing import Any, Dict, Type

from ..base import Plugin
from ..context import PluginError
from ..standard_messages import INFRARED, ULTRASOUND, range_message
from .image_messages import FLOAT32, XYZ, cloud_message
from .laser_points import BlockLaser, Laser, Points
from .rays import RayPlugin

_STEP = 16                      # bytes of a point
_FIELDS = (*XYZ, ("intensity", 12, FLOAT32))


class PointCloudOutput(Points):
    """sensor_msgs/PointCloud2 of what is met: x, y, z, intensity, at least `<minIntensity>`."""

    message_type = "sensor_msgs/PointCloud2"

    def _resolve_frame(self, frame: str) -> str:
        return frame.lstrip("/")

    def _message(self, head: Any, ranges: Any, retro: Any, ns: int) -> Any:
        import numpy as np

        assert self._directions is not None
        context, fan = self.context, self._fan
        met = (ranges > fan.near) & (ranges < fan.far)
        points = np.empty((int(met.sum()), 4), np.float32)
        points[:, :3] = ranges[met, None] * self._directions[met]
        points[:, 3] = np.maximum(retro[met], context.parameters.number("minIntensity", 0.0))
        return cloud_message(context, head, points, (1, len(points)), _STEP, _FIELDS, True)


class RangeOutput(RayPlugin):
    """sensor_msgs/Range of the nearest of all rays."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        self.read_ray_element()
        self._frame = p.text("frameName", "/world").lstrip("/")
        self._kind = INFRARED if p.text("radiationType") in ("infrared", "infared") else ULTRASOUND
        self._topic = context.publish(p.text("topicName", "/world"), "sensor_msgs/Range")
        self.follow(self._sensor.update_rate)

    def _publish(self, returns: Any, ns: int) -> None:
        ray = self._ray
        view = max(one.max_angle - one.min_angle for one in (ray.horizontal, ray.vertical))
        self._topic.publish(range_message(self.context, self._frame, ns, self._kind, view,
                                          (ray.min_range, ray.max_range),
                                          float(min(returns.ranges))))


_KINDS: Dict[str, Type[Plugin]] = {
    "sensor_msgs/LaserScan": Laser, "sensor_msgs/PointCloud": BlockLaser,
    "sensor_msgs/PointCloud2": PointCloudOutput, "sensor_msgs/Range": RangeOutput}


class RaySensor(Plugin):
    def load(self) -> None:
        """Choose by `<outputType>`; PointCloud2 by default."""
        p = self.context.parameters
        if p.text("topicName", "/world") == "":
            raise PluginError("its <topicName> is empty")
        self._one = p.choice("outputType", _KINDS, PointCloudOutput)(self.context)
        self._one.load()

    def reset(self) -> None:
        self._one.reset()

    def clock_set(self) -> None:
        self._one.clock_set()
