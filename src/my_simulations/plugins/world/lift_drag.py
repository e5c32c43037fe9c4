"""libLiftDragPlugin.so: lift and drag of a wing, a rudder or a rotor blade.

Parameters, defaults and law are those of Gazebo 11, which is thin-plate theory with a stall:
https://classic.gazebosim.org/tutorials?tut=aerodynamics. As there, the pitching moment (`cma`) does
not act. Where it differs: the velocity in the plane of lift and drag is that without its spanwise
part (the original subtracts the spanwise speed along the flow).
"""
from __future__ import annotations

import math
from typing import Optional

from ...geometry import Vec3, add, cross, dot, norm, rotate, scale, subtract, transform
from ..base import Plugin
from ..context import Joint, PluginError

_SLOWEST = 0.01  # m/s


class LiftDrag(Plugin):
    """Acts on the link `<link_name>` at its centre of pressure `<cp>`."""

    def load(self) -> None:
        """Read parameters."""
        context, p = self.context, self.context.parameters
        if not p.text("link_name"):
            raise PluginError("it has no <link_name>")
        self._link = context.link(p.text("link_name"))
        self._density, self._area = p.number("air_density", 1.2041), p.number("area", 1.0)
        self._alpha0, self._stall = p.number("a0", 0.0), p.number("alpha_stall", math.pi / 2.0)
        self._lift = (p.number("cla", 1.0), p.number("cla_stall", 0.0))
        self._drag = (p.number("cda", 0.01), p.number("cda_stall", 1.0))
        self._centre = p.vector("cp")
        self._forward = _unit(p.vector("forward", (1.0, 0.0, 0.0)))
        self._upward = _unit(p.vector("upward", (0.0, 0.0, 1.0)))
        self._radial = p.flag("radial_symmetry", False)
        self._control = self._control_joint(p.text("control_joint_name"))
        self._per_rad = p.number("control_joint_rad_to_cl", 4.0)
        context.every(0.0, self.update)

    def _control_joint(self, name: str) -> Optional[Joint]:
        """One that is not there is told, and the wing flies without it, as in Gazebo."""
        if not name:
            return None
        try:
            return self.context.joint(name)
        except PluginError as fault:
            self.context.warn(f"{fault}; <control_joint_name> does nothing")
            return None

    def update(self) -> None:
        """Before each step."""
        pose, twist = self._link.pose, self._link.twist
        lever = rotate(pose.orientation, self._centre)
        force = self.force(add(twist.linear, cross(twist.angular, lever)))
        arm = subtract(add(pose.position, lever),
                       transform(pose, self._link.inertial.pose.position))
        self.context.push(self._link.name, force, cross(arm, force))

    def force(self, velocity: Vec3) -> Vec3:
        """Lift and drag in N, world axes, at a velocity of the centre of pressure through air."""
        if norm(velocity) <= _SLOWEST:
            return (0.0, 0.0, 0.0)
        turn = self._link.pose.orientation
        forward, upward = rotate(turn, self._forward), rotate(turn, self._upward)
        if self._radial:
            upward = _unit(cross(forward, cross(forward, velocity)))
        span = _unit(cross(forward, upward))
        sine = max(-1.0, min(1.0, dot(span, _unit(velocity))))
        sweep = 1.0 - sine * sine  # the square of the cosine, whatever its name is in Gazebo
        plane = subtract(velocity, scale(span, dot(velocity, span)))
        lift_way = _unit(cross(span, plane))
        alpha = math.acos(max(-1.0, min(1.0, dot(lift_way, upward))))
        alpha = self._alpha0 + (alpha if dot(lift_way, forward) >= 0.0 else -alpha)
        alpha = math.remainder(alpha, math.pi)
        pressure = 0.5 * self._density * dot(plane, plane) * self._area
        lift = self._beyond(self._lift, alpha, sweep)
        if abs(alpha) > self._stall:  # stalled, it never lifts the other way
            lift = max(0.0, lift) if alpha > 0.0 else min(0.0, lift)
        if self._control is not None:
            lift += self._per_rad * self._control.position
        drag = abs(self._beyond(self._drag, alpha, sweep))
        return add(scale(lift_way, lift * pressure), scale(_unit(plane), -drag * pressure))

    def _beyond(self, slopes: "tuple[float, float]", alpha: float, sweep: float) -> float:
        """A coefficient that grows with alpha by the first slope, past the stall by the second."""
        most = max(-self._stall, min(self._stall, alpha))
        return (slopes[0] * most + slopes[1] * (alpha - most)) * sweep


def _unit(vector: Vec3) -> Vec3:
    size = norm(vector)
    return scale(vector, 1.0 / size) if size > 0.0 else vector
