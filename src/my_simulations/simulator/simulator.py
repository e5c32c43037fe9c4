"""A running world: its parts, how it starts and ends.

Reads come from snapshots and never wait for the engine; changes are commands that return once a
snapshot shows their effect. All parts are safe from any thread.
"""
from __future__ import annotations

import traceback
from typing import Callable, ContextManager, Dict, List, Optional, Tuple

from ..description.shapes import MeshTable
from ..description.world import World
from ..engine.api import Engine, Event, Reply
from ..engine.commands import FOREVER, Batch, Clear, Command, Pause, SetClock
from ..engine.timed_forces import AddTimedForces, ClearTimedForces
from ..errors import CommandError, Issue, Severity, error, warning
from .clock import SimClock
from .convex_meshes import ConvexParts
from .drives import Drives
from .exact_states import ExactStates
from .feeds import StateFeed
from .joints import Joints
from .lights import Lights
from .models import Models
from .physics import WorldPhysics
from .resets import Resets
from .scene import SceneSettings
from .session import Session
from .states import States
from .supervisor import Supervisor
from .sync_points import SyncPoints
from .wrenches import Wrenches


class Simulator:
    """The world as front ends see it.

    Attributes:
        models: spawn, delete, edit, pin; descriptions by name.
        joints: find, read, set and edit joints.
        states: poses, twists and contacts; capture and restore.
        exact_states: save and restore the world so that runs repeat bit for bit.
        drives: motors of joints, planar velocities of models.
        sync_points: exact steps for plugins and sensors.
        wrenches: timed wrenches on links, timed efforts and PID controllers on joints.
        lights: the lights.
        scene: scene, camera, wind, atmosphere, place on Earth.
        physics: step size, solver and gravity.
        clock: sim time, pausing, stepping.
        resets: time, model poses, everything.
        feed: rows of states for topics and pages.

    Args:
        world: the description to load.
        engine_factory: creates the engine.
        paused: start paused.
        log: receives issues that no caller waits for.
        meshes: the collision meshes of the world's models, by model name.
        steps: pause after this many steps from the start.
    """

    def __init__(self, world: World, *, engine_factory: Callable[[], Engine],
                 log: Callable[[Issue], None], paused: bool = False,
                 meshes: Optional[Dict[str, MeshTable]] = None, steps: int = FOREVER) -> None:
        log = _guard_log(log)
        supervisor = Supervisor(engine_factory, self._restore, log)
        self._session = session = Session(world, supervisor, log)
        self._world_meshes = meshes or {}
        self.clock = SimClock(session, paused, steps)
        self.wrenches = Wrenches(session)
        self.physics = WorldPhysics(session, self.clock, self.wrenches)
        self.drives = Drives(session)
        self.sync_points = SyncPoints(session)
        self.models = Models(session, self.wrenches, self.drives, ConvexParts(
            log, lambda text: log(Issue(Severity.NOTE, "meshes", text))))
        self.joints = Joints(session, self.models)
        self.states = States(session, self.clock, self.wrenches)
        self.exact_states = ExactStates(session, self.models, self.states, self.drives,
                                        self.wrenches, self.clock, self.physics)
        self.lights = Lights(session)
        self.scene = SceneSettings(session)
        self.resets = Resets(session, self.models, self.wrenches, self.drives, self.clock)
        self.feed = StateFeed(session)

    @property
    def is_over(self) -> bool:
        """Whether it was closed, or has lost its engine for good."""
        return self._session.supervisor.is_over

    @property
    def world(self) -> World:
        """The description: models as loaded; lights, scene and the like as last set."""
        return self._session.world

    @property
    def change_lock(self) -> ContextManager[bool]:
        """The lock of all changes, for a read and a change that depends on it.

        Plugins must not hold it: the thread that removes a model waits for the model's plugins.
        """
        return self._session.structure_lock

    @property
    def engine_pid(self) -> int:
        return self._session.supervisor.engine.pid

    def report(self, issue: Issue) -> None:
        """Report an issue to the receivers of the simulator's own issues, from any thread."""
        self._session.log(issue)

    def start(self) -> None:
        """Set the physics, load all models, and run unless paused.

        Models that cannot be loaded are logged and skipped. Raises CommandError if no engine
        starts.
        """
        self._session.call(Batch(self._settings_of(self.world)))
        with self.clock.stopped_while_loading():
            self._fill()
        self._session.supervisor.engine.on_event(self._on_event)
        for command in self.clock.resume_commands():
            self._session.call(command)

    def close(self) -> None:
        self._session.supervisor.close()

    def load_world(self, world: World, meshes: Optional[Dict[str, MeshTable]] = None) -> None:
        """Replace the world by another one, as at a start; a paused simulator stays paused.

        Models that cannot be loaded are logged and skipped. Raises CommandError if no engine
        starts.
        """
        session = self._session
        self.models.divide_meshes(world, meshes or {}, gently=True)  # the old world runs meanwhile
        with session.structure_lock:
            with self.clock.stopped_while_loading():
                restarts = session.supervisor.restarts
                # The settings come first: the old world stays if the engine refuses them.
                session.call(Batch((*self._settings_of(world), Pause(), Clear(),
                                    ClearTimedForces(self.wrenches.ids))))
                self.models.forget_all()
                self.wrenches.replace_all()
                self.drives.replace_all()
                if session.supervisor.restarts != restarts:  # the new one has the old models
                    session.call(Batch((*self._settings_of(world), Pause(), Clear())))
                session.world, self._world_meshes = world, meshes or {}
                self.physics.store_world()
                self._fill()
            for command in self.clock.resume_commands():
                session.call(command)

    def _settings_of(self, world: World) -> Tuple[Command, ...]:
        """Commands that set the physics and the clock of a world."""
        return (self.physics.command(world.physics, world.gravity),
                self.clock.start_command(world.initial_ns, world.physics.max_step_size))

    def _fill(self) -> None:
        """Load the models of the world into an empty engine that has its settings."""
        self.clock.begin(self.world.initial_ns, self.world.physics.max_step_size)
        self.models.load_all(self._world_meshes)

    def _on_event(self, event: Event) -> None:
        if event.kind == "refused":
            self._session.log(error("command-refused", event.message))
        elif event.kind == "diverged":
            self._session.log(error("state-diverged", event.message))
        elif event.kind == "log":
            self._session.log(warning("physics-approximate", event.message))

    def _restore(self, submit: Callable[[Command], Reply], paused: bool) -> None:
        """Give a new engine the world of the last whole snapshot (see `Supervisor`)."""
        snapshot = self._session.snapshot()
        _, clock = self.clock.now()
        if paused:
            self.clock.pause_after_recovery()
        commands: List[Command] = [self.physics.command(),
                                   SetClock(snapshot.step, clock.sim_ns(snapshot.step)),
                                   *self.models.restore_commands(snapshot),
                                   *self.drives.settings.commands()]
        pending = self.wrenches.pending(snapshot.step)
        if pending:
            commands.append(AddTimedForces(pending))
        reply = submit(Batch((*commands, *self.clock.resume_commands())))
        if reply.error:
            raise CommandError(reply.error)


def _guard_log(log: Callable[[Issue], None]) -> Callable[[Issue], None]:
    """A log whose faults do not end the thread that reports, such as that which restarts engines.

    They may be no `Exception`, such as those of pytest.fail.
    """
    def guarded(issue: Issue) -> None:
        try:
            log(issue)
        except (KeyboardInterrupt, SystemExit):
            raise
        except BaseException:
            traceback.print_exc()

    return guarded
