"""librealsense_gazebo_plugin.so: colour, depth, two infrared pictures and points of a RealSense.

A plugin of the model: it uses the model's sensors whose names end with `color`, `depth`, `ired1`
and `ired2`, after `<prefix>`. Parameters are those of realsense_gazebo_plugin; its topics
are below the plugin's name, and `<robotNamespace>` is ignored. A sensor that the model lacks is
reported and left out (in realsense_gazebo_plugin the simulation ends).
"""
from __future__ import annotations

from functools import partial
from typing import Any, Callable, List, Optional, Tuple

from ...description.sensor import Sensor
from ...sensing.api import DEPTH, RGB
from ..base import Plugin
from ..context import PluginError
from .camera_parameters import USUAL_RATE, CameraTopics
from .depth_camera import DepthStream
from .picture_stream import PictureStream

_EYES = (("color", "color"), ("ired1", "infrared1"), ("ired2", "infrared2"))
_RATES = {"color": "colorUpdateRate", "ired1": "infraredUpdateRate", "ired2": "infraredUpdateRate",
          "depth": "depthUpdateRate"}


class RealSense(Plugin):
    """Four cameras in a housing."""

    def load(self) -> None:
        context = self.context
        context.use_namespace(context.parameters.attribute("name"))
        self._prefix = context.parameters.text("prefix")
        found = 0
        for name, words in _EYES:
            sensor = self._sensor(name)
            if sensor is not None:
                found += 1
                stream = self._stream(sensor, words, True)
                context.observe(self._rate(name, sensor[1]),
                                partial(self._request_picture, name, stream),
                                stream.publications, world=True)
        depth = self._sensor("depth")
        if depth is not None:
            self._load_depth(depth)
        elif not found:
            raise PluginError(f"the model has no camera named '{self._prefix}color' or "
                              f"'{self._prefix}depth'")

    def _sensor(self, name: str) -> Optional[Tuple[str, Sensor]]:
        wanted = self._prefix + name
        for link, sensor in self.context.sensors():
            if sensor.cameras and sensor.name.rpartition("::")[2] == wanted:
                return link, sensor
        self.context.warn(f"the model has no camera named '{wanted}'; it is left out")
        return None

    def _rate(self, name: str, sensor: Sensor) -> float:
        said = (self.context.parameters.number(_RATES[name], 0.0), sensor.update_rate)
        return min((rate for rate in said if rate > 0.0), default=USUAL_RATE)

    def _stream(self, found: Tuple[str, Sensor], words: str, published: bool) -> PictureStream:
        p, (link, sensor) = self.context.parameters, found
        usual = f"{words if published else f'{words}/intensity'}/image_raw"
        name = (p.text(f"{words}TopicName") if published else "") or usual
        topics = CameraTopics("", name, _info_of(name), p.text(f"{words}OpticalframeName"))
        return PictureStream(self.context, sensor, link, sensor.cameras[0], topics,
                             calibrated=False)

    def _load_depth(self, found: Tuple[str, Sensor]) -> None:
        context, p = self.context, self.context.parameters
        self._gray = self._stream(found, "depth", False)
        name = p.text("depthTopicName") or "depth/image_raw"
        cloud = p.text("pointCloudTopicName") or "depth/points"
        self._depth = DepthStream(
            context, self._gray,
            (name, _info_of(name), cloud if p.flag("pointCloud", False) else ""),
            p.number("rangeMinDepth", 0.2), p.number("rangeMaxDepth", 10.0), False,
            (p.number("pointCloudCutoff", 0.0), p.number("pointCloudCutoffMax", 5.0)))
        context.observe(self._rate("depth", found[1]), self._request_depth,
                        [*self._gray.publications, *self._depth.publications], world=True)

    def _request_picture(self, name: str, stream: PictureStream) -> None:
        self._photograph(name, stream, (RGB,) if stream.wanted else (),
                   lambda picture, ns: stream.publish(
                       None if picture is None else picture.rgb, ns))

    def _request_depth(self) -> None:
        outputs = ((DEPTH,) if self._depth.wanted else ()) + (
            (RGB,) if self._depth.cloud_wanted or self._gray.wanted else ())

        def seen(picture: Any, ns: int) -> None:
            rgb, depth = (None, None) if picture is None else (picture.rgb, picture.depth)
            self._gray.publish(rgb, ns)
            self._depth.publish(depth, rgb, ns)

        self._photograph("depth", self._gray, outputs, seen)

    def _photograph(self, name: str, stream: PictureStream, outputs: Tuple[str, ...],
              publish: Callable[[Any, int], None]) -> None:
        if not outputs:
            publish(None, self.context.now_ns)
            return

        def seen(pictures: List[Any], ns: int) -> None:
            publish(pictures[0], ns)

        self.context.photograph([stream.view(*outputs)], seen, name)


def _info_of(image: str) -> str:
    """The CameraInfo beside an image (image_transport's CameraPublisher)."""
    above, slash, _ = image.rpartition("/")
    return f"{above}{slash}camera_info"
