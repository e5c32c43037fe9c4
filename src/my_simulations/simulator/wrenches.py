"""Timed wrenches on links and efforts on joint axes, given in sim time and exact to the step."""
from __future__ import annotations

from dataclasses import astuple, replace
from typing import Dict, List, Optional, Sequence, Tuple, Union

from ..engine.commands import FOREVER, Batch, Command
from ..engine.ring import Clock
from ..engine.timed_forces import (
    AddTimedForces,
    ClearTimedForces,
    JointPid,
    TimedEffort,
    TimedForce,
    TimedWrench,
)
from ..engine.wrench_laws import WrenchLaw
from ..errors import CommandError
from ..geometry import ZERO3, Vec3, compose, inverse, is_finite, rotate, subtract, transform
from .entity import Entity
from .session import Session

NANOSECOND_PS = 1000

Effort = Union[float, JointPid]
"""N m or N, or the PID controller that computes it in every step."""


class Wrenches:
    """Owns timed wrenches, efforts and PID controllers. Changes take the structure lock.

    Wrenches on one link add up, and so do efforts on one joint axis (Gazebo behaviour).
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._forces: Dict[int, TimedForce] = {}

    def apply_wrench(self, link: str, force: Vec3, torque: Vec3, *, frame: str = "",
                     point: Vec3 = ZERO3, start_ns: int = 0, duration_ns: int = -1) -> None:
        """Apply a wrench to a link for a time.

        Args:
            link: plain or scoped name.
            force: N, along the axes of `frame`.
            torque: N m, likewise.
            frame: "" or another name of the world: the axes stay the world's and the force is
                applied at the centre of mass. A model or link: the wrench is given in that frame
                as it is now, is applied at its origin, and from then on turns with the link.
            point: m, added to the point of application, along the same axes.
            start_ns: sim time from which it acts; a past one means from the next step on.
            duration_ns: rounded to steps, at least one; 0 does nothing, negative means until it
                is cleared.

        Raises:
            UnknownEntityError, UnknownFrameError: no such link or frame.
            CommandError: force, torque or point is not finite.
        """
        if not is_finite(*force, *torque, *point):
            raise CommandError(f"the wrench for link '{link}' contains NaN or infinity")
        session = self._session
        session.await_posted()
        with session.structure_lock:
            with session.registry_lock:
                entity, index = session.registry.link(link)
                row = entity.first_link_row + index
                anchor = session.registry.frame(frame)
                if anchor is not None:
                    snapshot = session.snapshot()
                    here = compose(inverse(snapshot.link(row)[0]), anchor.state(snapshot)[0])
                    com = entity.model.links[index].inertial.pose.position
                    point = subtract(transform(here, point), com)
                    force = rotate(here.orientation, force)
                    torque = rotate(here.orientation, torque)
            if duration_ns:
                self.add([TimedWrench(0, row, *self._span(start_ns, duration_ns), force, torque,
                                      in_link_axes=anchor is not None, point=point)], whole=True)

    def apply_effort(self, joint: str, effort: Effort, *, start_ns: int = 0,
                     duration_ns: int = -1) -> None:
        """Apply an effort to a joint axis for a time; see `apply_wrench` for the times.

        Raises:
            UnknownEntityError: no such joint.
            CommandError: the joint has no axis, or a number is not finite.
        """
        if not is_finite(*(astuple(effort) if isinstance(effort, JointPid) else (effort,))):
            raise CommandError(f"the effort on joint '{joint}' contains NaN or infinity")
        with self._session.structure_lock:
            row = self._session.axis_row(joint)
            if duration_ns:
                pid = effort if isinstance(effort, JointPid) else None
                self.add([TimedEffort(0, row, *self._span(start_ns, duration_ns),
                                      0.0 if isinstance(effort, JointPid) else effort, pid)],
                         whole=True)

    def efforts_on(self, joint: str) -> Tuple[Effort, ...]:
        """Efforts and controllers on an axis that act until cleared; raises as `apply_effort`."""
        row = self._session.axis_row(joint)
        return tuple(force.effort if force.pid is None else force.pid
                     for force in list(self._forces.values())
                     if isinstance(force, TimedEffort) and force.row == row
                     and force.stop == FOREVER)

    def effort_sum(self, joint: str) -> float:
        """The sum of the efforts on an axis in the next step, N m or N, without controllers.

        Raises CommandError like `apply_effort`.
        """
        with self._session.structure_lock:
            row, now = self._session.axis_row(joint), self._session.ring.step
            return sum(force.effort for force in self._forces.values()
                       if isinstance(force, TimedEffort) and force.row == row
                       and force.pid is None and force.start <= now < force.stop)

    def clear_wrenches(self, link: str) -> None:
        """Clear every wrench on a link, except those by a law. Raises UnknownEntityError."""
        with self._session.structure_lock:
            self._clear_row(TimedWrench, self._session.link_row(link))

    def clear_efforts(self, joint: str) -> None:
        """Clear every effort on a joint axis. Raises CommandError like `apply_effort`."""
        with self._session.structure_lock:
            self._clear_row(TimedEffort, self._session.axis_row(joint))

    def add(self, forces: Sequence[TimedForce], whole: bool = False) -> List[int]:
        """Queue wrenches and efforts by row; returns their new ids.

        Args:
            forces: their `force_id` is replaced.
            whole: an entry whose start has passed begins with the next step and keeps its duration.
        """
        with self._session.structure_lock:
            numbered = [replace(force, force_id=self._session.new_id()) for force in forces]
            now = self._session.call(AddTimedForces(tuple(numbered), whole)).step
            self._forces = {key: force for key, force in self._forces.items() if force.stop > now}
            self._forces.update({force.force_id: force.begun(now) if whole else force
                                 for force in numbered})
            return [force.force_id for force in numbered]

    def remove(self, force_ids: Sequence[int]) -> None:
        """Clear by id; ids that have expired are ignored."""
        with self._session.structure_lock:
            for force_id in force_ids:
                self._forces.pop(force_id, None)
            self._session.call(ClearTimedForces(tuple(force_ids)))

    def swap(self, old: Sequence[int],
             wrenches: Sequence[Tuple[str, Vec3, Vec3, Optional[WrenchLaw], str]],
             revision: Optional[int] = None) -> Optional[List[int]]:
        """Clear some by id, and add others until they are cleared, between the same two steps.

        Args:
            old: ids; unknown ones have run out.
            wrenches: scoped name of a link, force (N) and torque (N m) in world axes at the centre
                of mass, or the law by which the engine computes both; scoped name of the joint that
                the law follows, or "". Zero ones, and those on a missing link, are left out.
            revision: of the models when they were worked out (`Models.revision`).

        Returns:
            An id for each wrench, 0 for one that is left out; None when the models have changed
            since; then nothing is done.
        """
        session = self._session
        with session.structure_lock:
            if revision is not None and revision != session.registry.revision:
                return None
            ids: List[int] = []
            new: List[TimedForce] = []
            for link, force, torque, law, joint in wrenches:
                row = session.registry.scoped_link_row(link) \
                    if law is not None or any((*force, *torque)) else None
                if row is None:
                    ids.append(0)
                    continue
                ids.append(session.new_id())
                new.append(TimedWrench(
                    ids[-1], row, 0, FOREVER, force, torque, law=law,
                    axis_row=session.registry.joint_row(joint) if joint else -1))
            commands: List[Command] = [ClearTimedForces(tuple(old))] if old else []
            if new:
                commands.append(AddTimedForces(tuple(new), whole=True))
            if commands:
                now = session.call(Batch(tuple(commands))).step
                for number in old:
                    self._forces.pop(number, None)
                self._forces.update({one.force_id: one.begun(now) for one in new})
            return ids

    # -- for the other parts, which hold the structure lock ----------------------------------------

    @property
    def ids(self) -> Tuple[int, ...]:
        """Ids of all queued and acting wrenches and efforts."""
        return tuple(self._forces)

    def pending(self, step: int) -> Tuple[TimedForce, ...]:
        """Wrenches and efforts that act or start after a step count."""
        return tuple(force for force in self._forces.values() if force.stop > step)

    def shift_pending(self, now: int, step: int) -> List[TimedForce]:
        """The pending ones as they are once the clock shows `step` instead of `now`.

        Each lasts as long as it would have.
        """
        by = step - now
        return [replace(force, start=max(0, force.start + by),
                        stop=force.stop if force.stop == FOREVER else force.stop + by)
                for force in self.pending(now)]

    def replace_all(self, forces: Sequence[TimedForce] = ()) -> None:
        """Replace all entries; the caller updates the engine."""
        self._forces = {force.force_id: force for force in forces}

    def store(self, forces: Sequence[TimedForce]) -> None:
        """Add entries that the caller has sent to the engine."""
        self._forces.update({force.force_id: force for force in forces})

    def forget_entity(self, entity: Entity) -> None:
        """Remove the entries of a model that was deleted from the engine."""
        self._forces = {key: force for key, force in self._forces.items()
                        if not (entity.has_link_row if isinstance(force, TimedWrench)
                                else entity.has_joint_row)(force.row)}

    def transfer_to_successor(self, old: Entity, new: Entity) -> List[TimedForce]:
        """The entries of a replaced model, with the rows of its successor `new`."""
        links, axes = old.rows_in(new)
        found: List[TimedForce] = []
        for force in self.pending(self._session.ring.step):
            rows = links if isinstance(force, TimedWrench) else axes
            if force.row in rows:
                force = replace(force, row=rows[force.row])
                if isinstance(force, TimedWrench):
                    force = replace(force, axis_row=axes.get(force.axis_row, -1))
                found.append(force)
        return found

    def _clear_row(self, kind: type, row: int) -> None:
        found = [force.force_id for force in self._forces.values()
                 if isinstance(force, kind) and force.row == row
                 and not (isinstance(force, TimedWrench) and force.law is not None)]
        if found:
            self.remove(found)

    def _span(self, start_ns: int, duration_ns: int) -> Tuple[int, int]:
        _, clock = self._session.ring.clock()
        start = first_step(clock, start_ns)
        return start, FOREVER if duration_ns < 0 else start + steps_of(clock, duration_ns)


def first_step(clock: Clock, sim_ns: int) -> int:
    """The first step that begins at a sim time or later; 0 for times before step 0.

    A step may begin a nanosecond early: sim times are rounded to whole ones.
    """
    ahead = (sim_ns - clock.epoch_ns - 1) * NANOSECOND_PS
    return max(0, clock.epoch_step - (-ahead // clock.step_ps))


def steps_of(clock: Clock, duration_ns: int) -> int:
    """The number of steps nearest to a duration (ns), at least one."""
    return max(1, (duration_ns * NANOSECOND_PS + clock.step_ps // 2) // clock.step_ps)
