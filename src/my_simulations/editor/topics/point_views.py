"""Point clouds as plain numbers: points in m, and colours."""
from __future__ import annotations

from typing import Any, Dict, Optional, Tuple

_MOST_POINTS = 60000
"""Sent of one cloud; of larger ones every n-th point."""

_TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 8: "f8"}
"""sensor_msgs/PointField.datatype."""


def point_cloud(message: Any) -> Tuple[Dict[str, Any], bytes]:
    """A sensor_msgs/PointCloud; its channel `intensity` or `rgb` gives the colours."""
    import numpy as np

    points = np.array([(one.x, one.y, one.z) for one in message.points],
                      dtype="<f4").reshape(-1, 3)
    channels = {one.name: np.asarray(one.values, dtype="<f4") for one in message.channels
                if len(one.values) == len(points)}
    return _view(points, channels.get("rgb"), _intensity(channels), len(points))


def point_cloud_2(message: Any) -> Tuple[Dict[str, Any], bytes]:
    """A sensor_msgs/PointCloud2 with fields x, y, z. Raises ValueError for another one."""
    import numpy as np

    order = ">" if message.is_bigendian else "<"
    names, formats, offsets = [], [], []
    for field in message.fields:
        if field.datatype in _TYPES and field.count in (0, 1):
            names.append(field.name)
            formats.append(order + _TYPES[field.datatype])
            offsets.append(field.offset)
    if not {"x", "y", "z"} <= set(names):
        raise ValueError("the cloud has no fields x, y, z")
    record = np.dtype({"names": names, "formats": formats, "offsets": offsets,
                       "itemsize": message.point_step})
    rows = np.frombuffer(message.data, "u1", message.height * message.row_step)
    rows = rows.reshape(message.height, message.row_step)[:, :message.width * message.point_step]
    total = message.width * message.height
    every = max(1, -(-total // _MOST_POINTS))
    cloud = np.ascontiguousarray(rows).view(record).reshape(-1)[::every]
    points = np.stack([cloud[axis].astype("<f4") for axis in "xyz"], axis=1)
    color = next((cloud[name] for name in ("rgb", "rgba") if name in names), None)
    channels = {name: cloud[name].astype("<f4") for name in names}
    return _view(points, color, _intensity(channels), total)


def _intensity(channels: Dict[str, Any]) -> Optional[Any]:
    return next((channels[name] for name in ("intensity", "intensities") if name in channels),
                None)


def _view(points: Any, rgb: Optional[Any], intensity: Optional[Any],
          total: int) -> Tuple[Dict[str, Any], bytes]:
    import numpy as np

    every = max(1, -(-len(points) // _MOST_POINTS))
    points = points[::every]
    valid = np.isfinite(points).all(axis=1)
    points = np.ascontiguousarray(points[valid])
    colors = b""
    if rgb is not None:
        # PCL packs blue, green and red into the bytes of a float.
        packed = np.ascontiguousarray(rgb[::every][valid])
        whole = packed.view("<u4") if packed.dtype.itemsize == 4 else packed.astype("<u4")
        colors = np.stack([whole >> 16 & 255, whole >> 8 & 255, whole & 255],
                          axis=1).astype("u1").tobytes()
    elif intensity is not None:
        values = intensity[::every][valid]
        known = values[np.isfinite(values)].astype("f8")
        low, high = (known.min(), known.max()) if len(known) else (0.0, 0.0)
        if high > low:
            shares = np.nan_to_num((values - low) / (high - low), nan=0.0)
            grey = (shares.clip(0.0, 1.0) * 205.0 + 50.0).astype("u1")
            colors = np.repeat(grey[:, None], 3, axis=1).tobytes()
    return {"type": "points", "count": len(points), "of": int(total),
            "colored": bool(colors)}, points.tobytes() + colors
