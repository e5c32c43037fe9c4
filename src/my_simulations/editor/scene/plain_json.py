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


def to_json(value: Any) -> Any:
    """Convert a value to JSON; infinite numbers become SDF's "no limit", +-1e16."""
    if isinstance(value, Pose):
        return [*map(finite_number, value.position), *map(finite_number, value.orientation)]
    if is_dataclass(value) and not isinstance(value, type):
        return fields_to_json(value)
    if isinstance(value, (list, tuple)):
        return [to_json(item) for item in value]
    if isinstance(value, dict):
        return {str(name): to_json(item) for name, item in value.items()}
    if isinstance(value, float):
        return finite_number(value)
    return value


def fields_to_json(value: Any, *left_out: str) -> Dict[str, Any]:
    """Convert a dataclass to JSON without hidden fields and those of `left_out`."""
    return {field.name: to_json(getattr(value, field.name)) for field in fields(value)
            if field.compare and field.name not in HIDDEN and field.name not in left_out}


def finite_number(value: float) -> float:
    """Return a number that JSON can represent: 0 for NaN, +-1e16 for infinity."""
    if math.isfinite(value):
        return value
    return 0.0 if math.isnan(value) else math.copysign(INFINITE, value)


def pose_of(values: Any) -> Pose:
    """The pose of seven numbers; its quaternion as it is."""
    x, y, z, qx, qy, qz, qw = (float(value) for value in values)
    return Pose((x, y, z), (qx, qy, qz, qw))
