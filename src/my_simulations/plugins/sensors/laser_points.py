"""Lasers as points: libgazebo_ros_block_laser.so and the libgazebo_ros_velodyne ones.

Parameters, defaults, topics, frames and fields are those of gazebo_plugins and of
velodyne_gazebo_plugins. A laser of one row has points, too (original: the block laser divides by
zero).

libgazebo_ros_laser.so and libgazebo_ros_gpu_laser.so give sensor_msgs/LaserScan. Parameters,
defaults, topic and frame are those of gazebo_plugins; of the ranges, what is at the maximum or
beyond is +inf, at the minimum or nearer -inf (Gazebo 11), and noise leaves both alone.
"""
from __future__ import annotations

from typing import Any, Optional

from ...description.sensor import Noise as NoiseSpec
from ...sensing.noise import GAUSSIAN, Noise
from ..frames import add_tf_prefix, resolve_frame, stamp_message
from .image_messages import FLOAT32, UINT16, XYZ, cloud_message, header
from .rays import RayPlugin

_STEP = 22       # bytes of a Velodyne's point, as PointXYZIRT of its drivers
_FIELDS = (*XYZ, ("intensity", 12, FLOAT32), ("ring", 16, UINT16), ("time", 18, FLOAT32))
_FURTHEST = float("inf")


class Points(RayPlugin):
    """Casts a fan of rays at the sensor's rate while there are subscribers."""

    usual_topic = "/world"
    message_type = ""

    def load(self) -> None:
        context, p = self.enter_namespace()
        self.read_ray_element()
        self._range_noise = self.add_noise(self._ray.noise, "range")
        self._noise = Noise(NoiseSpec(GAUSSIAN, stddev=p.number("gaussianNoise", 0.0)),
                            context.seed, f"{context.model}::{context.sensor_link}::points")
        self._frame = self._resolve_frame(p.text("frameName", "/world"))
        self._topic = context.publish(p.text("topicName") or self.usual_topic, self.message_type)
        self._directions: Optional[Any] = None
        self.follow(self._sensor.update_rate)

    def _resolve_frame(self, frame: str) -> str:
        return add_tf_prefix(self.context, frame)

    def _publish(self, returns: Any, ns: int) -> None:
        import numpy as np

        if self._directions is None:
            from ...sensing.rays.fan import fan_directions

            fan = self._fan
            self._directions = fan_directions(fan.samples, fan.min_angle, fan.max_angle, fan.rows,
                                              fan.min_elevation, fan.max_elevation)
        ranges = self._range_noise.apply(np.asarray(returns.ranges), ns)
        head = header(self.context, ns, self._frame)
        self._topic.publish_later(
            lambda: self._message(head, ranges, np.asarray(returns.retro), ns))

    def _message(self, head: Any, ranges: Any, retro: Any, ns: int) -> Any:
        raise NotImplementedError


class BlockLaser(Points):
    """sensor_msgs/PointCloud of all rays, between the sensor's ranges.

    A ray that meets nothing ends at the maximum range, without noise; one that meets something too
    near ends at the minimum range. So it is in Gazebo, whose rays begin and end there: the infinite
    values that gazebo_plugins provides for never come.
    """

    message_type = "sensor_msgs/PointCloud"

    def _message(self, head: Any, ranges: Any, retro: Any, ns: int) -> Any:
        import numpy as np

        assert self._directions is not None
        clipped = np.clip(ranges, self._fan.near, self._fan.far)
        ends = clipped[:, None] * self._directions
        places = np.where((ranges >= self._fan.far)[:, None], ends,
                          self._noise.apply(ends, ns, 0.0))
        context = self.context
        message, channel = (context.message("sensor_msgs/PointCloud"),
                            context.message("sensor_msgs/ChannelFloat32"))
        message.header = head
        message.points = [_point(context, *place) for place in places.tolist()]
        channel.values = retro.tolist()
        message.channels = [channel]
        return message


def _point(context: Any, x: float, y: float, z: float) -> Any:
    made = context.message("geometry_msgs/Point32")
    made.x, made.y, made.z = x, y, z
    return made


class Velodyne(Points):
    """sensor_msgs/PointCloud2 of what is met: x, y, z, intensity, ring, time; column by column.

    All rays are of one moment, so `time` is 0. With `<organize_cloud>` a row of the cloud is a
    column of the scan, and a point that is left out is NaN and keeps its ring; faint ones, too
    (original: `<min_intensity>` counts in clouds without order alone).
    """

    usual_topic = "/points"
    message_type = "sensor_msgs/PointCloud2"

    def load(self) -> None:
        p = self.context.parameters
        super().load()
        self._near = max(p.number("min_range", 0.0), self._fan.near)
        self._far = min(p.number("max_range", _FURTHEST), self._fan.far)
        self._faintest = p.number("min_intensity", -_FURTHEST)
        self._organized = p.flag("organize_cloud", False)
        self._rings: Optional[Any] = None

    def _resolve_frame(self, frame: str) -> str:
        """A namespace other than `/` comes before `tf_prefix` (velodyne_gazebo_plugins)."""
        namespace = self.context.parameters.text("robotNamespace").strip("/")
        return resolve_frame(namespace, frame) if namespace else super()._resolve_frame(frame)

    def _message(self, head: Any, ranges: Any, retro: Any, ns: int) -> Any:
        import numpy as np

        fan = self._fan
        assert self._directions is not None
        if self._rings is None:
            self._rings = np.repeat(np.arange(fan.rows, dtype=np.uint16), fan.samples)
            order = np.arange(fan.rows * fan.samples).reshape(fan.rows, fan.samples).T.ravel()
            self._order = order
        away = self._noise.apply(ranges, ns, 0.0)
        kept = self._within(ranges) & self._within(away) & (retro >= self._faintest)
        order = self._order if self._organized else self._order[kept[self._order]]
        points: np.ndarray = np.zeros(len(order), np.dtype({
            "names": ["place", "intensity", "ring", "time"],
            "formats": ["(3,)<f4", "<f4", "<u2", "<f4"], "offsets": [0, 12, 16, 18],
            "itemsize": _STEP}))
        points["place"] = np.where(kept, away, np.nan)[order, None] * self._directions[order]
        points["intensity"] = np.where(kept, retro, np.nan)[order]
        points["ring"] = self._rings[order]
        shape = (fan.samples, fan.rows) if self._organized else (1, len(order))
        return cloud_message(self.context, head, points, shape, _STEP, _FIELDS,
                             not self._organized)

    def _within(self, ranges: Any) -> Any:
        return (ranges > self._near) & (ranges < self._far)


class Laser(RayPlugin):
    """Publishes scans while there are subscribers."""

    def load(self) -> None:
        context, p = self.enter_namespace(empty_means_model=True)
        self.read_ray_element()
        self._frame = add_tf_prefix(context, p.text("frameName", "/world"))
        self._noise = self.add_noise(self._ray.noise, "range")
        self._topic = context.publish(p.text("topicName", "/world"), "sensor_msgs/LaserScan")
        self.follow(self._sensor.update_rate)

    def _publish(self, returns: Any, ns: int) -> None:
        import numpy as np

        ray, fan, context = self._ray, self._fan, self.context
        true = np.asarray(returns.ranges)
        noisy = np.clip(self._noise.apply(true, ns), fan.near, fan.far)
        ranges = np.where(true >= fan.far, np.inf, np.where(true <= fan.near, -np.inf, noisy))
        message = stamp_message(context, "sensor_msgs/LaserScan", self._frame, ns)
        message.angle_min, message.angle_max = ray.horizontal.min_angle, ray.horizontal.max_angle
        message.angle_increment = ((message.angle_max - message.angle_min)
                                   / max(1, fan.samples - 1))
        message.time_increment = message.scan_time = 0.0
        message.range_min, message.range_max = ray.min_range, ray.max_range
        message.ranges = ranges.tolist()
        message.intensities = np.asarray(returns.retro).tolist()
        self._topic.publish(message)
