"""States of the whole world from which runs repeat bit for bit."""
from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from typing import Any, Dict, List, Sequence, Tuple

from ..description.world import Physics
from ..engine.commands import Batch, Clear, Command, ModelState, Pause, Restart, SetClock
from ..engine.run_state import ReadRunState, RunState, SetRunState
from ..engine.timed_forces import AddTimedForces, TimedForce
from ..geometry import Vec3
from .clock import SimClock
from .drives import Drives, DriveSettings
from .entity import Entity
from .model_connections import ModelConnections
from .models import Models, load_command
from .physics import WorldPhysics
from .registry import Registry
from .session import Session
from .states import States
from .wrenches import Wrenches


@dataclass(frozen=True)
class ExactState:
    """The world at one time. It can be pickled, and restored in another process.

    Attributes:
        step, sim_ns: the clock.
        physics, gravity: the settings; m/s^2, world axes.
        entities: copies of all models, in order.
        states: of the links and joints of each model.
        connections: joints between models, and pins.
        drives: motors, servos, planar velocities and wheel slips.
        forces: timed wrenches and efforts that act, or will.
        run: what the engine has learned from earlier steps.
    """

    step: int
    sim_ns: int
    physics: Physics
    gravity: Vec3
    entities: Tuple[Entity, ...]
    states: Tuple[ModelState, ...]
    connections: ModelConnections
    drives: DriveSettings
    forces: Tuple[TimedForce, ...]
    run: RunState


class ExactStates:
    """Saves and restores the world so that what follows both is equal, bit for bit.

    The impulses from which the contact solver starts cannot be given to PyBullet. So both methods
    build the world again from the state, and the solver starts without them in both cases.
    """

    def __init__(self, session: Session, models: Models, states: States, drives: Drives,
                 wrenches: Wrenches, clock: SimClock, physics: WorldPhysics) -> None:
        self._session = session
        self._models = models
        self._states = states
        self._drives = drives
        self._wrenches = wrenches
        self._clock = clock
        self._physics = physics

    def save(self) -> ExactState:
        """Return the present state, and build the world again from it. Raises CommandError."""
        session = self._session
        with session.structure_lock:
            session.call(Pause())
            run: Any = session.call(ReadRunState()).value
            entities, snapshot = self._states.latest()
            step, clock = self._clock.now()
            state = ExactState(
                step, clock.sim_ns(step), self._physics.settings, self._physics.gravity,
                tuple(map(copy, entities)), tuple(entity.saved(snapshot) for entity in entities),
                self._models.connections, self._drives.settings, self._wrenches.pending(step), run)
            self.restore(state)
            return state

    def restore(self, state: ExactState) -> None:
        """Build the world of a state, with its time, models, drives and forces.

        Models that were added since are removed, removed ones come back. Lights, scene and wind
        stay. Raises CommandError.
        """
        session = self._session
        if any(entity.has_plugins for entity in state.entities):
            session.before_plugins()
        with session.structure_lock:
            session.await_posted()
            entities = list(map(copy, state.entities))
            session.call(Batch((
                Pause(), *self._load_commands(state), SetClock(state.step, state.sim_ns),
                *state.connections.commands(_registry_of(entities)), *state.drives.commands(),
                AddTimedForces(state.forces), SetRunState(state.run),
                *self._clock.resume_commands())))
            self._store(state, entities)

    def _load_commands(self, state: ExactState) -> List[Command]:
        """Commands that load the models; most often the engine has them all, which is faster."""
        settings: List[Command] = []
        if (state.physics, state.gravity) != (self._physics.settings, self._physics.gravity):
            settings.append(self._physics.command(state.physics, state.gravity))
        present = {entity.model_id: entity for entity in self._session.entities()}
        if all(_is_loaded(entity, present) for entity in state.entities):
            return [*settings, Restart(tuple((entity.model_id, entity.initial_pose)
                                  for entity in state.entities), state.states)]
        return [*settings, Clear(), *(load_command(entity, one)
                           for entity, one in zip(state.entities, state.states))]

    def _store(self, state: ExactState, entities: Sequence[Entity]) -> None:
        """Store the state that the engine has now."""
        session = self._session
        with session.registry_lock:
            if _differ(session.registry.entities(), entities):
                session.replace_entities(entities)
            session.reserve_ids([entity.model_id for entity in entities]
                                + [force.force_id for force in state.forces])
        self._models.store_connections(state.connections)
        self._drives.replace_all(state.drives)
        self._wrenches.replace_all(state.forces)
        self._physics.store(state.physics, state.gravity)


def _registry_of(entities: Sequence[Entity]) -> Registry:
    registry = Registry()
    registry.replace_all(entities)
    return registry


def _is_loaded(entity: Entity, present: Dict[int, Entity]) -> bool:
    """Whether the engine has a model, with the same rows."""
    found = present.get(entity.model_id)
    return (found is not None and found.first_link_row == entity.first_link_row
            and found.first_joint_row == entity.first_joint_row
            and found.articulated == entity.articulated
            and found.meshes.keys() == entity.meshes.keys()
            and (found.model is entity.model or found.model == entity.model))


def _differ(present: Sequence[Entity], wanted: Sequence[Entity]) -> bool:
    """Whether the models, their order or the poses of those without links differ."""
    return len(present) != len(wanted) or any(
        one.model_id != other.model_id or one.pose != other.pose
        or one.model is not other.model for one, other in zip(present, wanted))
