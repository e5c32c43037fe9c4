"""The world as the faces see it.

Reads come from the ring and never touch the engine; writes are commands that return once a
snapshot shows their effect. Safe from any thread.
"""
from __future__ import annotations

from dataclasses import replace
from typing import Dict, List, Optional

from ..description.shapes import MeshTable
from ..description.world import Physics, World
from ..engine.commands import (
    FOREVER,
    AddLoads,
    Advance,
    Batch,
    Clear,
    ClearLoads,
    Command,
    Pause,
    Restart,
    Run,
    SetClock,
    SetJoints,
    SetLinkState,
    SetModelState,
    SetPhysics,
)
from ..geometry import STILL, Pose, Twist, Vec3, compose
from .frames import in_frame, usable
from .initial import initial_commands
from .loads import TimedLoads
from .moments import Moment
from .registry import Entity


class Simulator(TimedLoads):
    """Owns the description, the clock and the engine.

    Args:
        world: what to load.
        engine_factory: makes the engine.
        paused: start paused.
        log: who hears of issues that no caller waits for.
        meshes: the collision meshes of the world's models, by model name.
        steps: after so many steps from the start time stands still.
    """

    # -- time ------------------------------------------------------------------------------------

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
            if self._runs:
                self._call(Run(self._horizon))

    def set_lockstep(self, lockstep: bool) -> None:
        """Let time go on only by `advance`, whether paused or not; or by itself again."""
        with self._order:
            self._lockstep = lockstep
            self._call(Run(self._horizon) if self._runs else Pause())

    def advance(self, steps: int) -> int:
        """Make exactly `steps` steps as fast as possible; returns the step count after them."""
        return self._call(Advance(steps)).step

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
        """Move a link (see `engine.commands.SetLinkState`). Raises CommandError."""
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

    # -- physics ---------------------------------------------------------------------------------

    def set_physics(self, physics: Physics, gravity: Vec3) -> None:
        """Replace the settings. Raises CommandError, then the old ones stay."""
        with self._order:
            self._call(SetPhysics(self._settings(physics, gravity)))
            with self._lock:
                self._physics, self._gravity = physics, gravity
                self._registry.revision += 1

    # -- reset -----------------------------------------------------------------------------------

    def reset_time(self) -> None:
        """Sim time 0; everything stays where it is, and timed loads go on as long as they had."""
        with self._order:
            now = self._call(Pause()).step
            # What is known here changes when the engine has done it: until then another engine,
            # which takes over from one that dies, must be told what was before.
            pending = [replace(load, start=max(0, load.start - now),
                               stop=load.stop if load.stop == FOREVER else load.stop - now)
                       for load in self._loads.values() if load.stop > now]
            commands: List[Command] = [SetClock(0, 0), AddLoads(tuple(pending))]
            if self._runs:
                commands.append(Run(self._horizon))
            self._call(Batch(tuple(commands)))
            self._loads = {load.load_id: load for load in pending}

    def reset_world(self) -> None:
        """Every model back to where it was loaded, at rest; joint positions and time stay."""
        with self._order:
            entities = self._registry.entities()
            self._call(Batch(tuple(
                SetModelState(entity.model_id, entity.initial_pose, STILL)
                for entity in entities if entity.link_names)))
            self._placed_as_loaded(entities)

    def reset_simulation(self) -> None:
        """Everything as loaded, joints too, time 0, loads dropped; spawned models stay."""
        with self._order:
            entities = self._registry.entities()
            commands: List[Command] = [
                Restart(tuple((entity.model_id, entity.initial_pose) for entity in entities)),
                SetClock(0, 0)]
            for entity in entities:
                commands += initial_commands(entity, self.world.initial.get(entity.model.name))
            commands += self._connections.commands(self._registry)
            if self._held:
                commands.append(self._holding())
            self._call(Batch(tuple(commands)))
            self._placed_as_loaded(entities)
            dropped, self._loads = self._loads, {}
            if dropped:  # an engine that has just taken over may have been told of them
                self._call(ClearLoads(tuple(dropped)))

    def _placed_as_loaded(self, entities: List[Entity]) -> None:
        """Models without links are where this says; the engine knows nothing of them."""
        with self._lock:
            for entity in entities:
                entity.pose = entity.initial_pose
            self._registry.revision += 1

    def put_back(self, moment: Moment, clock: bool = True) -> None:
        """Poses, velocities, joints and, with `clock`, the time; what has come since stays.

        Models that have gone or got other links meanwhile are passed over.
        """
        with self._order:
            with self._lock:
                commands = moment.commands(self._registry.entities())
                self._registry.revision += 1
            time = [SetClock(moment.step, moment.sim_ns)] if clock else []
            self._call(Batch((Pause(), *time, *commands,
                              *([Run(self._horizon)] if self._runs else []))))

    def load_world(self, world: World, meshes: Optional[Dict[str, MeshTable]] = None) -> None:
        """Replace everything by another world, as at a start; paused stays what it is.

        Faults of single models go to the log; the rest is loaded. Raises CommandError when there
        is no engine.
        """
        self._prepare(world, meshes or {}, gently=True)  # meanwhile the old one goes on
        with self._order:
            self._call(Batch((Pause(), Clear(), ClearLoads(tuple(self._loads)))))
            with self._lock:
                for entity in self._registry.entities():
                    self._registry.remove(entity.model.name)
                    self._free(entity)
            self._loads.clear()
            self._held = []
            # Once more: an engine that took over just now was told of the old models.
            self._call(Batch((Pause(), Clear())))
            self.world, self._world_meshes = world, meshes or {}
            self._starts = dict(world.initial)
            self._physics, self._gravity = world.physics, world.gravity
            self._begin()
            if self._runs:
                self._call(Run(self._horizon))
