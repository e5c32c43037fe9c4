"""Wrenches on a link that follow from its state in every step, as arithmetic.

Sources: hector_gazebo_plugins (force_based_move), Gazebo 11 (LiftDragPlugin, BuoyancyPlugin). No
physics engine is needed here.
"""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol, Tuple

from ..geometry import (
    ZERO3,
    Pose,
    Twist,
    Vec3,
    add,
    conjugate,
    cross,
    dot,
    norm,
    rotate,
    scale,
    subtract,
    transform,
    twist_at,
    unit,
)

Wrench = Tuple[Vec3, Vec3]
"""Force at the centre of mass and torque, N and N m, world axes."""

_SLOWEST = 0.01  # m/s


class WrenchLaw(Protocol):
    """Computes the wrench that acts in a step. It has no memory, and can be pickled."""

    def wrench(self, pose: Pose, twist: Twist, com: Vec3, joint: float = 0.0) -> Wrench:
        """Return the wrench for a state of the link.

        Args:
            pose: world pose of the link.
            twist: at its origin.
            com: its centre of mass in its own axes, m.
            joint: position of the joint that the law follows, rad or m; 0 without one.
        """


@dataclass(frozen=True)
class VelocityForce:
    """A force along x and y of the link, and a torque about z, by what a velocity lacks.

    Attributes:
        gains: N s/m along x and y, N m s/rad about z.
        x, y: wanted velocity in link axes, m/s.
        yaw: wanted rate about the world's z, rad/s.
    """

    gains: Vec3
    x: float
    y: float
    yaw: float

    def wrench(self, pose: Pose, twist: Twist, com: Vec3, joint: float = 0.0) -> Wrench:
        """See `WrenchLaw`."""
        vx, vy, _ = rotate(conjugate(pose.orientation), twist.linear)
        along = (self.gains[0] * (self.x - vx), self.gains[1] * (self.y - vy), 0.0)
        return (rotate(pose.orientation, along),
                (0.0, 0.0, self.gains[2] * (self.yaw - twist.angular[2])))


@dataclass(frozen=True)
class ForceAtPoint:
    """A constant force at a point that moves with the link.

    Attributes:
        force: N, world axes.
        point: in link axes, m.
    """

    force: Vec3
    point: Vec3

    def wrench(self, pose: Pose, twist: Twist, com: Vec3, joint: float = 0.0) -> Wrench:
        """See `WrenchLaw`."""
        arm = subtract(transform(pose, self.point), transform(pose, com))
        return self.force, cross(arm, self.force)


@dataclass(frozen=True)
class Wing:
    """Lift and drag of a thin plate that stalls.

    Attributes:
        density, area: kg/m^3 and m^2.
        alpha0, stall: angle of attack at rest, and that at which it stalls, rad.
        lift, drag: slopes of the coefficients before and past the stall, 1/rad.
        centre: of pressure, in link axes, m.
        forward, upward: unit vectors in link axes.
        radial: the wing has the same lift in all directions across `forward`.
        rudder: what a joint that the law follows adds to the coefficient of lift, 1/rad.
    """

    density: float
    area: float
    alpha0: float
    stall: float
    lift: Tuple[float, float]
    drag: Tuple[float, float]
    centre: Vec3
    forward: Vec3
    upward: Vec3
    radial: bool
    rudder: float = 0.0

    def wrench(self, pose: Pose, twist: Twist, com: Vec3, joint: float = 0.0) -> Wrench:
        """See `WrenchLaw`."""
        lever = rotate(pose.orientation, self.centre)
        force = self._force(pose, twist_at(twist, lever).linear, self.rudder * joint)
        arm = subtract(add(pose.position, lever), transform(pose, com))
        return force, cross(arm, force)

    def _force(self, pose: Pose, velocity: Vec3, more_lift: float) -> Vec3:
        """Lift and drag, N, world axes, at a velocity (m/s) of the centre of pressure.

        `more_lift` is added to the coefficient of lift.
        """
        if norm(velocity) <= _SLOWEST:
            return ZERO3
        forward, upward = (rotate(pose.orientation, way) for way in (self.forward, self.upward))
        if self.radial:
            upward = unit(cross(forward, cross(forward, velocity)))
        span = unit(cross(forward, upward))
        sine = max(-1.0, min(1.0, dot(span, unit(velocity))))
        sweep = 1.0 - sine * sine  # the square of the cosine, whatever its name is in Gazebo
        plane = subtract(velocity, scale(span, dot(velocity, span)))
        lift_way = unit(cross(span, plane))
        alpha = math.acos(max(-1.0, min(1.0, dot(lift_way, upward))))
        alpha = self.alpha0 + (alpha if dot(lift_way, forward) >= 0.0 else -alpha)
        alpha = math.remainder(alpha, math.pi)
        pressure = 0.5 * self.density * dot(plane, plane) * self.area
        lift = self._coefficient(self.lift, alpha, sweep)
        if abs(alpha) > self.stall:  # stalled, it never lifts the other way
            lift = max(0.0, lift) if alpha > 0.0 else min(0.0, lift)
        lift += more_lift
        drag = abs(self._coefficient(self.drag, alpha, sweep))
        return add(scale(lift_way, lift * pressure), scale(unit(plane), -drag * pressure))

    def _coefficient(self, slopes: Tuple[float, float], alpha: float, sweep: float) -> float:
        """A coefficient that grows with alpha by the first slope, past the stall by the second."""
        most = max(-self.stall, min(self.stall, alpha))
        return (slopes[0] * most + slopes[1] * (alpha - most)) * sweep
