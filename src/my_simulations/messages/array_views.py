"""Pictures and point clouds of messages as arrays."""
from __future__ import annotations

from typing import Any, Mapping, Tuple

import numpy as np

from ..errors import CommandError

_ENCODINGS: Mapping[str, Tuple[str, int]] = {
    "mono8": ("u1", 1), "rgb8": ("u1", 3), "bgr8": ("u1", 3), "rgba8": ("u1", 4),
    "bgra8": ("u1", 4), "8UC1": ("u1", 1), "8UC3": ("u1", 3), "8UC4": ("u1", 4),
    "mono16": ("u2", 1), "16UC1": ("u2", 1), "32SC1": ("i4", 1), "32FC1": ("f4", 1),
    "bayer_rggb8": ("u1", 1), "bayer_bggr8": ("u1", 1), "bayer_gbrg8": ("u1", 1),
    "bayer_grbg8": ("u1", 1)}
"""Type and number of the values of a pixel, by encoding."""

_FIELD_TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 8: "f8"}


def pixels(image: Any) -> np.ndarray:
    """Return the pixels of a sensor_msgs/Image: shape (height, width), or (height, width, values).

    Raises CommandError for an unknown encoding.
    """
    if image.encoding not in _ENCODINGS:
        raise CommandError(f"the encoding {image.encoding!r} of the picture is unknown")
    code, values = _ENCODINGS[image.encoding]
    dtype = np.dtype(code).newbyteorder(">" if image.is_bigendian else "<")
    rows = np.asarray(image.data, np.uint8).reshape(image.height, image.step)
    flat = np.ascontiguousarray(rows[:, :image.width * values * dtype.itemsize]).view(dtype)
    return flat if values == 1 else flat.reshape(image.height, image.width, values)


def points(cloud: Any) -> np.ndarray:
    """Return the points of a sensor_msgs/PointCloud2 as a structured array, shape (height, width).

    Its fields are those of the message: `points(cloud)["x"]` is in m.
    """
    order = ">" if cloud.is_bigendian else "<"
    kinds = [order + _FIELD_TYPES[one.datatype] for one in cloud.fields]
    dtype = np.dtype({"names": [one.name for one in cloud.fields],
                      "formats": [(kind, (one.count,)) if one.count > 1 else kind
                                  for kind, one in zip(kinds, cloud.fields)],
                      "offsets": [one.offset for one in cloud.fields],
                      "itemsize": cloud.point_step})
    data = np.asarray(cloud.data, np.uint8).reshape(cloud.height, cloud.row_step)
    rows = np.ascontiguousarray(data[:, :cloud.width * cloud.point_step])
    return rows.view(dtype).reshape(cloud.height, cloud.width)
