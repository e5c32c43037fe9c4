"""Commands that apply wrenches and efforts for a duration, exact to the step."""
from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Optional, Tuple, TypeVar, Union

from ..geometry import Vec3
from .commands import FOREVER, Command
from .wrench_laws import WrenchLaw


@dataclass(frozen=True)
class JointPid:
    """A PID controller of a joint axis, computed in every step (see `engine.bullet.joint_pid`).

    Attributes:
        target: rad or m, or with `rate` per second.
        rate: True to control the velocity, False for the position.
        p, i, d: gains: effort by error, by its integral over time, and by its rate.
    """

    target: float
    rate: bool = False
    p: float = 1.0
    i: float = 0.1
    d: float = 0.01


@dataclass(frozen=True)
class TimedWrench:
    """A wrench on a link, exact to the step.

    Acts in steps `start` (the first step whose beginning is at this count) to `stop` - 1.

    Attributes:
        force_id: id, to clear it.
        row: link row.
        start, stop: step counts; `stop` FOREVER for until cleared.
        force, torque: N and N m, world axes, at the centre of mass.
        in_link_axes: force, torque and point are in link axes and turn with the link.
        point: m, from the centre of mass to where the force is applied, same axes as the force.
        law: computes force and torque in every step; the attributes above are not used then.
        axis_row: joint row that the law follows; -1 for none.
    """

    force_id: int
    row: int
    start: int
    stop: int
    force: Vec3 = (0.0, 0.0, 0.0)
    torque: Vec3 = (0.0, 0.0, 0.0)
    in_link_axes: bool = False
    point: Vec3 = (0.0, 0.0, 0.0)
    law: Optional[WrenchLaw] = None
    axis_row: int = -1

    def begun(self, step: int) -> "TimedWrench":
        """The same with its full duration from `step` on, if its start has passed."""
        return _begun(self, step)


@dataclass(frozen=True)
class TimedEffort:
    """An effort on a joint axis, exact to the step.

    Attributes:
        force_id: id, to clear it.
        row: joint row.
        start, stop: as of `TimedWrench`.
        effort: N m or N; ignored with `pid`.
        pid: computes the effort in every step.
    """

    force_id: int
    row: int
    start: int
    stop: int
    effort: float = 0.0
    pid: Optional[JointPid] = None

    def begun(self, step: int) -> "TimedEffort":
        """The same with its full duration from `step` on, if its start has passed."""
        return _begun(self, step)


TimedForce = Union[TimedWrench, TimedEffort]
_Timed = TypeVar("_Timed", TimedWrench, TimedEffort)


@dataclass(frozen=True)
class AddTimedForces(Command):
    """Add timed wrenches and efforts; those on one link or axis add up.

    With `whole`, an entry whose start has passed begins with the next step and keeps its duration.
    """

    forces: Tuple[TimedForce, ...]
    whole: bool = False


@dataclass(frozen=True)
class ClearTimedForces(Command):
    """Clear timed wrenches and efforts by id; ids that have expired are ignored."""

    force_ids: Tuple[int, ...]


def _begun(force: _Timed, step: int) -> _Timed:
    late = step - force.start
    if late <= 0:
        return force
    return replace(force, start=step, stop=FOREVER if force.stop == FOREVER else force.stop + late)
