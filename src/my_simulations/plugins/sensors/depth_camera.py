"""libgazebo_ros_depth_camera.so and libgazebo_ros_openni_kinect.so: colours, depth, points.

Parameters, defaults, topics and frames are those of gazebo_plugins; `<frameName>` must be an
optical frame (x right, y down, z forward). Units and what stands for no depth are those of REP 118.
Both publish `depth/camera_info` and clouds of as many rows as the picture has (the original of the
first publishes neither), and colours of points are those of the picture for a reader like PCL.
"""
from __future__ import annotations

from typing import Any, List, Optional

from ...sensing.api import DEPTH, RGB
from ..base import Plugin
from ..context import Context, Publication
from .camera_parameters import CameraTopics, ImagerRate, topics_of
from .image_messages import (
    POINT_STEP,
    XYZ_RGB,
    DepthGeometry,
    LazyValue,
    cloud_message,
    header,
    make_image,
)
from .picture_stream import PictureStream, camera_sensor

_FAR = float("inf")
_MILLIMETRES = 1000.0
_MOST = 65.535  # m in 16 bits


class DepthStream:
    """Topics of a depth picture: the image, its CameraInfo, the cloud.

    Args:
        context: of the plugin.
        lens: the stream of the same camera's colours.
        names: of image, info and cloud, as published.
        near, far: m, what counts as seen.
        wide: 32-bit floats in metres; else 16 bits in millimetres.
        cloud: near and far of the points, where these are others.
    """

    def __init__(self, context: Context, lens: PictureStream, names: "tuple[str, str, str]",
                 near: float, far: float, wide: bool,
                 cloud: "Optional[tuple[float, float]]" = None) -> None:
        self._context, self._lens = context, lens
        self._span, self._wide = (near, far), wide
        self._cloud_span = cloud or self._span
        self._frame = lens.topics.frame
        self._image = context.publish(names[0], "sensor_msgs/Image")
        self._info = context.publish(names[1], "sensor_msgs/CameraInfo")
        self._points = context.publish(names[2], "sensor_msgs/PointCloud2") if names[2] else None
        self._geometry: Optional[DepthGeometry] = None

    @property
    def wanted(self) -> bool:
        """Whether the depth image or the point cloud has a subscriber."""
        return self._image.wanted or self.cloud_wanted

    @property
    def publications(self) -> List[Publication]:
        return [self._image, self._info, *([self._points] if self._points is not None else [])]

    @property
    def cloud_wanted(self) -> bool:
        return self._points is not None and self._points.wanted

    def publish(self, depth: Optional[Any], rgb: Optional[Any], ns: int) -> None:
        context = self._context
        head = header(context, ns, self._frame)
        if self._info.wanted:
            self._info.publish(self._lens.calibration.message(head))
        if depth is None:
            return
        seen = LazyValue(lambda: _within(self._span, depth))
        points = seen if self._cloud_span == self._span else LazyValue(
            lambda: _within(self._cloud_span, depth))
        if self._image.wanted:
            self._image.publish_later(lambda: self._picture(head, seen.get()))
        if self._points is not None and self._points.wanted:
            self._points.publish_later(lambda: self._cloud(head, points.get(), rgb))

    def _picture(self, head: Any, depth: Any) -> Any:
        if self._wide:
            return make_image(self._context, head, depth, "32FC1")
        import numpy as np

        millimetres = np.rint(np.where(depth <= _MOST, depth, 0.0) * _MILLIMETRES)
        return make_image(self._context, head, millimetres.astype(np.uint16), "16UC1")

    def _cloud(self, head: Any, depth: Any, rgb: Optional[Any]) -> Any:
        if self._geometry is None:
            spec = self._lens.spec
            self._geometry = DepthGeometry(spec.width, spec.height, spec.focal_length)
        points, dense = self._geometry.cloud(depth, rgb)
        return cloud_message(self._context, head, points, points.shape[:2], POINT_STEP, XYZ_RGB,
                             dense)


def _within(span: "tuple[float, float]", depth: Any) -> Any:
    """Depths between two, m; NaN for others."""
    import numpy as np

    return np.where((depth > span[0]) & (depth < span[1]), depth, np.float32(np.nan))


class DepthCamera(Plugin):
    """A camera that sees colours and depth at the same time, from the same place."""

    furthest = _FAR
    """Default of `<pointCloudCutoffMax>`, m."""

    def load(self) -> None:
        context, p = self.enter_namespace(empty_means_model=True)
        sensor = camera_sensor(context, "depth")
        block = sensor.cameras[0]
        topics = topics_of(context)
        self._colors = PictureStream(context, sensor, context.sensor_link, block, topics,
                                     p.number("hackBaseline", 0.0), p.flag("borderCrop", True))
        self._depth = DepthStream(
            context, self._colors, _names(context, topics), p.number("pointCloudCutoff", 0.4),
            p.number("pointCloudCutoffMax", self.furthest),
            not p.flag("useDepth16UC1Format", False))
        ImagerRate(context, [topics.base], self.update,
                   lambda: self._colors.wanted or self._depth.wanted,
                   [*self._colors.publications, *self._depth.publications])

    def update(self) -> None:
        """Take a picture of what is wanted."""
        outputs: List[str] = []
        if self._colors.wanted or self._depth.cloud_wanted:
            outputs.append(RGB)
        if self._depth.wanted:
            outputs.append(DEPTH)
        if outputs:
            self.context.photograph([self._colors.view(*outputs)], self._deliver_pictures)
        else:
            self._publish_pictures(None, None, self.context.now_ns)

    def _deliver_pictures(self, pictures: List[Any], ns: int) -> None:
        self._publish_pictures(pictures[0].rgb, pictures[0].depth, ns)

    def _publish_pictures(self, rgb: Optional[Any], depth: Optional[Any], ns: int) -> None:
        self._colors.publish(rgb, ns)
        self._depth.publish(depth, rgb, ns)


class OpenniKinect(DepthCamera):
    """The same, with an end of what is seen."""

    furthest = 5.0


def _names(context: Context, topics: CameraTopics) -> "tuple[str, str, str]":
    p = context.parameters
    return (topics.named(p.text("depthImageTopicName") or "depth/image_raw"),
            topics.named(p.text("depthImageCameraInfoTopicName") or "depth/camera_info"),
            topics.named(p.text("pointCloudTopicName") or "points"))
