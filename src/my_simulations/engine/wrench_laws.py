"""Wrenches on a link that follow from its state in every step, as arithmetic.

Sources: hector_gazebo_plugins (force_based_move), hector_quadrotor_model (drag), Gazebo 11
(LiftDragPlugin, BuoyancyPlugin), rotors_gazebo_plugins (motor model). No physics engine is needed
here.
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
    multiply,
    norm,
    rotate,
    rotation_vector,
    scale,
    subtract,
    transform,
    twist_at,
    unit,
)

Wrench = Tuple[Vec3, Vec3]
"""Force at the centre of mass and torque, N and N m, world axes."""

AxisState = Tuple[float, float]
"""Position and rate of a joint axis, rad and rad/s or m and m/s."""

AT_REST: AxisState = (0.0, 0.0)

_SLOWEST = 0.01  # m/s


def clamped_vector(vector: Vec3, most: float) -> Vec3:
    """A vector whose components are within +-`most`."""
    x, y, z = (max(-most, min(most, value)) for value in vector)
    return x, y, z


class WrenchLaw(Protocol):
    """Computes the wrench that acts in a step. It has no memory, and can be pickled."""

    def wrench(self, pose: Pose, twist: Twist, com: Vec3, joint: AxisState = AT_REST) -> Wrench:
        """Return the wrench for a state of the link.

        Args:
            pose: world pose of the link.
            twist: at its origin.
            com: its centre of mass in its own axes, m.
            joint: state of the joint that the law follows.
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

    def wrench(self, pose: Pose, twist: Twist, com: Vec3, joint: AxisState = AT_REST) -> Wrench:
        vx, vy, _ = rotate(conjugate(pose.orientation), twist.linear)
        along = (self.gains[0] * (self.x - vx), self.gains[1] * (self.y - vy), 0.0)
        return (rotate(pose.orientation, along),
                (0.0, 0.0, self.gains[2] * (self.yaw - twist.angular[2])))


@dataclass(frozen=True)
class PoseSpring:
    """Springs and dampers that pull a link to a pose, and a force that lifts it.

    The force is k (p_wanted - p) - c v, with the linear velocity v of the origin, applied at the
    centre of mass. The torque is k_a log(q^-1 q_wanted) - c_a w in axes of the link, with half the
    rotation vector log (ignition's `Quaternion::Log`). Source: gazebo_plugins (hand_of_god).

    Attributes:
        wanted: world pose.
        stiffness: k in N/m, k_a in N m/rad.
        damping: c in N s/m, c_a in N m s/rad.
        lift: N, world axes.
    """

    wanted: Pose
    stiffness: Tuple[float, float]
    damping: Tuple[float, float]
    lift: Vec3

    def wrench(self, pose: Pose, twist: Twist, com: Vec3, joint: AxisState = AT_REST) -> Wrench:
        """See `WrenchLaw`."""
        (kl, ka), (cl, ca) = self.stiffness, self.damping
        force = subtract(scale(subtract(self.wanted.position, pose.position), kl),
                         scale(twist.linear, cl))
        back = conjugate(pose.orientation)
        torque = subtract(
            scale(rotation_vector(multiply(back, self.wanted.orientation)), 0.5 * ka),
            scale(rotate(back, twist.angular), ca))
        return add(force, self.lift), rotate(pose.orientation, torque)


@dataclass(frozen=True)
class ForceAtPoint:
    """A constant force at a point that moves with the link.

    Attributes:
        force: N, world axes.
        point: in link axes, m.
    """

    force: Vec3
    point: Vec3

    def wrench(self, pose: Pose, twist: Twist, com: Vec3, joint: AxisState = AT_REST) -> Wrench:
        arm = subtract(transform(pose, self.point), transform(pose, com))
        return self.force, cross(arm, self.force)


@dataclass(frozen=True)
class BodyWrench:
    """A constant wrench in axes that turn with the link.

    Attributes:
        force: N, at the origin of the link.
        torque: N m.
    """

    force: Vec3
    torque: Vec3

    def wrench(self, pose: Pose, twist: Twist, com: Vec3, joint: AxisState = AT_REST) -> Wrench:
        torque = subtract(self.torque, cross(com, self.force))
        return rotate(pose.orientation, self.force), rotate(pose.orientation, torque)


@dataclass(frozen=True)
class BodyDrag:
    """Drag of a link in the air, and a moment against its rotation, each by the square of a speed.

    Source: hector_quadrotor_model. With the velocity v of the link's origin relative to the air and
    its angular velocity w, both in axes of the link and with components of at most `most`, the
    force is -`linear` v |v| and the torque -`angular` w |w|, component by component.

    Attributes:
        linear: N s^2/m^2.
        angular: N m s^2/rad^2.
        wind: velocity of the air, m/s, world axes.
        most: m/s and rad/s.
    """

    linear: Vec3
    angular: Vec3
    wind: Vec3
    most: float

    def wrench(self, pose: Pose, twist: Twist, com: Vec3, joint: AxisState = AT_REST) -> Wrench:
        return BodyWrench(*self.in_body_axes(pose, twist)).wrench(pose, twist, com)

    def in_body_axes(self, pose: Pose, twist: Twist) -> Wrench:
        """Force at the origin of the link and torque, N and N m, in its axes."""
        back = conjugate(pose.orientation)
        velocity = clamped_vector(subtract(twist.linear, self.wind), self.most)
        spin = clamped_vector(twist.angular, self.most)
        return (self._against(rotate(back, velocity), self.linear),
                self._against(rotate(back, spin), self.angular))

    @staticmethod
    def _against(motion: Vec3, gains: Vec3) -> Vec3:
        speed = norm(motion)
        return (-gains[0] * speed * motion[0], -gains[1] * speed * motion[1],
                -gains[2] * speed * motion[2])


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

    def wrench(self, pose: Pose, twist: Twist, com: Vec3, joint: AxisState = AT_REST) -> Wrench:
        lever = rotate(pose.orientation, self.centre)
        force = self._force(pose, twist_at(twist, lever).linear, self.rudder * joint[0])
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


@dataclass(frozen=True)
class Rotor:
    """Thrust and drag of a rotor that turns about the z axis of its link.

    The thrust is k w |w| along the axis, with the rate w of the rotor's joint. The drag is
    k_d |w| times the velocity of the air across the axis (Martin and Salaun, The True Role of
    Accelerometer Feedback in Quadrotor Control, ICRA 2010). The torque against the rotation is the
    thrust times a length; a motor that keeps the rate passes it on to the body that carries it.

    Attributes:
        thrust: k, N s^2/rad^2; negative for a rotor that lifts as it turns clockwise.
        moment: ratio of the torque about the axis to the thrust, m, positive.
        drag, rolling: force and torque by rate and velocity, N s^2/(rad m) and N s^2/rad.
        wind: velocity of the air, m/s, world axes.
    """

    thrust: float
    moment: float
    drag: float
    rolling: float
    wind: Vec3

    def wrench(self, pose: Pose, twist: Twist, com: Vec3, joint: AxisState = AT_REST) -> Wrench:
        rate = joint[1]
        speed = abs(rate)
        axis = rotate(pose.orientation, (0.0, 0.0, 1.0))
        air = subtract(twist.linear, self.wind)
        across = subtract(air, scale(axis, dot(air, axis)))
        lift = self.thrust * rate * speed
        # Against the rotation, whichever way the rotor lifts.
        brake = -math.copysign(lift * self.moment, rate)
        return (add(scale(axis, lift), scale(across, -speed * self.drag)),
                add(scale(axis, brake), scale(across, -speed * self.rolling)))
