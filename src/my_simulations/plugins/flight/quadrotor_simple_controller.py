"""libhector_gazebo_quadrotor_simple_controller.so: forces on a body make it fly as commanded.

Parameters, defaults, topics, services and laws are those of hector_quadrotor_gazebo_plugins: PID
loops turn a velocity command in the axes of the heading into roll and pitch, and these into a
thrust along the z axis of the body and a torque. Where it differs: parameters named `<imuTopic>`
and `<stateTopic>` are ignored, the loops always use the true state; a wrench is published while the
motors are on; motors that the service `shutdown` has stopped need another command to start.

tum_simulator has a controller of this name, too, for its AR.Drone. In a model with its state
controller (ardrone.py), the flight state starts and stops the motors and determines their strength,
and commands have noise.
"""
from __future__ import annotations

import math
from typing import Any, Optional

from ...geometry import (
    Quat,
    Vec3,
    add,
    conjugate,
    dot,
    norm,
    rotate,
    rpy_from_quat,
    scale,
    subtract,
)
from ...geometry_messages import fill_wrench
from ..base import Plugin
from ..call_slot import CallSlot
from ..finite_messages import subscribe_finite
from ..sensors.hector_errors import rate_of
from ..time_out import Stopwatch
from .body_wrench import NO_WRENCH, hold_wrench, wrench_at_mass_centre
from .command_noise import CommandNoise
from .filtered_pid import FilteredPid
from .flight_states import STRENGTHS, FlightStates, state_controller

_TAKE_OFF = 0.1        # m/s: a command to rise this fast starts the motors
_TOUCHED_DOWN = -1.0   # m: integral of the height error below which the body has landed


class QuadrotorSimpleController(Plugin):
    """Flies the link `<bodyName>`, or the model's first one."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        self._link = context.link(p.text("bodyName"))
        self._most_force = p.number("maxForce", -1.0)
        self._roll, self._pitch = FilteredPid(p, "rollpitch"), FilteredPid(p, "rollpitch")
        self._yaw = FilteredPid(p, "yaw")
        self._x, self._y = FilteredPid(p, "velocityXY"), FilteredPid(p, "velocityXY")
        self._z = FilteredPid(p, "velocityZ")
        self._hertz = rate_of(p)
        command = self._topic("velocity_topic", p.text("topicName", "cmd_vel"))
        if command:
            subscribe_finite(context, command, "geometry_msgs/Twist", self._receive)
        for name in ("imuTopic", "stateTopic"):
            if p.text(name):
                context.warn(f"<{name}> is ignored; the controller uses the true state")
        self._wrenches = context.publish(self._topic("wrench_topic", p.text(
            "wrenchTopic", "wrench_out")), "geometry_msgs/Wrench", 10)
        self._timer, self._stopwatch = CallSlot(), Stopwatch(context)
        self._begin()
        drone = state_controller(context)
        self._states: Optional[FlightStates] = None
        self._noise: Optional[CommandNoise] = None
        self._auto_engages = drone is None and p.flag("autoEngage", True)
        if drone is not None:
            self._noise = CommandNoise(context)
            self._states = FlightStates(context, drone, self._follow_state)
            return
        context.serve("engage", "std_srvs/Empty", lambda request, response: self._engage())
        context.serve("shutdown", "std_srvs/Empty", lambda request, response: self._shut_down())

    def _topic(self, parameter: str, default: str) -> str:
        return str(self.context.parameter(f"controller/{parameter}", default))

    def _begin(self) -> None:
        self._command: Vec3 = (0.0, 0.0, 0.0)
        self._yaw_rate = 0.0
        self._wrench = NO_WRENCH

    def reset(self) -> None:
        self._timer.end()
        self._begin()
        self._apply()
        if self._states is not None and self._noise is not None:
            self._states.reset()
            self._noise.reset()

    def clock_set(self) -> None:
        self._stopwatch.restart()
        if self._states is not None:
            self._states.clock_set()

    def _receive(self, message: Any) -> None:
        self._command = (message.linear.x, message.linear.y, message.linear.z)
        self._yaw_rate = message.angular.z
        if self._noise is not None:
            x, y, z, yaw = self._noise.draw()
            self._command = add(self._command, (x, y, z))
            self._yaw_rate += yaw
        if self._auto_engages and not self._timer.is_active and self._command[2] > _TAKE_OFF:
            self._engage()

    @property
    def _strength(self) -> float:
        """Factor of thrust and torque."""
        return 1.0 if self._states is None else STRENGTHS[self._states.state]

    def _follow_state(self) -> None:
        """Start or stop the motors of an AR.Drone."""
        if self._strength > 0.0:
            self._engage()
        else:
            self._shut_down()

    def _engage(self) -> None:
        if self._timer.is_active:
            return
        for pid in (self._roll, self._pitch, self._yaw, self._x, self._y, self._z):
            pid.reset()
        self._velocity = self._link.twist.linear
        self._stopwatch.restart()
        self._timer.set(self.context.every(self._hertz, self.update))

    def _shut_down(self) -> None:
        if self._timer.is_active:
            self._timer.end()
            self._wrench = NO_WRENCH
            self._apply()
            self._publish()

    def update(self) -> None:
        elapsed = self._stopwatch.lap()
        if elapsed <= 0.0:
            return
        self._control(elapsed)
        if self._has_landed():
            self._shut_down()
            return
        self._publish()
        self._apply()

    def _has_landed(self) -> bool:
        return (self._auto_engages and self._z.integral < _TOUCHED_DOWN
                and self._command[2] < -_TAKE_OFF and abs(self._velocity[2]) < _TAKE_OFF)

    def _control(self, dt: float) -> None:
        """Compute the wrench in the axes of the body."""
        pose, twist, inertial = self._link.pose, self._link.twist, self._link.inertial
        before, self._velocity = self._velocity, twist.linear
        acceleration = scale(subtract(self._velocity, before), 1.0 / dt)
        roll, pitch, yaw = rpy_from_quat(pose.orientation)
        spin = rotate(conjugate(pose.orientation), twist.angular)
        velocity, change = to_heading(yaw, self._velocity), to_heading(yaw, acceleration)
        gravity = norm(self.context.gravity)
        per_gravity = 1.0 / gravity if gravity > 0.0 else 0.0
        pitch_command = self._x.update(self._command[0], velocity[0], change[0], dt) * per_gravity
        roll_command = -self._y.update(self._command[1], velocity[1], change[1], dt) * per_gravity
        torque = (inertial.ixx * self._roll.update(roll_command, roll, spin[0], dt),
                  inertial.iyy * self._pitch.update(pitch_command, pitch, spin[1], dt),
                  inertial.izz * self._yaw.update(self._yaw_rate, twist.angular[2], 0.0, dt))
        lift = inertial.mass * (self._z.update(self._command[2], velocity[2], change[2], dt)
                                + load_factor(self.context.gravity, pose.orientation) * gravity)
        if self._most_force > 0.0:
            lift = min(lift, self._most_force)
        force = (0.0, 0.0, max(0.0, lift) * self._strength)
        torque = scale(torque, self._strength)
        # hector's thrust acts at the origin of the link, that of the AR.Drone at its mass centre.
        self._wrench = (force, torque) if self._states is None else wrench_at_mass_centre(
            self._link, force, torque)

    def _apply(self) -> None:
        hold_wrench(self.context, self._link, self._wrench)

    def _publish(self) -> None:
        if self._wrenches.wanted:
            message = self.context.message("geometry_msgs/Wrench")
            fill_wrench(message, self._wrench)
            self._wrenches.publish(message)


def load_factor(gravity: Vec3, orientation: Quat) -> float:
    """1 / cos of the tilt, by which the thrust of a tilted body carries its weight."""
    along, square = dot(gravity, rotate(orientation, gravity)), dot(gravity, gravity)
    return square / along if abs(along) > 1e-6 * square else 0.0


def to_heading(yaw: float, vector: Vec3) -> Vec3:
    """A vector of the world in axes that turn with the yaw angle."""
    c, s = math.cos(yaw), math.sin(yaw)
    return c * vector[0] + s * vector[1], c * vector[1] - s * vector[0], vector[2]
