"""The lights of a running world."""
from __future__ import annotations

from dataclasses import replace
from typing import List, Optional

from ..description.light import Light
from ..errors import CommandError
from ..geometry import Pose, compose, normalised, pose_is_finite
from .order_slot import OrderSlot
from .registry import UnknownEntityError
from .session import Session, check_name


class Lights:
    """Owns the lights, which are not simulated. Changes take both locks of the session."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def all(self) -> List[Light]:
        with self._session.registry_lock:
            return list(self._session.world.lights)

    def get(self, name: str) -> Light:
        """The light of that name. Raises UnknownEntityError."""
        for light in self.all():
            if light.name == name:
                return light
        raise UnknownEntityError(f"unknown light '{name}'")

    def add(self, light: Light, frame: str = "", slot: Optional[OrderSlot] = None) -> None:
        """Add a light whose pose is given in `frame`: last, or at its former position in the order.

        Raises CommandError for an empty or existing name, an unknown frame, or a non-finite pose.
        """
        check_name(light.name, "light")
        session = self._session
        session.await_posted()
        with session.structure_lock, session.registry_lock:
            session.check_name_is_free(light.name)
            anchor = session.registry.frame(frame)
            pose = _usable_pose(light)
            if anchor is not None:
                pose = compose(anchor.state(session.snapshot())[0], pose)
            lights = self.all()
            at = len(lights) if slot is None else slot.among([one.name for one in lights])
            lights.insert(at, replace(light, pose=pose))
            session.set_world_fields(lights=lights)

    def set(self, name: str, light: Light) -> None:
        """Replace the light `name`; a new name in `light` renames it. Raises CommandError."""
        session = self._session
        with session.structure_lock, session.registry_lock:
            self.get(name)
            check_name(light.name, "light")
            if light.name != name:
                session.check_name_is_free(light.name)
            light = replace(light, pose=_usable_pose(light))
            session.set_world_fields(
                lights=[light if one.name == name else one for one in self.all()])

    def delete(self, name: str) -> Light:
        """Delete a light; returns its description. Raises UnknownEntityError."""
        session = self._session
        with session.structure_lock, session.registry_lock:
            light = self.get(name)
            session.set_world_fields(lights=[one for one in self.all() if one.name != name])
            return light


def _usable_pose(light: Light) -> Pose:
    if not pose_is_finite(light.pose):
        raise CommandError(f"the pose of light '{light.name}' contains NaN or infinity")
    return Pose(light.pose.position, normalised(light.pose.orientation))
