"""Pictures and point clouds as the bytes of messages. NumPy is imported with the first of them."""
from __future__ import annotations

import io
from typing import Any, Callable, Dict, Sequence, Tuple

from ..context import Context

ENCODINGS: Dict[str, str] = {
    "L8": "mono8", "L_INT8": "mono8", "L16": "mono16", "L_INT16": "mono16",
    "R8G8B8": "rgb8", "RGB_INT8": "rgb8", "B8G8R8": "bgr8", "BGR_INT8": "bgr8",
    "R16G16B16": "rgb16", "RGB_INT16": "rgb16",
    "BAYER_RGGB8": "bayer_rggb8", "BAYER_BGGR8": "bayer_bggr8",
    "BAYER_GBRG8": "bayer_gbrg8", "BAYER_GRBG8": "bayer_grbg8",
}
"""Encodings of sensor_msgs/Image by SDF's `<image><format>` (as gazebo_plugins)."""

_LUMINANCE = (0.299, 0.587, 0.114)  # ITU-R BT.601
_WIDE = 257                         # 255 becomes 65535
POINT_STEP = 32
_RGB_AT = 16
UINT16, FLOAT32 = 4, 7  # of sensor_msgs/PointField


class LazyValue:
    """A value that the first `get` computes; for one thread."""

    def __init__(self, make: Callable[[], Any]) -> None:
        self._make, self._value = make, None

    def get(self) -> Any:
        if self._value is None:
            self._value = self._make()
        return self._value


def encode_picture(rgb: Any, encoding: str) -> Any:
    """Convert a picture (h, w, 3) uint8 to an array whose bytes are the data of sensor_msgs/Image.

    `encoding`: that of the message, such as `rgb8`, `mono16` or `bayer_rggb8`.
    """
    import numpy as np

    if encoding == "rgb8":
        return rgb
    if encoding == "bgr8":
        return np.ascontiguousarray(rgb[..., ::-1])
    if encoding == "rgb16":
        return rgb.astype(np.uint16) * _WIDE
    if encoding.startswith("bayer_"):
        return _mosaic(rgb, encoding[6:10])
    grey = np.rint(rgb @ np.array(_LUMINANCE, np.float32)).astype(np.uint8)
    return grey if encoding == "mono8" else grey.astype(np.uint16) * _WIDE


def _mosaic(rgb: Any, order: str) -> Any:
    """One colour a pixel, in squares of two by two; `order` row by row, e.g. rggb."""
    import numpy as np

    made = np.empty(rgb.shape[:2], np.uint8)
    for n, color in enumerate(order):
        row, column = divmod(n, 2)
        made[row::2, column::2] = rgb[row::2, column::2, "rgb".index(color)]
    return made


def make_image(context: Context, header: Any, pixels: Any, encoding: str) -> Any:
    """Make a sensor_msgs/Image of an array from `encode_picture` or a depth camera."""
    message = context.message("sensor_msgs/Image")
    message.header = header
    message.height, message.width = pixels.shape[:2]
    message.encoding, message.is_bigendian = encoding, 0
    message.step = pixels.strides[0]
    message.data = pixels.tobytes()
    return message


def make_compressed_image(context: Context, header: Any, rgb: Any, encoding: str, form: str,
                          quality: int) -> Any:
    """Make a sensor_msgs/CompressedImage in the form that image_transport reads.

    `rgb` is uint8 (h, w, 3); `encoding` is that of the raw topic, which the decoded image gets;
    `form` jpeg or png; `quality` of jpeg, 1 to 100.
    """
    from PIL import Image

    grey = encoding.startswith("mono")
    picture = Image.fromarray(encode_picture(rgb, "mono8") if grey else rgb)
    stream = io.BytesIO()
    if form == "png":
        picture.save(stream, "PNG", compress_level=1)
    else:
        picture.save(stream, "JPEG", quality=quality)
    message = context.message("sensor_msgs/CompressedImage")
    message.header = header
    kind = "mono8" if grey else (encoding if encoding in ("rgb8", "bgr8") else "rgb8")
    # What is said to be inside, OpenCV's decoder gives: colours as blue, green, red.
    message.format = f"{kind}; {form} compressed {'mono8' if grey else 'bgr8'}"
    message.data = stream.getvalue()
    return message


class DepthGeometry:
    """Where the pixels of a depth picture look: x right, y down, z forward (REP 103, optical)."""

    def __init__(self, width: int, height: int, focal_length: float) -> None:
        import numpy as np

        self._across = ((np.arange(width) - (width - 1) / 2) / focal_length).astype(np.float32)
        self._down = ((np.arange(height) - (height - 1) / 2) / focal_length).astype(
            np.float32)[:, None]

    def cloud(self, depth: Any, rgb: Any) -> Tuple[Any, bool]:
        """Points (h, w, 8) float32: x, y, z, _, rgb, _, _, _; and whether all are finite.

        Args:
            depth: float32 (h, w), m; NaN where there is none.
            rgb: uint8 (h, w, 3), or None for black.
        """
        import numpy as np

        points = np.zeros((*depth.shape, POINT_STEP // 4), np.float32)
        np.multiply(depth, self._across, out=points[..., 0])
        np.multiply(depth, self._down, out=points[..., 1])
        points[..., 2] = depth
        if rgb is not None:
            # As PCL packs colours: bytes blue, green, red.
            points.view(np.uint8)[..., _RGB_AT:_RGB_AT + 3] = rgb[..., ::-1]
        return points, bool(np.isfinite(depth).all())


PointFields = Sequence[Tuple[str, int, int]]
"""Name, offset in a point (bytes) and type of each field."""

XYZ: PointFields = (("x", 0, FLOAT32), ("y", 4, FLOAT32), ("z", 8, FLOAT32))
XYZ_RGB: PointFields = (*XYZ, ("rgb", _RGB_AT, FLOAT32))


def cloud_message(context: Context, header: Any, points: Any, shape: Tuple[int, int],
                  step: int, fields: PointFields, dense: bool) -> Any:
    """Return a sensor_msgs/PointCloud2 of an array with the bytes of the points.

    `shape`: rows and points of a row; `step`: bytes of a point.
    """
    message = context.message("sensor_msgs/PointCloud2")
    message.header, (message.height, message.width) = header, shape
    message.fields = []
    for name, offset, kind in fields:
        field = context.message("sensor_msgs/PointField")
        field.name, field.offset, field.datatype, field.count = name, offset, kind, 1
        message.fields.append(field)
    message.is_bigendian, message.is_dense = False, dense
    message.point_step, message.row_step = step, step * message.width
    message.data = points.tobytes()
    return message


def header(context: Context, ns: int, frame: str) -> Any:
    made = context.message("std_msgs/Header")
    made.stamp, made.frame_id = context.stamp(ns), frame
    return made
