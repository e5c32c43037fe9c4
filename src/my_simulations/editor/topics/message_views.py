"""What pages are sent of a message: a head in JSON (`View` of the protocol), and plain numbers."""
from __future__ import annotations

import math
from typing import Any, Callable, Dict, List, Tuple

from ...errors import SimulationError
from .accumulated_views import Markers, Transforms
from .image_views import compressed_image, image
from .plain_numbers import number, pose, vector
from .point_views import point_cloud, point_cloud_2

View = Tuple[Dict[str, Any], bytes]
"""The view's fields, and the bytes that follow the head."""


class UnviewableError(SimulationError):
    """A message that cannot be shown; the message says why."""


class Viewer:
    """Makes views of one topic's messages.

    `receive` may be called from any thread, `view` from another one. A view shows the newest
    message, or, of topics that send parts (tf, markers), all parts received so far.

    Args:
        kind: the topic's type.
        now: sim time, s.

    Attributes:
        newest: the newest message; None before the first.
    """

    def __init__(self, kind: str, now: Callable[[], float]) -> None:
        self._make = VIEWS.get(kind, _text)
        self._kept = ACCUMULATED[kind](now) if kind in ACCUMULATED else None
        self.newest: Any = None

    def receive(self, message: Any) -> None:
        if self._kept is not None:
            self._kept.receive(message)
        self.newest = message

    def view(self) -> Tuple[str, float, View]:
        """Frame, stamp in s, view. Raises SimulationError for what cannot be shown."""
        import numpy as np

        message = self.newest
        try:
            if self._kept is not None:
                return "", 0.0, (self._kept.fields(), b"")
            frame, stamp = _header(message)
            with np.errstate(all="ignore"):  # NaN is common here
                return frame, stamp, self._make(message)
        except (AttributeError, ValueError, TypeError, LookupError, ArithmeticError) as fault:
            raise UnviewableError(f"the message is not as its type says: {fault}") from fault


def _header(message: Any) -> Tuple[str, float]:
    header = getattr(message, "header", None)
    if header is None:
        return "", 0.0
    return str(header.frame_id), header.stamp.to_nsec() * 1e-9


def _scan(message: Any) -> View:
    import numpy as np

    ranges = np.asarray(message.ranges, dtype="<f4")
    seen = np.isfinite(ranges) & (ranges >= message.range_min) & (ranges <= message.range_max)
    return {"type": "scan", "angle_min": number(message.angle_min),
            "angle_increment": number(message.angle_increment),
            "range_min": number(message.range_min), "range_max": number(message.range_max),
            "count": len(ranges)}, np.where(seen, ranges, np.float32("nan")).tobytes()


def _range(message: Any) -> View:
    found = number(message.range, None)
    seen = found is not None and message.min_range <= found < message.max_range
    return {"type": "range", "range": found if seen else None,
            "range_min": number(message.min_range), "range_max": number(message.max_range),
            "field_of_view": number(message.field_of_view)}, b""


def _odometry(message: Any) -> View:
    twist = message.twist.twist
    return {"type": "odometry", "child": message.child_frame_id,
            "pose": pose(message.pose.pose), "linear": vector(twist.linear),
            "angular": vector(twist.angular)}, b""


def _poses(poses: Any, line: bool = False) -> View:
    step = max(1, math.ceil(len(poses) / _MOST_POSES))
    return {"type": "path", "poses": [pose(one) for one in poses[::step]], "line": line}, b""


_MOST_POSES = 2000
_MOST_CONTACTS = 500


def _contacts(message: Any) -> View:
    positions: List[List[float]] = []
    normals: List[List[float]] = []
    for state in message.states:
        positions += [vector(one) for one in state.contact_positions]
        normals += [vector(one) for one in state.contact_normals]
    return {"type": "contacts", "positions": positions[:_MOST_CONTACTS],
            "normals": normals[:_MOST_CONTACTS]}, b""


def _map(message: Any) -> View:
    info = message.info
    cells = bytes(one & 0xFF for one in message.data)
    if len(cells) != info.width * info.height:
        raise ValueError(f"{len(cells)} cells for {info.width} x {info.height}")
    return {"type": "map", "width": info.width, "height": info.height,
            "resolution": number(info.resolution), "pose": pose(info.origin)}, cells


def _text(message: Any) -> View:
    return {"type": "text", "text": text_of(message)}, b""


VIEWS: Dict[str, Callable[[Any], View]] = {
    "sensor_msgs/LaserScan": _scan, "sensor_msgs/Range": _range,
    "sensor_msgs/Image": image, "sensor_msgs/CompressedImage": compressed_image,
    "sensor_msgs/PointCloud": point_cloud, "sensor_msgs/PointCloud2": point_cloud_2,
    "nav_msgs/Odometry": _odometry, "nav_msgs/OccupancyGrid": _map,
    "nav_msgs/Path": lambda message: _poses([one.pose for one in message.poses], line=True),
    "geometry_msgs/PoseArray": lambda message: _poses(message.poses),
    "geometry_msgs/PoseStamped": lambda message: _poses([message.pose]),
    "geometry_msgs/PoseWithCovarianceStamped": lambda message: _poses([message.pose.pose]),
    "gazebo_msgs/ContactsState": _contacts,
}
"""How a message of a type is shown; others as text."""

ACCUMULATED: Dict[str, Callable[[Callable[[], float]], Any]] = {
    "tf2_msgs/TFMessage": Transforms, "tf/tfMessage": Transforms,
    "visualization_msgs/Marker": Markers, "visualization_msgs/MarkerArray": Markers,
}
"""Types whose messages contain a part of the whole."""


_MOST_ITEMS = 24
_MOST_CHARACTERS = 6000


def text_of(message: Any) -> str:
    """The message's fields, one a line."""
    lines: List[str] = []
    _fields(message, 0, lines)
    text = "\n".join(lines)
    return text if len(text) <= _MOST_CHARACTERS else text[:_MOST_CHARACTERS] + "\n..."


def _fields(message: Any, depth: int, lines: List[str]) -> None:
    for name in message.__slots__:
        _field(name, getattr(message, name), depth, lines)
        if len(lines) > _MOST_CHARACTERS // 4:
            return


def _field(name: str, value: Any, depth: int, lines: List[str]) -> None:
    lead = "  " * depth
    if hasattr(value, "to_nsec"):
        lines.append(f"{lead}{name}: {value.to_nsec() * 1e-9:.3f}")
    elif hasattr(value, "__slots__"):
        lines.append(f"{lead}{name}:")
        _fields(value, depth + 1, lines)
    elif isinstance(value, (bytes, bytearray)):
        lines.append(f"{lead}{name}: {len(value)} bytes")
    elif isinstance(value, (list, tuple)):
        _list(name, value, depth, lines)
    else:
        lines.append(f"{lead}{name}: {_plain(value)}")


def _list(name: str, values: Any, depth: int, lines: List[str]) -> None:
    lead = "  " * depth
    if values and hasattr(values[0], "__slots__"):
        lines.append(f"{lead}{name}: ({len(values)})")
        for value in values[:_MOST_ITEMS]:
            lines.append(f"{lead}  -")
            _fields(value, depth + 2, lines)
        return
    shown = ", ".join(_plain(value) for value in values[:_MOST_ITEMS])
    more = f", ... ({len(values)})" if len(values) > _MOST_ITEMS else ""
    lines.append(f"{lead}{name}: [{shown}{more}]")


def _plain(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
