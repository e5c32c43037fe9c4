"""Internal state of the engine from earlier steps, besides poses, velocities and commands."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Optional, Tuple

from ..geometry import Pose
from .commands import Command

SPLIT_IMPULSES_NOT_BEGUN = -1
"""For `RunState.split_impulse_end`: no step was made since models were loaded."""


@dataclass(frozen=True)
class LoopMemory:
    """State of a PID loop: the integral of its error, and its last error (None for none)."""

    integral: float = 0.0
    error: Optional[float] = None


@dataclass(frozen=True)
class ServoMemory:
    """State of a joint servo.

    Attributes:
        loop, inner: of the loops about the target and of the drive.
        target: as in `JointServo`; of a servo that holds, the position that it holds.
        before: the position, or the rate with a lag, commanded in the last step; None for none.
        last: the effort (N m or N) or rate commanded in the last step.
    """

    loop: LoopMemory
    inner: LoopMemory
    target: float
    before: Optional[float]
    last: float


@dataclass(frozen=True)
class DamperMemory:
    """State of the springs and dampers on the axes of a body.

    Attributes:
        other: rad/s^2 or m/s^2, the accelerations by everything else.
        rates: rad/s or m/s in the last step; None for not measured.
        given: rad/s^2 or m/s^2, the accelerations by springs and dampers in the last step.
        efforts: N m or N, of springs and dampers in the last step.
        spent: N m or N, by the motors of the axes in the last step.
        cancelled: the motors cancelled all dampers at the last check.
    """

    other: Tuple[float, ...]
    rates: Optional[Tuple[float, ...]]
    given: Tuple[float, ...]
    efforts: Tuple[float, ...]
    spent: Tuple[float, ...]
    cancelled: bool = False


@dataclass(frozen=True)
class RestPose:
    """Where a body rests.

    Attributes:
        base: pose of PyBullet's base; None for a fixed one.
        positions: of its joint axes, rad or m.
    """

    base: Optional[Pose]
    positions: Tuple[float, ...] = ()


@dataclass(frozen=True)
class RunState:
    """The state that a run requires to continue, besides poses, velocities and commands.

    The impulses from which the contact solver starts are not included: PyBullet cannot set them.

    Attributes:
        resting: bodies that sleep, or that are held because they stand still: by their first link
            row the pose in which they rest.
        servos: by joint row.
        loops: PID loops of timed efforts, by force id.
        dampers: by the first joint row of the body.
        split_impulse_end: the step at which split impulses end, which separate overlaps of loaded
            models without velocity; None if they do not act, SPLIT_IMPULSES_NOT_BEGUN before the
            first step.
        stopped: first link rows of bodies that were stopped because they went too far.
    """

    resting: Tuple[Tuple[int, RestPose], ...] = ()
    servos: Tuple[Tuple[int, ServoMemory], ...] = ()
    loops: Tuple[Tuple[int, LoopMemory], ...] = ()
    dampers: Tuple[Tuple[int, DamperMemory], ...] = ()
    split_impulse_end: Optional[int] = None
    stopped: Tuple[int, ...] = ()


@dataclass(frozen=True)
class ReadRunState(Command):
    """Reply value: the `RunState`."""


@dataclass(frozen=True)
class SetRunState(Command):
    """Continue from a `RunState`, after the same models, drives and forces were loaded again.

    Bodies that rested stay awake for some steps in which the solver finds their contact forces.
    Then they are put back to where they rested, unless something has moved them.
    """

    state: RunState
