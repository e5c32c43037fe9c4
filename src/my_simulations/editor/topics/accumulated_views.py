"""Topics whose messages contain a part of the whole: tf and markers."""
from __future__ import annotations

import math
import threading
from typing import Any, Callable, Dict, List, Tuple

from .plain_numbers import number, pose, rotation, vector

_MOST_MARKERS = 1000
_MOST_POINTS = 5000

_SHAPES = {0: "arrow", 1: "cube", 2: "sphere", 3: "cylinder", 4: "line_strip", 5: "line_list",
           6: "cube_list", 7: "sphere_list", 8: "points", 9: "text", 10: "mesh",
           11: "triangle_list"}
"""visualization_msgs/Marker.type."""

_DELETE, _DELETE_ALL = 2, 3
_ENDLESS_S = 1e-4
"""A lifetime up to this has no end (rviz behaviour)."""


class Transforms:
    """The last transform to each frame."""

    def __init__(self, _now: Callable[[], float]) -> None:
        self._lock = threading.Lock()
        self._known: Dict[str, Tuple[str, Any]] = {}

    def receive(self, message: Any) -> None:
        """A tf2_msgs/TFMessage."""
        with self._lock:
            for one in message.transforms:
                self._known[one.child_frame_id.lstrip("/")] = (
                    one.header.frame_id.lstrip("/"), one.transform)

    def fields(self) -> Dict[str, Any]:
        with self._lock:
            known = list(self._known.items())
        return {"type": "transforms", "transforms": [
            {"parent": parent, "child": child,
             "pose": vector(one.translation) + rotation(one.rotation)}
            for child, (parent, one) in known]}


class Markers:
    """The markers that were added and not deleted, and whose lifetime has not passed.

    As in rviz a lifetime begins when the marker comes, and is sim time. When there are too many,
    those that came first are dropped.

    Args:
        now: sim time, s.
    """

    def __init__(self, now: Callable[[], float]) -> None:
        self._now = now
        self._lock = threading.Lock()
        self._known: Dict[str, _Kept] = {}

    def receive(self, message: Any) -> None:
        """A visualization_msgs/Marker or MarkerArray."""
        markers = getattr(message, "markers", None) or [message]
        with self._lock:
            now = self._now()
            if len(self._known) + len(markers) > _MOST_MARKERS:
                self._drop_expired(now)
            for one in markers:
                self._receive(one, now)

    def _receive(self, marker: Any, now: float) -> None:
        if not hasattr(marker, "action"):
            return  # an empty array
        name = f"{marker.ns}/{marker.id}"
        if marker.action == _DELETE_ALL:
            self._known.clear()
            return
        self._known.pop(name, None)
        if marker.action != _DELETE:
            if len(self._known) >= _MOST_MARKERS:
                self._known.pop(next(iter(self._known)))
            self._known[name] = _Kept(marker, now)

    def _drop_expired(self, now: float) -> None:
        self._known = {name: one for name, one in self._known.items() if not one.is_expired(now)}

    def fields(self) -> Dict[str, Any]:
        with self._lock:
            now = self._now()
            self._drop_expired(now)
            known = list(self._known.items())
        return {"type": "markers", "markers": [
            _marker(name, one.marker, one.remaining_lifetime(now)) for name, one in known]}


class _Kept:
    """A marker, with the sim times at which it came and at which its lifetime is over, s."""

    def __init__(self, marker: Any, came: float) -> None:
        self.marker = marker
        self._came = came
        lifetime = marker.lifetime.to_nsec() * 1e-9
        self._ends = came + lifetime if lifetime > _ENDLESS_S else math.inf

    def remaining_lifetime(self, now: float) -> float:
        """What is left of its lifetime, s; 0 without an end."""
        return self._ends - now if math.isfinite(self._ends) else 0.0

    def is_expired(self, now: float) -> bool:
        """Whether its lifetime is over, or sim time has started again."""
        return math.isfinite(self._ends) and not self._came <= now < self._ends


def _marker(name: str, marker: Any, left: float) -> Dict[str, Any]:
    return {"id": name, "shape": _SHAPES.get(marker.type, "cube"),
            "frame": marker.header.frame_id, "pose": pose(marker.pose),
            "scale": vector(marker.scale), "color": _color(marker.color),
            "points": [vector(one) for one in marker.points[:_MOST_POINTS]],
            "colors": [_color(one) for one in marker.colors[:_MOST_POINTS]],
            "text": marker.text, "lifetime": left}


def _color(message: Any) -> List[float]:
    return [min(1.0, max(0.0, number(part)))
            for part in (message.r, message.g, message.b, message.a)]
