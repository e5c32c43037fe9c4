"""Topics whose messages tell a part of the whole: tf and markers."""
from __future__ import annotations

import threading
from typing import Any, Dict, List, Tuple

from .plain_numbers import number, pose, rotation, vector

_MOST_MARKERS = 1000
_MOST_POINTS = 5000

_SHAPES = {0: "arrow", 1: "cube", 2: "sphere", 3: "cylinder", 4: "line_strip", 5: "line_list",
           6: "cube_list", 7: "sphere_list", 8: "points", 9: "text", 10: "mesh",
           11: "triangle_list"}
"""visualization_msgs/Marker.type."""

_DELETE, _DELETE_ALL = 2, 3


class Transforms:
    """The last transform to each frame."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._known: Dict[str, Tuple[str, Any]] = {}

    def take(self, message: Any) -> None:
        """A tf2_msgs/TFMessage."""
        with self._lock:
            for one in message.transforms:
                self._known[one.child_frame_id.lstrip("/")] = (
                    one.header.frame_id.lstrip("/"), one.transform)

    def fields(self) -> Dict[str, Any]:
        """The view."""
        with self._lock:
            known = list(self._known.items())
        return {"type": "transforms", "transforms": [
            {"parent": parent, "child": child,
             "pose": vector(one.translation) + rotation(one.rotation)}
            for child, (parent, one) in known]}


class Markers:
    """The markers that were added and not deleted."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._known: Dict[str, Any] = {}

    def take(self, message: Any) -> None:
        """A visualization_msgs/Marker or MarkerArray."""
        with self._lock:
            for one in getattr(message, "markers", None) or [message]:
                self._take(one)

    def _take(self, marker: Any) -> None:
        if not hasattr(marker, "action"):
            return  # an empty array
        name = f"{marker.ns}/{marker.id}"
        if marker.action == _DELETE_ALL:
            self._known.clear()
        elif marker.action == _DELETE:
            self._known.pop(name, None)
        elif name in self._known or len(self._known) < _MOST_MARKERS:
            self._known[name] = marker

    def fields(self) -> Dict[str, Any]:
        """The view."""
        with self._lock:
            known = list(self._known.items())
        return {"type": "markers", "markers": [_marker(name, one) for name, one in known]}


def _marker(name: str, marker: Any) -> Dict[str, Any]:
    return {"id": name, "shape": _SHAPES.get(marker.type, "cube"),
            "frame": marker.header.frame_id, "pose": pose(marker.pose),
            "scale": vector(marker.scale), "color": _color(marker.color),
            "points": [vector(one) for one in marker.points[:_MOST_POINTS]],
            "colors": [_color(one) for one in marker.colors[:_MOST_POINTS]],
            "text": marker.text, "lifetime": number(marker.lifetime.to_nsec() * 1e-9)}


def _color(message: Any) -> List[float]:
    return [min(1.0, max(0.0, number(part)))
            for part in (message.r, message.g, message.b, message.a)]
