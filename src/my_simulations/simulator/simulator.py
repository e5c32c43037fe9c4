"""The world as the faces see it.

Reads come from the ring and never touch the engine; writes are commands that return once a
snapshot shows their effect. Safe from any thread.
"""
from __future__ import annotations

import threading
from dataclasses import replace
from typing import Callable, Dict, List, Optional, Tuple

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
from ..engine.ring import BELL, DEMAND_NS, JOINTS, LINKS, RingReader, Snapshot
from ..engine.rows import axis_rows
from ..errors import CommandError, Issue, Severity, error
from ..formats.meshes import without_missing_meshes
from ..geometry import (
    IDENTITY,
    STILL,
    Pose,
    Twist,
    Vec3,
    compose,
    normalised,
)
from .frames import in_frame, relative, usable
from .initial import initial_commands
from .layout import Layout, lay_out
from .registry import Entity, Registry, Rows
from .solids import ConvexParts
from .states import States, collect
from .supervisor import Supervisor


class Simulator:
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
        self.world = world
        self._world_meshes = meshes or {}
        self._log = log
        self._lock = threading.RLock()    # the registry and rows; never held while the engine works
        self._order = threading.RLock()   # one change of structure or clock at a time
        self._registry = Registry()
        self._link_rows = Rows(LINKS)
        self._joint_rows = Rows(JOINTS)
        self._next_id = 0
        self._loads: Dict[int, Load] = {}
        self._starts = dict(world.initial)
        self._physics = world.physics
        self._gravity = world.gravity
        self._paused = paused
        self._horizon = FOREVER
        self._cached: Optional[States] = None
        self._layout: Optional[Layout] = None
        self._demand = (0, False)
        self._solids = ConvexParts(log, lambda text: log(Issue(Severity.NOTE, "meshes", text)))
        self._supervisor = Supervisor(engine_factory, self._restore, log)

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
    def engine_pid(self) -> int:
        """Process number of the engine."""
        return self._supervisor.engine.pid

    @property
    def ring(self) -> RingReader:
        """Where the states are."""
        return self._supervisor.engine.ring

    # -- clock -----------------------------------------------------------------------------------

    def step(self) -> int:
        """Steps since the start or the last reset."""
        return self.ring.step

    def sim_ns(self) -> int:
        """Sim time, nanoseconds."""
        step, clock = self.ring.clock()
        return clock.sim_ns(step)

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

    # -- reads -----------------------------------------------------------------------------------

    def model_names(self) -> List[str]:
        """All top-level models in load order."""
        with self._lock:
            return self._registry.names()

    def has_model(self, name: str) -> bool:
        """Whether there is a model of that name."""
        with self._lock:
            return name in self._registry

    def model(self, name: str) -> Model:
        """The flattened description. Raises UnknownEntity."""
        with self._lock:
            return self._registry.model(name).model

    def model_state(self, name: str, frame: str = "") -> Tuple[Pose, Twist]:
        """Pose and twist of a model frame in `frame` (see `Registry.frame`).

        Raises UnknownEntity, UnknownFrame.
        """
        with self._lock:
            entity = self._registry.model(name)
            anchor = self._registry.frame(frame)
            if anchor is None and entity.link_names:
                pose, twist = self.ring.link(entity.canonical_row)
                if entity.link_from_model != IDENTITY:
                    pose = compose(pose, entity.link_from_model)
                return pose, twist
            snapshot = self._snapshot()
        return relative(entity.state(snapshot), anchor, snapshot)

    def link_state(self, name: str, frame: str = "") -> Tuple[Pose, Twist]:
        """Pose and twist of a link in `frame`. Raises UnknownEntity, UnknownFrame."""
        with self._lock:
            entity, index = self._registry.link(name)
            anchor = self._registry.frame(frame)
            row = entity.first_link_row + index
            if anchor is None:
                return self.ring.link(row)
            snapshot = self._snapshot()
        return relative(snapshot.link(row), anchor, snapshot)

    def joint_state(self, name: str) -> Tuple[float, float]:
        """Position and rate of a movable joint. Raises UnknownEntity."""
        with self._lock:
            row = self._registry.joint_row(name)
            return self._snapshot().joint(row)

    def moment(self) -> Tuple[List[Entity], Snapshot]:
        """Everything there is, in load order, and where it is, of one moment."""
        with self._lock:
            return self._registry.entities(), self._snapshot()

    def states(self) -> States:
        """The states of everything, for the topics; the same object while nothing changes."""
        with self._lock:
            cached = self._cached
            if (cached is not None and cached.revision == self._registry.revision
                    and cached.sequence == self.ring.latest):
                return cached
            self._cached = collect(self._registry.entities(), self._snapshot(),
                                   self._registry.revision)
            return self._cached

    def raw_states(self) -> Tuple[Layout, int, bytes]:
        """What `states` is made of: who is where, the snapshot's sequence, its link rows.

        The layout is the same object until a name changes; a row is `ring.LINK_WIDTH` doubles.
        """
        with self._lock:
            if self._layout is None or self._layout.revision != self._registry.revision:
                self._layout = lay_out(self._registry.entities(), self._registry.revision)
            return (self._layout, *self.ring.raw_links())

    def set_demand(self, hz: float, bell: bool) -> None:
        """Say how often states are wanted (0: no one waits) and whether to ring at each step."""
        self._demand = (int(1e9 / hz) if hz > 0.0 else 0, bell)
        words = self.ring.words
        words[DEMAND_NS], words[BELL] = self._demand[0], int(bell)

    def wait_step(self, after_step: int, timeout: float) -> bool:
        """Wait until the step count is not `after_step` any more, or something has changed."""
        if self.ring.step != after_step:
            return True
        return self._supervisor.engine.wait_bell(timeout)

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

    def _snapshot(self) -> Snapshot:
        found = self.ring.read()
        if found is None:
            raise CommandError("the physics engine has not started")
        return found

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
