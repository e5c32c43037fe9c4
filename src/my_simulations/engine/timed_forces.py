"""Commands that apply wrenches and efforts for a duration, exact to the step."""
from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Optional, Tuple, TypeVar

from ..geometry import Vec3
from .commands import FOREVER, Command
from .wrench_laws import WrenchLaw

_Timed = TypeVar("_Timed", bound="TimedForce")


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
class TimedForce:
    """A wrench on a link or an effort on a joint axis, exact to the step.

    Acts in steps `start` (the first step whose beginning is at this count) to `stop` - 1.

    Attributes:
        force_id: id, to clear it.
        row: link row or joint row.
        start, stop: step counts; `stop` FOREVER for until cleared.
    """

    force_id: int
    row: int
    start: int
    stop: int

    def begun(self: _Timed, step: int) -> _Timed:
        """Return the same with its full duration from `step` on, if its start has passed."""
        late = step - self.start
        if late <= 0:
            return self
        return replace(self, start=step, stop=FOREVER if self.stop == FOREVER
                       else self.stop + late)


@dataclass(frozen=True)
class TimedWrench(TimedForce):
    """A wrench on a link.

    Attributes:
        force, torque: N and N m, world axes, at the centre of mass.
        in_link_axes: force, torque and point are in link axes and turn with the link.
        point: m, from the centre of mass to where the force is applied, same axes as the force.
        law: computes force and torque in every step; the attributes above are not used then.
        axis_row: joint row that the law follows; -1 for none.
    """

    force: Vec3 = (0.0, 0.0, 0.0)
    torque: Vec3 = (0.0, 0.0, 0.0)
    in_link_axes: bool = False
    point: Vec3 = (0.0, 0.0, 0.0)
    law: Optional[WrenchLaw] = None
    axis_row: int = -1


@dataclass(frozen=True)
class TimedEffort(TimedForce):
    """An effort on a joint axis.

    Attributes:
        effort: N m or N; ignored with `pid`.
        pid: computes the effort in every step.
    """

    effort: float = 0.0
    pid: Optional[JointPid] = None


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
