"""The world as the faces see it.

Reads come from the ring and never touch the engine; writes are commands that return once a
snapshot shows their effect. Safe from any thread.
"""
from __future__ import annotations

import threading
from dataclasses import replace
from typing import Callable, Dict, List, Optional

from ..description.flatten import flattened
from ..description.model import Model
from ..description.shapes import MeshTable
from ..description.world import Physics, World
from ..engine.api import (
    FOREVER,
    AddLoads,
    Advance,
    Batch,
    Clear,
    ClearLoads,
    Command,
    Engine,
    Load,
    LoadModel,
    ModelState,
    Pause,
    PhysicsSettings,
    RemoveModel,
    Reply,
    Run,
    SetClock,
    SetJoints,
    SetLinkState,
    SetModelState,
    SetPhysics,
)
from ..engine.ring import JOINTS, LINKS
from ..engine.rows import axis_rows
from ..errors import CommandError, Issue, Severity, error
from ..formats.meshes import without_missing_meshes
from ..geometry import (
    STILL,
    Pose,
    Twist,
    Vec3,
    compose,
    normalised,
)
from .frames import in_frame, usable
from .initial import initial_commands
from .registry import Entity, Rows
from .solids import ConvexParts
from .supervisor import Supervisor
from .views import WorldViews


class Simulator(WorldViews):
    """Owns the description, the clock and the engine.

    Args:
        world: what to load.
        engine_factory: makes the engine.
        paused: start paused.
        log: who hears of issues that no caller waits for.
        meshes: the collision meshes of the world's models, by model name.
    """

    def __init__(self, world: World, *, engine_factory: Callable[[], Engine],
                 log: Callable[[Issue], None], paused: bool = False,
                 meshes: Optional[Dict[str, MeshTable]] = None) -> None:
        super().__init__(Supervisor(engine_factory, self._restore, log))
        self.world = world
        self._world_meshes = meshes or {}
        self._log = log
        self._order = threading.RLock()   # one change of structure or clock at a time
        self._link_rows = Rows(LINKS)
        self._joint_rows = Rows(JOINTS)
        self._next_id = 0
        self._loads: Dict[int, Load] = {}
        self._starts = dict(world.initial)
        self._physics = world.physics
        self._gravity = world.gravity
        self._paused = paused
        self._horizon = FOREVER
        self._solids = ConvexParts(log, lambda text: log(Issue(Severity.NOTE, "meshes", text)))

    # -- life ------------------------------------------------------------------------------------

    def start(self) -> None:
        """Set the physics, load every model, and run unless paused.

        Faults of single models go to the log; the rest is loaded. Raises CommandError when there
        is no engine.
        """
        self._call(SetPhysics(self._settings()))
        started = self.world.initial_ns
        self._call(SetClock(round(started * 1e-9 / self._physics.max_step_size), started))
        for model in self.world.models:
            try:
                self.spawn(model, meshes=self._world_meshes.get(model.name))
            except CommandError as fault:
                self._log(error("model-refused", str(fault), file=self.world.file))
        self._supervisor.engine.on_event(lambda event: self._log(
            error("state-diverged", event.message)) if event.kind == "diverged" else None)
        if not self._paused:
            self._call(Run(self._horizon))

    def close(self) -> None:
        """End the engine."""
        self._supervisor.close()

    @property
    def paused(self) -> bool:
        """True when time stands still on request."""
        return self._paused

    def pause(self) -> None:
        """Stop after the running step."""
        with self._order:
            self._paused = True
            self._call(Pause())

    def unpause(self) -> None:
        """Go on."""
        with self._order:
            self._paused = False
            self._call(Run(self._horizon))

    def advance(self, steps: int) -> int:
        """Make exactly `steps` steps as fast as possible; returns the step count after them."""
        return self._call(Advance(steps)).step

    # -- models ----------------------------------------------------------------------------------

    def spawn(self, model: Model, pose: Optional[Pose] = None, frame: str = "",
              meshes: Optional[MeshTable] = None, replace: bool = False) -> None:
        """Put a model into the world; returns when it is there.

        Args:
            model: with its name; nested models are flattened.
            pose: of the model frame in `frame`; None for the model's own.
            frame: reference frame of `pose`.
            meshes: its loaded collision meshes by `mesh_key`.
            replace: take the place of a model of that name, in one step.

        Raises:
            CommandError: empty or taken name, unknown frame, or the engine refused it.
        """
        if not model.name:
            raise CommandError("a model needs a name")
        model = flattened(model)
        meshes = self._solids.of(model, meshes or {})
        with self._order:
            with self._lock:
                old = self._old(model.name, replace)
                anchor = self._registry.frame(frame)
                at = model.pose if pose is None else pose
                at = Pose(at.position, normalised(at.orientation))
                if anchor is not None:
                    at = compose(anchor.state(self._snapshot())[0], at)
                entity = self._make(model, at, meshes)
            try:
                self._call(Batch(tuple([
                    self._loading(entity),
                    *initial_commands(entity, self._starts.pop(model.name, None)),
                    *([] if old is None else [RemoveModel(old.model_id)])])))
            except CommandError:
                with self._lock:
                    self._free(entity)
                raise
            with self._lock:
                self._registry.add(entity)
                if old is not None:
                    self._free(old)

    def delete(self, name: str) -> None:
        """Take a model out; returns when it is gone. Raises UnknownEntity."""
        with self._order:
            with self._lock:
                entity = self._registry.model(name)
            self._call(RemoveModel(entity.model_id))
            with self._lock:
                self._registry.remove(name)
                self._free(entity)

    def _old(self, name: str, may_replace: bool) -> Optional[Entity]:
        old = self._registry.model(name) if name in self._registry else None
        if old is not None and not may_replace:
            raise CommandError(f"there is a model '{name}' already")
        return old

    def _make(self, model: Model, pose: Pose, meshes: MeshTable) -> Entity:
        links, joints = len(model.links), len(axis_rows(model))
        first_link = self._link_rows.take(links)
        first_joint = self._joint_rows.take(joints)
        if first_link is None or first_joint is None:
            if first_link is not None:
                self._link_rows.give(first_link, links)
            raise CommandError(f"the world is full: {LINKS} links and {JOINTS} movable joints "
                               "are its limit")
        self._next_id += 1
        return Entity(self._next_id, model, pose, first_link, first_joint, meshes)

    def _free(self, entity: Entity) -> None:
        self._link_rows.give(entity.first_link_row, len(entity.link_names))
        self._joint_rows.give(entity.first_joint_row, len(entity.joint_names))

    @staticmethod
    def _loading(entity: Entity, state: Optional[ModelState] = None) -> LoadModel:
        model = without_missing_meshes(entity.model, entity.meshes)
        return LoadModel(entity.model_id, model, entity.initial_pose,
                         entity.first_link_row, entity.first_joint_row, entity.meshes, state)

    # -- states ----------------------------------------------------------------------------------

    def set_model_state(self, name: str, pose: Pose, twist: Twist, frame: str = "") -> None:
        """Move a model; all its links get the rigid body's velocity. Raises CommandError."""
        pose = usable(pose, twist)
        with self._lock:
            entity = self._registry.model(name)
            anchor = self._registry.frame(frame)
            if not entity.link_names:
                if anchor is not None:
                    pose = compose(anchor.state(self._snapshot())[0], pose)
                entity.pose = pose
                self._registry.revision += 1
                return
        pose, twist, reference = in_frame(pose, twist, anchor)
        self._call(SetModelState(entity.model_id, pose, twist, reference))

    def set_link_state(self, name: str, pose: Pose, twist: Twist, frame: str = "") -> None:
        """Move a link (see `engine.api.SetLinkState`). Raises CommandError."""
        pose = usable(pose, twist)
        with self._lock:
            entity, index = self._registry.link(name)
            anchor = self._registry.frame(frame)
        pose, twist, reference = in_frame(pose, twist, anchor)
        self._call(SetLinkState(entity.first_link_row + index, pose, twist, reference))

    def set_joints(self, positions: Dict[str, float]) -> None:
        """Put movable joints (plain or scoped names) at positions, at rest."""
        with self._lock:
            rows = tuple((self._registry.joint_row(name), value, 0.0)
                         for name, value in positions.items())
        self._call(SetJoints(rows))

    # -- loads -----------------------------------------------------------------------------------

    def add_loads(self, loads: List[Load]) -> List[int]:
        """Queue timed loads; returns their ids. `load_id` of the arguments is replaced."""
        with self._order:
            numbered = []
            for load in loads:
                self._next_id += 1
                numbered.append(replace(load, load_id=self._next_id))
            self._call(AddLoads(tuple(numbered)))
            self._loads.update({load.load_id: load for load in numbered})
            return [load.load_id for load in numbered]

    def clear_loads(self, load_ids: List[int]) -> None:
        """Drop loads; unknown ids have run out."""
        with self._order:
            for load_id in load_ids:
                self._loads.pop(load_id, None)
            self._call(ClearLoads(tuple(load_ids)))

    # -- physics ---------------------------------------------------------------------------------

    @property
    def physics(self) -> Physics:
        """The settings as last set."""
        return self._physics

    @property
    def gravity(self) -> Vec3:
        """m/s^2, world axes."""
        return self._gravity

    def set_physics(self, physics: Physics, gravity: Vec3) -> None:
        """Replace the settings. Raises CommandError, then the old ones stay."""
        with self._order:
            self._call(SetPhysics(self._settings(physics, gravity)))
            self._physics, self._gravity = physics, gravity

    def _settings(self, physics: Optional[Physics] = None,
                  gravity: Optional[Vec3] = None) -> PhysicsSettings:
        physics = physics or self._physics
        return PhysicsSettings(physics.max_step_size, gravity or self._gravity,
                               max(0.0, physics.real_time_update_rate), max(1, physics.ode.iters))

    # -- reset -----------------------------------------------------------------------------------

    def reset_world(self) -> None:
        """Every model back to where it was loaded, at rest; joint positions and time stay."""
        with self._order:
            entities = self._registry.entities()
            for entity in entities:
                entity.pose = entity.initial_pose
            self._registry.revision += 1
            self._call(Batch(tuple(
                SetModelState(entity.model_id, entity.initial_pose, STILL)
                for entity in entities if entity.link_names)))

    def reset_simulation(self) -> None:
        """Everything as loaded, joints too, time 0, loads dropped; spawned models stay."""
        with self._order:
            commands: List[Command] = [Clear(), SetClock(0, 0)]
            for entity in self._registry.entities():
                entity.pose = entity.initial_pose
                commands.append(self._loading(entity))
                commands += initial_commands(entity, self.world.initial.get(entity.model.name))
            self._loads.clear()
            self._registry.revision += 1
            self._call(Batch(tuple(commands)))

    # -- engine ----------------------------------------------------------------------------------

    def _call(self, command: Command) -> Reply:
        return self._supervisor.call(command)

    def _restore(self, submit: Callable[[Command], Reply], paused: bool) -> None:
        """After a death: the world as in the last whole snapshot."""
        snapshot = self._snapshot()
        step, clock = self.ring.clock()
        self._paused = self._paused or paused
        entities = self._registry.entities()
        commands: List[Command] = [SetPhysics(self._settings()),
                                   SetClock(snapshot.step, clock.sim_ns(snapshot.step))]
        commands += [self._loading(entity, entity.saved(snapshot)) for entity in entities]
        pending = tuple(load for load in self._loads.values() if load.stop > snapshot.step)
        if pending:
            commands.append(AddLoads(pending))
        if not self._paused:
            commands.append(Run(self._horizon))
        reply = submit(Batch(tuple(commands)))
        if reply.error:
            raise CommandError(reply.error)
