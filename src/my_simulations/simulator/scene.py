"""What a world holds besides models, lights and physics: scene, camera, wind, air, place."""

from __future__ import annotations

from typing import Optional

from ..description.world import Atmosphere, GuiCamera, Scene, SphericalCoordinates, Wind
from ..geometry import Vec3
from .session import Session


class SceneSettings:
    """Sets fields of the description that are shown or saved, and not simulated.

    They are read from `Simulator.world`. Each call takes both locks of the session.
    """

    def __init__(self, session: Session) -> None:
        self._session = session

    def set_scene(self, scene: Scene) -> None:
        """Ambient light, background, sky, fog, shadows and grid."""
        self._session.set_world_fields(scene=scene)

    def set_gui_camera(self, camera: Optional[GuiCamera]) -> None:
        """The view that the world opens with."""
        self._session.set_world_fields(gui_camera=camera)

    def set_wind(self, wind: Wind) -> None:
        """Kept and saved; no force comes of it."""
        self._session.set_world_fields(wind=wind)

    def set_atmosphere(self, atmosphere: Atmosphere) -> None:
        """Kept and saved."""
        self._session.set_world_fields(atmosphere=atmosphere)

    def set_magnetic_field(self, field: Vec3) -> None:
        """T, world axes; kept and saved."""
        self._session.set_world_fields(magnetic_field=field)

    def set_spherical_coordinates(self, place: Optional[SphericalCoordinates]) -> None:
        """Kept and saved."""
        self._session.set_world_fields(spherical_coordinates=place)
