"""Objects of the description as JSON values: their fields by name, poses as seven numbers."""
from __future__ import annotations

import math
from dataclasses import fields, is_dataclass
from typing import Any, Dict

from ...description.model import INFINITE
from ...geometry import Pose

HIDDEN = frozenset(("extra", "base_dir", "path", "script_uris", "sensors", "soft",
                    "transmissions"))
"""Fields that are the files' business, besides those that do not count in comparisons."""


def plain(value: Any) -> Any:
    """The JSON form. Numbers that JSON cannot hold become SDF's "no limit", +-1e16."""
    if isinstance(value, Pose):
        return [*map(number, value.position), *map(number, value.orientation)]
    if is_dataclass(value) and not isinstance(value, type):
        return plain_fields(value)
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, dict):
        return {str(name): plain(item) for name, item in value.items()}
    if isinstance(value, float):
        return number(value)
    return value


def plain_fields(value: Any, *left_out: str) -> Dict[str, Any]:
    """All fields but the hidden ones and those named."""
    return {field.name: plain(getattr(value, field.name)) for field in fields(value)
            if field.compare and field.name not in HIDDEN and field.name not in left_out}


def number(value: float) -> float:
    """A number that JSON can hold."""
    if math.isfinite(value):
        return value
    return 0.0 if math.isnan(value) else math.copysign(INFINITE, value)


def pose_of(values: Any) -> Pose:
    """The pose of seven numbers; its quaternion as it is."""
    x, y, z, qx, qy, qz, qw = (float(value) for value in values)
    return Pose((x, y, z), (qx, qy, qz, qw))
