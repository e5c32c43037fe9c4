"""What a world holds besides models: lights, scene, camera, wind, air, place on the globe.

And what comes back to its place in the order of models and lights.
"""
from __future__ import annotations

from dataclasses import replace
from typing import Any, List, Optional, Tuple

from ..description.world import (
    Atmosphere,
    GuiCamera,
    Light,
    Scene,
    SphericalCoordinates,
    Wind,
)
from ..errors import CommandError
from ..formats.surroundings import with_surroundings
from ..geometry import Pose, Vec3, compose, normalised, pose_is_finite
from .editing import ModelEdits
from .order import Turn
from .registry import Entity, UnknownEntity


class Surroundings(ModelEdits):
    """Everything the engine need not know."""

    # -- lights ----------------------------------------------------------------------------------

    def lights(self) -> List[Light]:
        """All lights, in order."""
        with self._lock:
            return list(self.world.lights)

    def light(self, name: str) -> Light:
        """The light of that name. Raises UnknownEntity."""
        for light in self.lights():
            if light.name == name:
                return light
        raise UnknownEntity(f"there is no light '{name}'")

    def add_light(self, light: Light, frame: str = "", turn: Optional[Turn] = None) -> None:
        """Put a light into the world, its pose given in `frame`; last, or where its turn is.

        Raises CommandError: empty or taken name, unknown frame, a pose that is not finite.
        """
        if not light.name:
            raise CommandError("a light needs a name")
        with self._order, self._lock:
            self._check_free(light.name)
            anchor = self._registry.frame(frame)
            pose = _usable(light)
            if anchor is not None:
                pose = compose(anchor.state(self._snapshot())[0], pose)
            lights = list(self.world.lights)
            at = len(lights) if turn is None else turn.among([one.name for one in lights])
            lights.insert(at, replace(light, pose=pose))
            self._surround(lights=lights)

    def set_light(self, name: str, light: Light) -> None:
        """Give a light other properties; another name renames it. Raises CommandError."""
        with self._order, self._lock:
            self.light(name)
            if not light.name:
                raise CommandError("a light needs a name")
            if light.name != name:
                self._check_free(light.name)
            light = replace(light, pose=_usable(light))
            self._surround(lights=[light if one.name == name else one for one in self.world.lights])

    def delete_light(self, name: str) -> Light:
        """Take a light out; returns what it was. Raises UnknownEntity."""
        with self._order, self._lock:
            light = self.light(name)
            self._surround(lights=[one for one in self.world.lights if one.name != name])
            return light

    # -- the rest --------------------------------------------------------------------------------

    def set_scene(self, scene: Scene) -> None:
        """How the view looks: ambient, background, sky, fog, shadows, grid."""
        self._surround(scene=scene)

    def set_gui_camera(self, camera: Optional[GuiCamera]) -> None:
        """The view the world opens with."""
        self._surround(gui_camera=camera)

    def set_wind(self, wind: Wind) -> None:
        """Stored and saved; the engine does not blow."""
        self._surround(wind=wind)

    def set_atmosphere(self, atmosphere: Atmosphere) -> None:
        """Stored and saved."""
        self._surround(atmosphere=atmosphere)

    def set_magnetic_field(self, field: Vec3) -> None:
        """T, world axes; stored and saved."""
        self._surround(magnetic_field=field)

    def set_spherical_coordinates(self, place: Optional[SphericalCoordinates]) -> None:
        """Stored and saved."""
        self._surround(spherical_coordinates=place)

    def _surround(self, **fields: Any) -> None:
        with self._order, self._lock:
            self.world = with_surroundings(self.world, **fields)
            self._registry.revision += 1

    # -- what there is ---------------------------------------------------------------------------

    @property
    def revision(self) -> int:
        """Grows with every change of names, descriptions, lights or surroundings."""
        with self._lock:
            return self._registry.revision

    def inventory(self) -> Tuple[int, List[Entity]]:
        """The revision and all entities in order; one whose description changes is a new object."""
        with self._lock:
            return self._registry.revision, self._registry.entities()


def _usable(light: Light) -> Pose:
    if not pose_is_finite(light.pose):
        raise CommandError(f"the pose of light '{light.name}' is not finite")
    return Pose(light.pose.position, normalised(light.pose.orientation))
