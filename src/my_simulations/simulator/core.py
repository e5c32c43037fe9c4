"""A world in an engine: its models come and go, and it survives the engine's end."""
from __future__ import annotations

import threading
from dataclasses import replace as replaced
from typing import Callable, Dict, List, Optional, Tuple

from ..description.flatten import flattened
from ..description.model import Joint, Model
from ..description.shapes import MeshTable
from ..description.world import Physics, World
from ..engine.api import Engine, Event, Reply
from ..engine.commands import (
    FOREVER,
    AddLoads,
    Batch,
    Command,
    Hold,
    Load,
    LoadModel,
    ModelState,
    PhysicsSettings,
    Ping,
    RemoveModel,
    Run,
    SetClock,
    SetPhysics,
)
from ..engine.ring import JOINTS, LINKS, Snapshot
from ..engine.rows import axis_rows
from ..errors import CommandError, Issue, Severity, error, warning
from ..formats.meshes import without_missing_meshes
from ..geometry import Pose, Vec3, compose, normalised
from .connections import Connections, Departed
from .initial import initial_commands
from .order import Turn
from .registry import Entity, Rows
from .solids import ConvexParts
from .supervisor import Supervisor
from .views import WorldViews


class WorldCore(WorldViews):
    """The engine, what is loaded into it, and what a new engine must be told."""

    def __init__(self, world: World, *, engine_factory: Callable[[], Engine],
                 log: Callable[[Issue], None], paused: bool = False,
                 meshes: Optional[Dict[str, MeshTable]] = None, steps: int = FOREVER) -> None:
        """See `Simulator`."""
        super().__init__(Supervisor(engine_factory, self._restore, log))
        self.world = world
        self._registry.lights = lambda: self.world.lights
        self._registry.ambiguous = lambda text: log(warning("name-ambiguous", text))
        self._world_meshes = meshes or {}
        self._log = log
        self._order = threading.RLock()   # one change of structure or clock at a time
        self._link_rows = Rows(LINKS)
        self._joint_rows = Rows(JOINTS)
        self._next_id = 0
        self._loads: Dict[int, Load] = {}
        self._held: List[str] = []
        self._connections = Connections()
        self._starts = dict(world.initial)
        self._physics = world.physics
        self._gravity = world.gravity
        self._paused = paused
        self._lockstep = False
        self._steps = steps
        self._horizon = FOREVER
        self._solids = ConvexParts(log, lambda text: log(Issue(Severity.NOTE, "meshes", text)))

    # -- life ------------------------------------------------------------------------------------

    def start(self) -> None:
        """Set the physics, load every model, and run unless paused.

        Faults of single models go to the log; the rest is loaded. Raises CommandError when there
        is no engine.
        """
        self._fill()
        self._supervisor.engine.on_event(self._hear)
        if self._runs:
            self._call(Run(self._horizon))

    def _hear(self, event: Event) -> None:
        if event.kind == "diverged":
            self._log(error("state-diverged", event.message))
        elif event.kind == "log":
            self._log(warning("physics-approximate", event.message))

    def _fill(self) -> None:
        """Settings, clock and models of the world, into an empty engine."""
        self._call(SetPhysics(self._settings()))
        started = self.world.initial_ns
        step = round(started * 1e-9 / self._physics.max_step_size)
        self._horizon = FOREVER if self._steps == FOREVER else step + self._steps
        self._call(SetClock(step, started))
        self._connections = Connections(self.world.joints)
        for model in self.world.models:
            try:
                self.spawn(model, meshes=self._world_meshes.get(model.name))
            except CommandError as fault:
                self._log(error("model-refused", str(fault), file=self.world.file))
        self._connect()

    def _connect(self) -> None:
        """Join the models that have just been loaded."""
        self._connections, issues = self._connections.located(self._registry)
        for issue in issues:
            self._log(replaced(issue, file=self.world.file))
        for command in self._connections.commands(self._registry):
            try:
                self._call(command)
            except CommandError as fault:
                self._log(error("joint-refused", str(fault), file=self.world.file))
        self._connections = self._connections.present(self._registry)

    @property
    def joints_between_models(self) -> List[Joint]:
        """Those that hold now; their ends are scoped link names, or `world`."""
        return self._connections.joints

    @property
    def _runs(self) -> bool:
        """Whether time goes on by itself."""
        return not (self._paused or self._lockstep)

    def close(self) -> None:
        """End the engine."""
        self._supervisor.close()

    # -- models ----------------------------------------------------------------------------------

    def spawn(self, model: Model, pose: Optional[Pose] = None, frame: str = "",
              meshes: Optional[MeshTable] = None, replace: bool = False,
              state: Optional[ModelState] = None, back: Optional[Departed] = None) -> None:
        """Put a model into the world; returns when it is there.

        Args:
            model: with its name; nested models are flattened.
            pose: of the model frame in `frame`; None for the model's own.
            frame: reference frame of `pose`.
            meshes: its loaded collision meshes by `mesh_key`.
            replace: take the place of a model of that name, in one step.
            state: where its links and joints are, instead of at rest at `pose`.
            back: what `delete` answered: it comes back to its place, and is joined again.

        Raises:
            CommandError: empty or taken name, unknown frame, or the engine refused it.
        """
        if not model.name:
            raise CommandError("a model needs a name")
        model = flattened(model)
        meshes = self._solids.of(model, meshes or {})
        with self._order:
            ties = Connections() if back is None else back.ties
            connections = self._connections.joined(ties)
            with self._lock:
                old = self._old(model.name, replace)
                anchor = self._registry.frame(frame)
                at = model.pose if pose is None else pose
                at = Pose(at.position, normalised(at.orientation))
                if anchor is not None:
                    at = compose(anchor.state(self._snapshot())[0], at)
                entity = self._make(model, at, meshes, connections)
            try:
                self._call(Batch(tuple([
                    self._loading(entity, state),
                    *initial_commands(entity, self._starts.pop(model.name, None)),
                    *ties.commands(self._registry, model.name, entity),
                    *([] if old is None else [RemoveModel(old.model_id)])])))
            except CommandError:
                with self._lock:
                    self._free(entity)
                raise
            with self._lock:
                self._registry.add(entity, None if back is None else back.turn)
                if back is not None:
                    self._connections = connections.present(self._registry)
                if old is not None:
                    self._connections = self._connections.without(model.name)
                    self._free(old)

    def delete(self, name: str) -> Departed:
        """Take a model out; returns when it is gone, for its return. Raises UnknownEntity."""
        with self._order:
            with self._lock:
                entity = self._registry.model(name)
            self._call(RemoveModel(entity.model_id))
            with self._lock:
                departed = Departed(Turn.of(self._registry.names(), name),
                                    self._connections.of(name))
                self._registry.remove(name)
                self._connections = self._connections.without(name)
                self._free(entity)
                return departed

    def _old(self, name: str, may_replace: bool) -> Optional[Entity]:
        old = self._registry.model(name) if name in self._registry else None
        if old is not None and not may_replace:
            raise CommandError(f"there is a model '{name}' already")
        return old

    def _make(self, model: Model, pose: Pose, meshes: MeshTable,
              connections: Connections) -> Entity:
        """An entity with a number and rows of its own. Raises CommandError when there are none."""
        links, joints = len(model.links), len(axis_rows(model))
        first_link = self._link_rows.take(links)
        first_joint = self._joint_rows.take(joints)
        if first_link is None or first_joint is None:
            if first_link is not None:
                self._link_rows.give(first_link, links)
            raise CommandError(f"the world is full: {LINKS} links and {JOINTS} movable joints "
                               "are its limit")
        self._next_id += 1
        return Entity(self._next_id, model, pose, first_link, first_joint, meshes,
                      articulated=connections.slides(model.name))

    def _free(self, entity: Entity) -> None:
        """Its rows are for others now: what the engine forgets, is forgotten here too."""
        self._loads = {key: load for key, load in self._loads.items()
                       if not (entity.has_link_row if load.effort is None
                               else entity.has_joint_row)(load.row)}
        self._link_rows.give(entity.first_link_row, len(entity.link_names))
        self._joint_rows.give(entity.first_joint_row, len(entity.joint_names))

    @staticmethod
    def _loading(entity: Entity, state: Optional[ModelState] = None) -> LoadModel:
        model = without_missing_meshes(entity.model, entity.meshes)
        return LoadModel(entity.model_id, model, entity.initial_pose,
                         entity.first_link_row, entity.first_joint_row, entity.meshes, state,
                         articulated=entity.articulated)

    def look(self) -> Tuple[List[Entity], Snapshot]:
        """Everything there is and where it is now; `moment` may be older while a world rests.

        Raises CommandError when there is no engine.
        """
        self._call(Ping())
        return self.moment()

    # -- physics ---------------------------------------------------------------------------------

    @property
    def physics(self) -> Physics:
        """The settings as last set."""
        return self._physics

    @property
    def gravity(self) -> Vec3:
        """m/s^2, world axes."""
        return self._gravity

    def _settings(self, physics: Optional[Physics] = None,
                  gravity: Optional[Vec3] = None) -> PhysicsSettings:
        physics = physics or self._physics
        return PhysicsSettings(physics.max_step_size, gravity or self._gravity,
                               max(0.0, physics.real_time_update_rate), max(1, physics.ode.iters),
                               physics.ode.friction_model == "cone_model")

    def _holding(self) -> Hold:
        with self._lock:
            return Hold(tuple(self._registry.model(name).model_id
                              for name in self._held if name in self._registry))

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
        commands += self._connections.commands(self._registry)
        if self._held:
            commands.append(self._holding())
        pending = tuple(load for load in self._loads.values() if load.stop > snapshot.step)
        if pending:
            commands.append(AddLoads(pending))
        if self._runs:
            commands.append(Run(self._horizon))
        reply = submit(Batch(tuple(commands)))
        if reply.error:
            raise CommandError(reply.error)
