"""The texts of the undo history: what each operation did, as Gazebo users say it."""
from __future__ import annotations

import re
from typing import Any, Dict, Optional, Sequence

from ...description.model import Model
from ...geometry import Vec3

_WORDS: Dict[str, str] = {
    "surface.mu": "friction", "surface.mu2": "second friction", "surface.fdir1":
    "friction direction", "surface.kp": "contact stiffness", "surface.kd": "contact damping",
    "surface.restitution": "restitution", "axis.lower": "lower limit", "axis.upper": "upper limit",
    "axis.effort": "effort limit", "axis.velocity": "velocity limit",
    "axis.xyz": "axis", "axis2.xyz": "second axis", "gui_camera": "GUI camera",
}
"""Names of properties that their path does not tell; others: the last part of the path."""

_KEPT_PREFIXES = ("axis2", "sky", "fog", "material", "gui_camera")
"""Parts of a path that stand before its last part, which alone would be ambiguous."""

_PART = re.compile(r"::(collision|visual|sensor):")
_LONGEST_TEXT = 40
_MOST_NAMES = 3

UNITS = {"prismatic": ("N", "m")}
"""Units of the effort and the position of a joint's axis, by its type; others turn."""


def join_names(names: Sequence[str]) -> str:
    """`a, b, c and 2 more`."""
    shown = ", ".join(names[:_MOST_NAMES])
    more = len(names) - _MOST_NAMES
    return shown if more <= 0 else f"{shown} and {more} more"


def short_target(target: str, model: Optional[Model]) -> str:
    """A scoped name without redundant parts: a model's only link, and so on.

    `unit_box::link::collision:collision` of a box is `unit_box`; of a robot it stays
    `robot::wheel::collision`.
    """
    plain = _PART.sub("::", target)
    if model is None or len(model.links) != 1:
        return plain
    link = model.links[0]
    whole = f"{model.name}::{link.name}"
    if target == whole:
        return model.name
    for kind, parts in (("collision", link.collisions), ("visual", link.visuals)):
        if target.startswith(f"{whole}::{kind}:") and len(parts) == 1:
            return model.name
    return plain


def set_property(target: str, path: str, value: Any, model: Optional[Model] = None) -> str:
    """`Set friction of unit_box to 0.5`; vectors and objects are not shown.

    Args:
        target: scoped name of what has the property; "" for the world.
        path: of the property, e.g. `surface.mu`.
        value: JSON.
        model: the target's, if it is of one; see `short_target`.
    """
    of = f" of {short_target(target, model)}" if target else ""
    shown = _format_value(value)
    return f"Set {_property(path)}{of}" + (f" to {shown}" if shown else "")


def apply_wrench(link: str, force: Vec3, torque: Vec3) -> str:
    """`Apply force to box::link`, `Apply torque to …` or `Apply force and torque to …`."""
    kinds = [word for word, vector in (("force", force), ("torque", torque)) if any(vector)]
    return f"Apply {' and '.join(kinds) or 'force'} to {link}"


def set_joint(joint: str, kind: str, mode: str, value: float) -> str:
    """`Set velocity target of arm::hinge: 2 rad/s`.

    Args:
        joint: scoped name.
        kind: type of the joint.
        mode: force, position or velocity.
        value: N or N m, m or rad, m/s or rad/s.
    """
    effort, position = UNITS.get(kind, ("N m", "rad"))
    if mode == "force":
        return f"Set effort of {joint}: {value:g} {effort}"
    unit = position if mode == "position" else f"{position}/s"
    return f"Set {mode} target of {joint}: {value:g} {unit}"


def _property(path: str) -> str:
    if path in _WORDS:
        return _WORDS[path]
    parts = path.split(".")
    kept = [part for part in parts[:-1] if part in _KEPT_PREFIXES][-1:]
    return " ".join([*kept, parts[-1]]).replace("_", " ")


def _format_value(value: Any) -> str:
    """A value that fits into a label; "" for what does not."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return f"{value:g}"
    if isinstance(value, str) and len(value) <= _LONGEST_TEXT:
        return repr(value)
    return ""
