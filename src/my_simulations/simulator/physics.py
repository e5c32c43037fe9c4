"""The physics settings and gravity of a running world."""
from __future__ import annotations

from typing import Optional

from ..description.world import Physics
from ..engine.commands import PhysicsSettings, SetPhysics
from ..geometry import Vec3
from .session import Session


class WorldPhysics:
    """Owns the settings as last set; changes take the session's structure lock."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._settings = session.world.physics
        self._gravity = session.world.gravity

    @property
    def settings(self) -> Physics:
        """Step size, update rate and solver, as last set."""
        return self._settings

    @property
    def gravity(self) -> Vec3:
        """m/s^2, world axes."""
        return self._gravity

    def set(self, settings: Physics, gravity: Vec3) -> None:
        """Replace settings and gravity. Raises CommandError; then the old ones stay."""
        with self._session.structure_lock:
            self._session.call(self.command(settings, gravity))
            with self._session.registry_lock:
                self._settings, self._gravity = settings, gravity
                self._session.registry.revision += 1

    # -- for the other parts -----------------------------------------------------------------------

    def adopt_world(self) -> None:
        """Take over the settings of a world that has just been read."""
        self._settings, self._gravity = self._session.world.physics, self._session.world.gravity

    def command(self, settings: Optional[Physics] = None,
                gravity: Optional[Vec3] = None) -> SetPhysics:
        """The command that gives the engine these settings; None for those last set."""
        used = settings or self._settings
        return SetPhysics(PhysicsSettings(
            used.max_step_size, gravity or self._gravity, max(0.0, used.real_time_update_rate),
            max(1, used.ode.iters), used.ode.friction_model == "cone_model"))
