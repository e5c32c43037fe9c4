"""The limits of joints that position control respects."""
from __future__ import annotations

import math
from typing import NamedTuple, Optional

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


def move_within_limits(simulator: Simulator, joint: str, position: float,
                       effort: Optional[float], rate: Optional[float]) -> None:
    """Move an axis to a position with a limited effort and rate; None for the limit of its file.

    Raises CommandError: no such joint, or neither its file nor the call limits the effort.
    """
    limits = limits_of(simulator, joint)
    most = limits.effort if effort is None else float(effort)
    if not 0.0 < most < math.inf and effort is None:
        raise CommandError(f"the file of joint '{joint}' has no limit of effort: give an effort")
    fastest = limits.velocity if rate is None else float(rate)
    simulator.drives.hold_axis(joint, float(position), most, fastest)


def _most(value: float) -> float:
    """A limit of a file; 0 and less, and SDF's 1e16, are none."""
    return value if 0.0 < value < INFINITE else math.inf
