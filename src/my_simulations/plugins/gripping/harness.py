"""libHarnessPlugin.so and libgazebo_ros_harness.so: a model hangs on a winch until it is released.

Parameters, gains and topics are those of Gazebo: a sliding `<joint>` from the world to a link, a
`<winch>` with gains for position and rate, a joint to `<detach>`. `/MODEL/harness/velocity`
(std_msgs/Float32, m/s) turns the winch, 0 holds; `/MODEL/harness/detach` (std_msgs/Bool) releases
the model, and a reset of the world hangs it up again. Straps hold it across the joint, and upright,
as a spring of 10 Hz that is critically damped; in Gazebo it is rigid.
"""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Optional

from ...geometry import (
    Pose,
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
)
from ..base import Plugin
from ..call_slot import CallSlot
from ..context import PluginError
from ..finite_messages import subscribe_finite
from ..parameters import Parameters
from ..time_out import Stopwatch

_OMEGA = 2.0 * math.pi * 10.0   # rad/s of the straps


@dataclass
class Pid:
    """Gazebo's PID: the error is what is too much, the output is against it."""

    p: float = 0.0
    i: float = 0.0
    d: float = 0.0
    i_max: float = 0.0
    i_min: float = 0.0
    cmd_max: float = 0.0
    cmd_min: float = 0.0
    integral: float = 0.0
    before: Optional[float] = None

    def reset(self) -> None:
        self.integral, self.before = 0.0, None

    def update(self, error: float, dt: float) -> float:
        """The next output, within its limits where these are not both 0.

        The integral term stays within its own, which leave nothing of it where they are not given.
        """
        slope = 0.0 if self.before is None else (error - self.before) / dt
        self.before = error
        self.integral += self.i * dt * error
        self.integral = max(self.i_min, min(self.i_max, self.integral))
        output = -self.p * error - self.integral - self.d * slope
        if self.cmd_max > self.cmd_min:
            output = max(self.cmd_min, min(self.cmd_max, output))
        return output


class Harness(Plugin):
    """Pushes a link so that it hangs."""

    def load(self) -> None:
        """Read parameters; hang the model up."""
        context, p = self.context, self.context.parameters
        joints = {joint.attribute("name"): joint for joint in p.children("joint")}
        if not joints:
            raise PluginError("it has no <joint>")
        winch = p.children("winch")
        name = winch[0].text("joint") if winch else ""
        joint = joints.get(name) or next(iter(joints.values()))
        self._read_joint(joint)
        self._position_pid = _pid(winch, "pos_pid")
        self._rate_pid = _pid(winch, "vel_pid")
        self._mass = sum(link.inertial.mass for link in context.description.links)
        self._inertia = self._about_the_link()
        above = f"/{context.model}/harness"
        subscribe_finite(context, f"{above}/velocity", "std_msgs/Float32", self._receive_rate)
        context.subscribe(f"{above}/detach", "std_msgs/Bool", self._receive_detach)
        self._timer = CallSlot()   # while it hangs
        self.reset()

    def _read_joint(self, joint: Parameters) -> None:
        context = self.context
        self._link = context.link(joint.text("child").rpartition("::")[2])
        axes = joint.children("axis")
        slides = joint.attribute("type") == "prismatic" and bool(axes)
        axis = axes[0] if slides else Parameters("")
        way = axis.vector("xyz", (0.0, 0.0, 1.0))
        turn = joint.pose("pose").orientation
        self._axis_in_link = rotate(turn, scale(way, 1.0 / (norm(way) or 1.0)))
        self._slides = slides
        limits, dynamics = axis.children("limit"), axis.children("dynamics")
        self._lower = limits[0].number("lower", -math.inf) if limits else -math.inf
        self._upper = limits[0].number("upper", math.inf) if limits else math.inf
        self._damping = dynamics[0].number("damping", 0.0) if dynamics else 0.0

    def _about_the_link(self) -> float:
        """Of all links about the origin of the one that hangs, kg m^2, on average of the axes."""
        links = {link.name: link for link in self.context.description.links}
        at = links[self._link.name].pose.position if self._link.name in links else (0.0, 0.0, 0.0)
        total = 0.0
        for link in links.values():
            i = link.inertial
            arm = norm(subtract(add(link.pose.position, i.pose.position), at))
            total += (i.ixx + i.iyy + i.izz) / 3.0 + i.mass * arm * arm * 2.0 / 3.0
        return total

    def reset(self) -> None:
        """Hang where the model is."""
        self._hangs = True
        if not self._timer.is_active:
            self._timer.set(self.context.every(0.0, self.update))
        self._anchor: Pose = self._link.pose
        self._axis: Vec3 = rotate(self._anchor.orientation, self._axis_in_link)
        self._rate = self._place = 0.0
        self.clock_set()
        self._position_pid.reset()
        self._rate_pid.reset()

    def clock_set(self) -> None:
        """Measure the time between updates from now."""
        self._stopwatch = Stopwatch(self.context)

    def _receive_rate(self, message: Any) -> None:
        self._rate = float(message.data)
        if self._rate == 0.0:
            self._place = self._position()
            self._position_pid.reset()

    def _receive_detach(self, message: Any) -> None:
        if bool(message.data) and self._hangs:
            self._hangs = False
            self._timer.end()
            self.context.set_wrench(self._link.name, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
            self.context.info("the harness lets go")

    def _position(self) -> float:
        return dot(self._axis, subtract(self._link.pose.position, self._anchor.position))

    def update(self) -> None:
        dt = self._stopwatch.lap()
        if not self._hangs or dt <= 0.0:
            return
        pose, twist = self._link.pose, self._link.twist
        off, rate = subtract(pose.position, self._anchor.position), twist.linear
        along, speed = dot(self._axis, off), dot(self._axis, rate)
        force: Vec3 = (0.0, 0.0, 0.0)
        if self._slides:
            force = scale(self._axis, self._winch(along, speed, dt))
            off = subtract(off, scale(self._axis, along))
            rate = subtract(rate, scale(self._axis, speed))
        stiff, damped = self._mass * _OMEGA ** 2, 2.0 * self._mass * _OMEGA
        force = subtract(force, add(scale(off, stiff), scale(rate, damped)))
        turned = rotation_vector(multiply(pose.orientation, conjugate(self._anchor.orientation)))
        torque = scale(add(scale(turned, _OMEGA ** 2), scale(twist.angular, 2.0 * _OMEGA)),
                       -self._inertia)
        # The straps hold at the link's origin; the wrench acts at its centre of mass.
        arm = rotate(pose.orientation, self._link.inertial.pose.position)
        self.context.set_wrench(self._link.name, force, subtract(torque, cross(arm, force)))

    def _winch(self, position: float, rate: float, dt: float) -> float:
        """Along the joint, N; it pulls up to a rate, and does not push down."""
        error = position - self._place if self._rate == 0.0 else 0.0
        force = self._position_pid.update(error, dt)
        force += max(0.0, self._rate_pid.update(rate - self._rate, dt))
        force -= self._damping * rate
        beyond = position - max(self._lower, min(self._upper, position))
        if beyond:
            force -= self._mass * (_OMEGA ** 2 * beyond + 2.0 * _OMEGA * rate)
        return force


def _pid(winch: "list[Parameters]", name: str) -> Pid:
    found = winch[0].children(name) if winch else []
    if not found:
        return Pid()
    return Pid(*(found[0].number(field, 0.0) for field in (
        "p", "i", "d", "i_max", "i_min", "cmd_max", "cmd_min")))
