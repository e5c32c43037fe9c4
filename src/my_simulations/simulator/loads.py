"""Timed wrenches on links and efforts on joints, asked for in sim time and exact to the step."""
from __future__ import annotations

from dataclasses import replace
from typing import List, Tuple, Union

from ..engine.commands import FOREVER, AddLoads, ClearLoads, Load, Servo
from ..engine.ring import Clock
from ..errors import CommandError
from ..geometry import ZERO3, Vec3, compose, inverse, rotate, subtract, transform
from .surroundings import Surroundings

NANOSECOND_PS = 1000

Effort = Union[float, Servo]
"""N m or N, or what finds it in every step."""


class TimedLoads(Surroundings):
    """Loads come, add up, run out and are cleared."""

    def add_loads(self, loads: List[Load], whole: bool = False) -> List[int]:
        """Queue timed loads; returns their ids. `load_id` of the arguments is replaced.

        With `whole`, a load whose start has passed begins with the next step and acts for as many
        steps as it would have.
        """
        with self._order:
            numbered = []
            for load in loads:
                self._next_id += 1
                numbered.append(replace(load, load_id=self._next_id))
            now = self._call(AddLoads(tuple(numbered), whole)).step
            self._loads = {key: load for key, load in self._loads.items() if load.stop > now}
            self._loads.update({load.load_id: load.begun(now) if whole else load
                                for load in numbered})
            return [load.load_id for load in numbered]

    def clear_loads(self, load_ids: List[int]) -> None:
        """Drop loads; unknown ids have run out."""
        with self._order:
            for load_id in load_ids:
                self._loads.pop(load_id, None)
            self._call(ClearLoads(tuple(load_ids)))

    def push(self, link: str, force: Vec3, torque: Vec3, *, frame: str = "", point: Vec3 = ZERO3,
             start_ns: int = 0, duration_ns: int = -1) -> None:
        """Let a wrench act on a link for a time.

        Args:
            link: plain or scoped name.
            force: N, along the axes of `frame`.
            torque: N m, likewise.
            frame: "" or a literal for the world: the axes stay the world's and the force attacks
                at the centre of mass. A model or link: the wrench is given in that frame as it is
                now, attacks at its origin, and from then on turns with the link it acts on.
            point: m, added to where the force attacks, along the same axes.
            start_ns: sim time from which it acts; a past one means from the next step on.
            duration_ns: how long, rounded to steps and at least one; 0 not at all, negative until
                it is cleared.

        Raises:
            UnknownEntity, UnknownFrame: no such link or frame.
        """
        with self._order:
            with self._lock:
                entity, index = self._registry.link(link)
                row = entity.first_link_row + index
                anchor = self._registry.frame(frame)
                if anchor is not None:
                    snapshot = self._snapshot()
                    here = compose(inverse(snapshot.link(row)[0]), anchor.state(snapshot)[0])
                    com = entity.model.links[index].inertial.pose.position
                    point = subtract(transform(here, point), com)
                    force = rotate(here.orientation, force)
                    torque = rotate(here.orientation, torque)
            if duration_ns:
                start, stop = self._span(start_ns, duration_ns)
                self.add_loads([Load(0, row, start, stop, force, torque,
                                     in_link_axes=anchor is not None, point=point)], whole=True)

    def drive(self, joint: str, effort: Effort, *, start_ns: int = 0,
              duration_ns: int = -1) -> None:
        """Let an effort act on a joint's axis for a time; see `push` for the times.

        Raises:
            UnknownEntity: no such joint.
            CommandError: the joint has no axis.
        """
        with self._order:
            row = self._axis_row(joint)
            if duration_ns:
                start, stop = self._span(start_ns, duration_ns)
                servo = effort if isinstance(effort, Servo) else None
                self.add_loads([Load(0, row, start, stop, servo=servo,
                                     effort=0.0 if isinstance(effort, Servo) else effort)],
                               whole=True)

    def drives(self, joint: str) -> Tuple[Effort, ...]:
        """What drives a joint's axis until it is cleared. Raises CommandError as `drive` does."""
        row = self._axis_row(joint)
        return tuple(load.effort if load.servo is None else load.servo
                     for load in self._loads.values()
                     if load.row == row and load.effort is not None and load.stop == FOREVER)

    def clear_pushes(self, link: str) -> None:
        """End every wrench on a link. Raises UnknownEntity."""
        with self._order:
            with self._lock:
                entity, index = self._registry.link(link)
            self._clear_row(entity.first_link_row + index, joint=False)

    def clear_drives(self, joint: str) -> None:
        """End every effort on a joint's axis. Raises CommandError as `drive` does."""
        with self._order:
            self._clear_row(self._axis_row(joint), joint=True)

    def _clear_row(self, row: int, joint: bool) -> None:
        found = [load.load_id for load in self._loads.values()
                 if load.row == row and (load.effort is not None) == joint]
        if found:
            self.clear_loads(found)

    def _axis_row(self, name: str) -> int:
        with self._lock:
            entity, joint, number = self._registry.joint(name)
            row = entity.axis_row(joint.name, number)
        if row is not None:
            return row
        raise CommandError(f"the joint '{name}' is {joint.type} and has no axis to drive")

    def _span(self, start_ns: int, duration_ns: int) -> "tuple[int, int]":
        _, clock = self.ring.clock()
        start = first_step(clock, start_ns)
        return start, FOREVER if duration_ns < 0 else start + steps_of(clock, duration_ns)


def first_step(clock: Clock, sim_ns: int) -> int:
    """The first step that begins at a sim time or later; 0 for times before step 0.

    A step may begin a nanosecond early: sim times are rounded to whole ones.
    """
    ahead = (sim_ns - clock.epoch_ns - 1) * NANOSECOND_PS
    return max(0, clock.epoch_step - (-ahead // clock.step_ps))


def steps_of(clock: Clock, duration_ns: int) -> int:
    """How many steps are nearest to a duration, at least one."""
    return max(1, (duration_ns * NANOSECOND_PS + clock.step_ps // 2) // clock.step_ps)
