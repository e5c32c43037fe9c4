"""Wheels of cars, which plugins drive by torques and brake by friction."""
from __future__ import annotations

import math

from ..context import Joint

FASTEST = 1e3  # rad/s: no wheel of a car turns as fast


def apply_torque(wheel: Joint, torque: float, friction: float = 0.0,
                 most_rate: float = FASTEST) -> None:
    """Apply a torque against Coulomb friction, N m, until the next call.

    The joint's motor does both. A torque above the friction accelerates the wheel, up to
    `most_rate` (rad/s); a friction above the torque stops it.
    """
    friction += wheel.spec.axis.friction if wheel.spec.axis is not None else 0.0
    if torque * wheel.velocity < 0.0:
        friction = -friction   # both act against the motion
    left = friction - abs(torque)
    if left < 0.0:
        wheel.drive(math.copysign(most_rate, torque), -left)
    else:
        wheel.drive(0.0, left)
