"""The physics settings and gravity of a running world."""
from __future__ import annotations

from dataclasses import replace
from typing import Optional

from ..description.world import Physics
from ..engine.commands import FOREVER, Batch, Pause, PhysicsSettings, SetPhysics
from ..engine.timed_forces import AddTimedForces
from ..geometry import Vec3
from .clock import SimClock
from .session import Session
from .wrenches import Wrenches


class WorldPhysics:
    """Owns the settings as last set; changes take the session's structure lock."""

    def __init__(self, session: Session, clock: SimClock, wrenches: Wrenches) -> None:
        self._session = session
        self._clock = clock
        self._wrenches = wrenches
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
        """Replace settings and gravity. Raises CommandError; then the old ones stay.

        Timed wrenches and efforts begin and end at the sim times at which they would have.
        """
        with self._session.structure_lock:
            command = self.command(settings, gravity)
            if settings.max_step_size == self._settings.max_step_size:
                self._session.call(command)
            else:
                self._change_step(command, self._settings.max_step_size / settings.max_step_size)
            with self._session.registry_lock:
                self._settings, self._gravity = settings, gravity
                self._session.registry.revision += 1

    def _change_step(self, command: SetPhysics, share: float) -> None:
        """Send the command; scale the pending times of forces by `share` new steps per old step."""
        now = self._session.call(Pause()).step
        forces = [replace(force, start=now + max(0, round((force.start - now) * share)),
                          stop=force.stop if force.stop == FOREVER
                          else now + max(1, round((force.stop - now) * share)))
                  for force in self._wrenches.pending(now)]
        try:
            self._session.call(Batch((command, AddTimedForces(tuple(forces)))))
            self._wrenches.replace_all(forces)
        finally:
            self._session.call(Batch(tuple(self._clock.resume_commands())))

    # -- for the other parts -----------------------------------------------------------------------

    def store_world(self) -> None:
        """Store the settings of the session's world, which the engine has already."""
        self._settings, self._gravity = self._session.world.physics, self._session.world.gravity

    def store(self, settings: Physics, gravity: Vec3) -> None:
        """Store settings that the engine has already."""
        self._settings, self._gravity = settings, gravity

    def command(self, settings: Optional[Physics] = None,
                gravity: Optional[Vec3] = None) -> SetPhysics:
        """The command that gives the engine these settings; None for those last set."""
        used = settings or self._settings
        return SetPhysics(PhysicsSettings(
            used.max_step_size, gravity or self._gravity, max(0.0, used.real_time_update_rate),
            max(1, used.ode.iters), used.ode.friction_model != "pyramid_model"))
