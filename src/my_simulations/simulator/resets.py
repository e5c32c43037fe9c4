"""The three resets of Gazebo's services: time, model poses, everything."""
from __future__ import annotations

from typing import List

from ..engine.commands import (
    Batch,
    Command,
    Pause,
    Restart,
    SetClock,
    SetModelState,
    Synchronize,
)
from ..engine.timed_forces import AddTimedForces, ClearTimedForces
from ..errors import CommandError
from ..geometry import STILL
from .clock import SimClock
from .drives import Drives
from .entity import Entity
from .models import Models
from .session import Session
from .world_state import initial_commands
from .wrenches import Wrenches


class Resets:
    """Resets of a running world; each holds the session's structure lock."""

    def __init__(self, session: Session, models: Models, wrenches: Wrenches, drives: Drives,
                 clock: SimClock) -> None:
        self._session = session
        self._models = models
        self._wrenches = wrenches
        self._drives = drives
        self._clock = clock
        self.world_resets = 0        # counts resets of model poses
        self.simulation_resets = 0   # counted before the clock is set

    def reset_time(self) -> None:
        """Set sim time to 0. Models stay; timed wrenches last as long as they would have."""
        with self._session.structure_lock:
            now = self._session.call(Pause()).step
            # Our own data changes after the engine has applied the reset: an engine that is
            # restarted before that must get the old data.
            pending = self._wrenches.shift_pending(now, 0)
            self._session.call(Batch((SetClock(0, 0), AddTimedForces(tuple(pending)),
                                      *self._clock.resume_commands())))
            self._wrenches.replace_all(pending)

    def reset_world(self) -> None:
        """Move every model to where it was loaded, at rest; joint positions and time stay."""
        session = self._session
        with session.structure_lock:
            entities = session.registry.entities()
            session.call(Batch((*self._models.connections.detach_commands(), *(
                SetModelState(entity.model_id, entity.initial_pose, STILL)
                for entity in entities if entity.link_names), Synchronize())))
            self._models.store_connections(self._models.connections.detached())
            self._move_linkless_models(entities)
            self.world_resets += 1

    def reset_simulation(self, to_start: bool = False) -> None:
        """Reset models and joints to their loaded state, time to 0; clear timed wrenches.

        Spawned models are kept. The run that follows repeats that after the start bit for bit.

        Args:
            to_start: set the time at which the world began (of its <state>), instead of 0 as in
                Gazebo.
        """
        session = self._session
        with session.structure_lock:
            entities = session.registry.entities()
            clock = SetClock(0, 0) if not to_start else self._clock.start_command(
                session.world.initial_ns, self._clock.now()[1].step_ps * 1e-12)
            commands: List[Command] = [
                *self._models.connections.detach_commands(),
                Restart(tuple((entity.model_id, entity.initial_pose) for entity in entities)),
                clock]
            for entity in entities:
                commands += initial_commands(entity, entity.start)
            commands += self._models.connections.detached().commands(session.registry)
            self.simulation_resets += 1
            restarts = session.supervisor.restarts
            try:
                session.call(Batch(tuple(commands)))
            except CommandError:
                self.simulation_resets -= 1
                raise
            self._models.store_connections(self._models.connections.detached())
            self._move_linkless_models(entities)
            dropped = self._wrenches.ids
            self._wrenches.replace_all()
            self._drives.replace_all()
            if session.supervisor.restarts != restarts:  # the new engine may have received them
                session.call(ClearTimedForces(dropped))

    def _move_linkless_models(self, entities: List[Entity]) -> None:
        """Reset the poses of models without links, which the engine does not have."""
        with self._session.registry_lock:
            for entity in entities:
                entity.pose = entity.initial_pose
            self._session.registry.revision += 1
