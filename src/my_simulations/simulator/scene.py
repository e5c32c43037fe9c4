"""Settings of a world besides models, lights and physics: scene, camera, wind, place, ..."""

from __future__ import annotations

from dataclasses import fields, is_dataclass, replace
from typing import Any, Dict, List, Optional

from ..description.plugin import PluginSpec
from ..description.surroundings import Atmosphere, GuiCamera, Scene, SphericalCoordinates, Wind
from ..geometry import Vec3
from .session import Session


class SceneSettings:
    """Sets fields of the description that are drawn or saved, but not simulated.

    Read them from `Simulator.world`. Each call takes both locks of the session. A new value without
    `extra` XML keeps that of the old value, so that saving the world loses no elements of its file.
    """

    def __init__(self, session: Session) -> None:
        self._session = session

    def set_scene(self, scene: Scene) -> None:
        """Set ambient light, background, sky, fog, shadows and grid."""
        self._session.set_world_fields(scene=_with_extra(scene, self._session.world.scene))

    def set_gui_camera(self, camera: Optional[GuiCamera]) -> None:
        """Set the initial view of the editor."""
        self._session.set_world_fields(gui_camera=_with_extra(
            camera, self._session.world.gui_camera))

    def set_wind(self, wind: Wind) -> None:
        """Set the wind velocity, m/s in the world frame; saved, without effect on motion."""
        self._session.set_world_fields(wind=_with_extra(wind, self._session.world.wind))

    def set_atmosphere(self, atmosphere: Atmosphere) -> None:
        """Set the atmosphere; saved, without effect on motion."""
        self._session.set_world_fields(atmosphere=_with_extra(
            atmosphere, self._session.world.atmosphere))

    def set_magnetic_field(self, field: Vec3) -> None:
        """Set the magnetic field, T in the world frame; used by magnetometers and saved."""
        self._session.set_world_fields(magnetic_field=field)

    def set_plugins(self, plugins: List[PluginSpec]) -> None:
        """Set the plugins of the world; a running plugin host loads them."""
        self._session.set_world_fields(plugins=plugins)

    def set_spherical_coordinates(self, place: Optional[SphericalCoordinates]) -> None:
        """Kept and saved."""
        self._session.set_world_fields(spherical_coordinates=_with_extra(
            place, self._session.world.spherical_coordinates))


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
