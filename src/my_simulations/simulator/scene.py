"""Settings of a world besides models, lights and physics: scene, camera, wind, place, ..."""

from __future__ import annotations

from dataclasses import fields, is_dataclass, replace
from typing import Any, Dict

from .session import Session

WORLD_FIELDS = ("scene", "gui_camera", "wind", "atmosphere", "magnetic_field",
                "spherical_coordinates")
"""Fields of a world besides models, lights, plugins and physics."""


class SceneSettings:
    """Sets fields of the description that are drawn, read by plugins or saved, but not simulated.

    Read them from `Simulator.world`. Each call takes both locks of the session.
    """

    def __init__(self, session: Session) -> None:
        self._session = session

    def set_field(self, name: str, value: Any) -> None:
        """Set one of `WORLD_FIELDS`, or `plugins`, which a running plugin host loads.

        A value without `extra` XML keeps that of the old value, so that saving the world loses no
        elements of its file.
        """
        before = getattr(self._session.world, name)
        self._session.set_world_fields(**{name: _with_extra(value, before)})


def _with_extra(new: Any, old: Any) -> Any:
    """`new` with the `extra` XML of `old`, unless it has its own."""
    if not is_dataclass(new) or isinstance(new, type) or type(new) is not type(old):
        return new
    changes: Dict[str, Any] = {}
    for item in fields(new):
        value, before = getattr(new, item.name), getattr(old, item.name)
        changes[item.name] = (value or before) if item.name == "extra" else _with_extra(
            value, before)
    return replace(new, **changes)
