"""libmy_simulations_segmentation_camera.so: which link each pixel shows. Not in Gazebo Classic.

In a `<sensor>` of type camera, with the parameters of libgazebo_ros_camera.so. The image is mono16:
0 for nothing, else the number of a link, as listed on `labels`, a latched std_msgs/String of JSON:
{"1": "model::link", ...}. A link keeps its number while the plugin runs.
"""
from __future__ import annotations

import json
from typing import Any, Dict, List

from ...sensing.api import LABELS, NO_ROW
from ..base import Plugin
from ..context import View
from ..frames import data_message
from .camera_parameters import Calibration, rate_of, spec_of, topics_of
from .image_messages import header, make_image
from .picture_stream import camera_sensor, place_of


class SegmentationCamera(Plugin):
    """Image of numbers, CameraInfo, names of the numbers."""

    def load(self) -> None:
        context, p = self.enter_namespace(empty_means_model=True)
        sensor = camera_sensor(context, "camera")
        block = sensor.cameras[0]
        self._topics = topics = topics_of(context)
        spec = spec_of(context, block, p.flag("borderCrop", True))
        self._calibration = Calibration(context, block, spec, 0.0)
        self._view = View(context.sensor_link, place_of(sensor, block), spec, (LABELS,))
        self._image = context.publish(topics.named(topics.image), "sensor_msgs/Image", 2)
        self._info = context.publish(topics.named(topics.info), "sensor_msgs/CameraInfo", 2)
        self._names = context.publish(topics.named("labels"), "std_msgs/String", 1, latch=True)
        self._numbers: Dict[str, int] = {}
        context.observe(rate_of(context), self.update, [self._image, self._info], world=True)

    def update(self) -> None:
        """Take a picture, if the image topic has a subscriber."""
        if self._image.wanted:
            names = self.context.link_names()
            self.context.photograph([self._view],
                                    lambda pictures, ns: self._seen(pictures, ns, names))
        elif self._info.wanted:
            self._info.publish(self._calibration.message(
                header(self.context, self.context.now_ns, self._topics.frame)))

    def _seen(self, pictures: List[Any], ns: int, names: Dict[int, str]) -> None:
        import numpy as np

        context = self.context
        head = header(context, ns, self._topics.frame)
        rows = pictures[0].labels
        table = np.zeros(max(names, default=0) + 2, np.uint16)  # NO_ROW is the last
        known = len(self._numbers)
        for row in np.unique(rows).tolist():
            if row != NO_ROW and row in names:
                table[row] = self._numbers.setdefault(names[row], len(self._numbers) + 1)
        if len(self._numbers) != known:
            self._names.publish(data_message(context, "std_msgs/String", json.dumps(
                {str(n): name for name, n in self._numbers.items()})))
        if self._info.wanted:
            self._info.publish(self._calibration.message(head))
        self._image.publish_later(lambda: make_image(context, head, table[rows], "mono16"))
