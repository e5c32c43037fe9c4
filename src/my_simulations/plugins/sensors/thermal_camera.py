"""libgazebo_ros_thermal_camera.so and libgazebo_ros_thermal_depth_camera.so: heat as grey.

Parameters, topics and law are those of hector_gazebo_thermal_camera: pure red, (255, 0, 0), is hot
and white; any other colour is cold, (red + green + blue) / 8.
"""
from __future__ import annotations

from typing import Any

from .camera import Camera
from .picture_stream import PictureStream

_HOT = 255
_COLD_SHARE = 8


class HeatStream(PictureStream):
    """A camera whose pictures are mono8."""

    encoding = "mono8"

    def _picture(self, rgb: Any, ns: int) -> Any:
        return convert_to_heat(super()._picture(rgb, ns))


class ThermalCamera(Camera):
    """Image, compressed image and CameraInfo of heat."""

    stream_type = HeatStream


def convert_to_heat(rgb: Any) -> Any:
    """Convert a picture (h, w, 3) uint8 to a grey one of that shape; pure red is the hottest."""
    import numpy as np

    total = rgb.astype(np.uint16).sum(axis=2)
    hot = (rgb[..., 0] == _HOT) & (rgb[..., 1] == 0) & (rgb[..., 2] == 0)
    grey = np.where(hot, _HOT, total // _COLD_SHARE).astype(np.uint8)
    return np.repeat(grey[..., None], 3, axis=2)
