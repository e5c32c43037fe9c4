"""The limits of joints that position control respects."""
from __future__ import annotations

import math
from typing import Mapping, NamedTuple, Optional

from ..description.model import INFINITE
from ..errors import CommandError
from ..simulator.simulator import Simulator


class JointLimits(NamedTuple):
    """The limits of a joint axis in its file; infinite for none.

    Attributes:
        lower, upper: of the position, rad or m.
        velocity: rad/s or m/s.
        effort: N m or N.
    """

    lower: float
    upper: float
    velocity: float
    effort: float


def limits_of(simulator: Simulator, joint: str) -> JointLimits:
    """The limits of an axis by its name. Raises CommandError."""
    _, found, number = simulator.joints.find(joint)
    axis = found.axis2 if number else found.axis
    if axis is None:
        raise CommandError(f"joint '{joint}' has no axis that moves")
    if found.type == "continuous":
        return JointLimits(-math.inf, math.inf, _most(axis.velocity), _most(axis.effort))
    return JointLimits(-math.inf if axis.lower <= -INFINITE else axis.lower,
                       math.inf if axis.upper >= INFINITE else axis.upper,
                       _most(axis.velocity), _most(axis.effort))


def move_within_limits(simulator: Simulator, positions: Mapping[str, float],
                       effort: Optional[float], rate: Optional[float]) -> None:
    """Move axes to positions with a limited effort and rate; None for the limits of their file.

    Raises CommandError: no such joint, or neither its file nor the call limits the effort.
    """
    wanted = {}
    for joint, position in positions.items():
        limits = limits_of(simulator, joint)
        wanted[joint] = (float(position), _effort(joint, limits, effort),
                         limits.velocity if rate is None else float(rate))
    simulator.drives.hold_axes(wanted)


def drive_within_limits(simulator: Simulator, rates: Mapping[str, float],
                        effort: Optional[float]) -> None:
    """Drive axes at rates with a limited effort; None for the limits of their file.

    Raises CommandError as `move_within_limits`.
    """
    simulator.drives.drive_axes({
        joint: (float(rate), float(effort) if effort is not None
                else _effort(joint, limits_of(simulator, joint), None))
        for joint, rate in rates.items()})


def _effort(joint: str, limits: JointLimits, effort: Optional[float]) -> float:
    if effort is not None:
        return float(effort)
    if limits.effort == math.inf:
        raise CommandError(f"the file of joint '{joint}' has no limit of effort: give an effort")
    return limits.effort


def _most(value: float) -> float:
    """A limit of a file; 0 and less, and SDF's 1e16, are none."""
    return value if 0.0 < value < INFINITE else math.inf
