"""hector_quadrotor_controllers: position, velocity and attitude of a flying body.

Parameters, topics and laws are those of the package of that name. Where it differs: mass and
inertia are those of the simulated link; a marker of the commanded pose is not published; commands
to a controller that does not run are ignored.
"""
from __future__ import annotations

import math
from typing import Any, List, Optional

from ...engine.drive_commands import PidGains
from ...engine.servo_law import Pid
from ...geometry import Quat, Vec3, rpy_from_quat, subtract
from ..context import PluginError
from ..finite_messages import subscribe_finite
from ..frames import add_tf_prefix, resolve_frame
from .controller import RUNNING, Controller
from .quadrotor_hardware import (
    AttitudeCommand,
    QuadrotorHardware,
    TwistCommand,
    VectorLimits,
    read_limits,
)

_GRAVITY = 9.8065   # m/s^2, of the controllers
_POSITION, _VELOCITY, _ATTITUDE = range(3)   # places in the chain


class _QuadrotorController(Controller):
    """What the three have in common."""

    place = _POSITION
    hardware: QuadrotorHardware

    def load(self) -> None:
        if not isinstance(self.hardware, QuadrotorHardware):
            raise PluginError(f"controller '{self.name}' needs the <robotSimType>"
                              " hector_quadrotor_controller_gazebo/QuadrotorHardwareSim")
        self._pids: List[Pid] = []
        self._world = self._resolve_frame("world_frame", "/world")
        self._stabilized = self._resolve_frame("base_stabilized_frame", "base_stabilized")

    def _resolve_frame(self, parameter: str, default: str) -> str:
        return add_tf_prefix(self.context, str(self.context.parameter(parameter, default)))

    def pid(self, path: str) -> Pid:
        made = Pid(self.settings.gains(path) or PidGains(0.0))
        self._pids.append(made)
        return made

    def listen(self, topic: str, kind: str, call: Any) -> None:
        """Subscribe to a topic of the robot; a message counts while the controller runs."""
        self.keep_handle(subscribe_finite(
            self.context, topic, kind,
            lambda message: call(message) if self.state == RUNNING else None))

    def stamp_of(self, message: Any) -> int:
        """Sim time of a message in ns; now if it has none."""
        return int(message.header.stamp.to_nsec()) or self.context.now_ns

    def frame_of(self, message: Any) -> str:
        """The frame of a message, under the prefix of tf."""
        prefix = str(self.context.search_parameter("tf_prefix", "") or "")
        return resolve_frame(prefix, message.header.frame_id)

    def start(self) -> None:
        """Add this controller to the chain of commands."""
        self.begin()
        self.hardware.join(self.place, self.update, self.begin, self.period)

    def stop(self) -> None:
        """Remove this controller from the chain of commands."""
        self.hardware.leave(self.place)

    def begin(self) -> None:
        """Clear commands and errors."""
        for pid in self._pids:
            pid.integral, pid.error = 0.0, None

    def update(self, dt: float) -> None:
        """Compute the output; `dt` s have passed since the last call."""
        raise NotImplementedError


class PositionController(_QuadrotorController):
    """Computes a velocity in the world frame from the pose on `command/pose`."""

    place = _POSITION

    def load(self) -> None:
        super().load()
        self._axes = [self.pid(axis) for axis in "xyz"]
        self._yaw_pid = self.pid("yaw")
        self._limits = VectorLimits(self.settings)
        self._most: Optional[TwistCommand] = None
        self.listen("command/pose", "geometry_msgs/PoseStamped", self._receive_pose)
        self.listen("command/twist_limit", "geometry_msgs/Twist", self._receive_limit)

    def begin(self) -> None:
        """Clear the commanded pose."""
        super().begin()
        self._wanted: Optional[Vec3] = None
        self.hardware.twist, self.hardware.preempted = None, False

    def stop(self) -> None:
        """Clear the command to the next controller."""
        self.begin()
        super().stop()

    def _receive_pose(self, message: Any) -> None:
        if self.frame_of(message) != self._world:
            self.context.warn(f"poses must be given in the frame {self._world}; one in"
                              f" '{message.header.frame_id}' is ignored")
            return
        at, turn = message.pose.position, message.pose.orientation
        quat: Quat = (turn.x, turn.y, turn.z, turn.w)
        self._wanted, self._wanted_yaw = (at.x, at.y, at.z), rpy_from_quat(quat)[2]
        self.hardware.preempted = False

    def _receive_limit(self, message: Any) -> None:
        linear = message.linear
        self._most = TwistCommand((linear.x, linear.y, linear.z), message.angular.z)

    def update(self, dt: float) -> None:
        """Command a velocity towards the pose."""
        if self.hardware.preempted:
            self.begin()
        if self._wanted is None:
            return
        pose = self.hardware.link.pose
        lack = subtract(self._limits.clamp(self._wanted), pose.position)
        x, y, z = (pid.command(error, dt) for pid, error in zip(self._axes, lack))
        turn = math.remainder(self._wanted_yaw - self.hardware.yaw, 2.0 * math.pi)
        command = TwistCommand((x, y, z), self._yaw_pid.command(turn, dt), self.context.now_ns)
        self.hardware.twist = (command if self._most is None
                               else limit_velocity(command, self._most))


def limit_velocity(command: TwistCommand, most: TwistCommand) -> TwistCommand:
    """Limit the horizontal velocity, that along z and the yaw rate; a limit of 0 means none."""
    (x, y, z), yaw_rate = command.linear, command.yaw_rate
    across, most_across = math.hypot(x, y), max(most.linear[:2])
    if 0.0 < most_across < across:
        x, y = x * most_across / across, y * most_across / across
    if 0.0 < most.linear[2] < abs(z):
        z = math.copysign(most.linear[2], z)
    if 0.0 < most.yaw_rate < abs(yaw_rate):
        yaw_rate = math.copysign(most.yaw_rate, yaw_rate)
    return command._replace(linear=(x, y, z), yaw_rate=yaw_rate)


class VelocityController(_QuadrotorController):
    """Computes attitude and thrust from `cmd_vel`, `command/twist` or the position controller."""

    place = _VELOCITY

    def load(self) -> None:
        super().load()
        self._axes = [self.pid(axis) for axis in "xyz"]
        self._limits = VectorLimits(self.settings)
        self._yaw_limits = read_limits(self.settings, "yawrate/z")
        self._most_load = self.settings.number("limits/load_factor", 1.5)
        self.listen("cmd_vel", "geometry_msgs/Twist", self._receive)
        self.listen("command/twist", "geometry_msgs/TwistStamped", self._receive_stamped)

    def begin(self) -> None:
        super().begin()
        self._command = TwistCommand()

    def stop(self) -> None:
        """Clear the command to the next controller."""
        self.hardware.attitude = None
        super().stop()

    def _receive(self, message: Any) -> None:
        self._set_command(message, self.context.now_ns, False)

    def _receive_stamped(self, message: Any) -> None:
        frame = self.frame_of(message)
        if frame not in (self._world, self._stabilized):
            self.context.warn(f"velocities must be given in the frame {self._stabilized} or"
                              f" {self._world}; one in '{message.header.frame_id}' is ignored")
            return
        self._set_command(message.twist, self.stamp_of(message), frame == self._world)

    def _set_command(self, twist: Any, stamp_ns: int, in_world: bool) -> None:
        linear = (twist.linear.x, twist.linear.y, twist.linear.z)
        self._command = TwistCommand(linear, twist.angular.z, stamp_ns, in_world)
        if any((*linear, twist.angular.x, twist.angular.y, twist.angular.z)):
            self.hardware.preempted = True

    def update(self, dt: float) -> None:
        """Command an attitude and a thrust."""
        hardware = self.hardware
        if hardware.twist is not None and not hardware.preempted:
            self._command = hardware.twist
        command, yaw = self._command, hardware.yaw
        c, s = math.cos(yaw), math.sin(yaw)
        x, y, z = self._limits.clamp(command.linear)
        if not command.in_world:
            x, y = c * x - s * y, s * x + c * y
        lack = subtract((x, y, z), hardware.link.twist.linear)
        ax, ay, az = (pid.command(error, dt) for pid, error in zip(self._axes, lack))
        forward, left = c * ax + s * ay, c * ay - s * ax
        hardware.attitude = AttitudeCommand(
            -_arc_sine(left / _GRAVITY), _arc_sine(forward / _GRAVITY),
            self._yaw_limits.clamp(command.yaw_rate),
            hardware.link.inertial.mass * (az * self._load_factor() + _GRAVITY), command.stamp_ns)

    def _load_factor(self) -> float:
        """1 / cos of the tilt, within its limit."""
        x, y, z, w = self.hardware.link.pose.orientation
        upright = w * w - x * x - y * y + z * z
        if self._most_load > 0.0 and (upright <= 0.0 or 1.0 / upright > self._most_load):
            return self._most_load
        return 1.0 / upright if upright != 0.0 else 1.0


class AttitudeController(_QuadrotorController):
    """From `command/attitude`, `command/yawrate`, `command/thrust` or a velocity controller to a
    wrench.

    A command that is older than `command_timeout`, and `estop`, level the body and lower its thrust
    by `estop_deceleration`.
    """

    place = _ATTITUDE

    def load(self) -> None:
        super().load()
        context, s = self.context, self.settings
        self._roll_pid, self._pitch_pid, self._yaw_pid = map(self.pid, ("roll", "pitch", "yawrate"))
        self._roll_limits, self._pitch_limits = read_limits(s, "roll"), read_limits(s, "pitch")
        self._most_tilt = s.number("max_roll_pitch", math.inf)
        self._yaw_limits = read_limits(s, "yawrate")
        self._time_out_ns = round(float(context.parameter("command_timeout", 0.0)) * 1e9)
        self._deceleration = float(context.parameter("estop_deceleration", 1.0))
        self._stopped = False
        self.listen("estop", "std_msgs/Bool", self._receive_stop)
        try:
            for name in ("Attitude", "Yawrate", "Thrust"):
                self.listen(f"command/{name.lower()}", f"hector_uav_msgs/{name}Command",
                            getattr(self, f"_receive_{name.lower()}"))
        except PluginError as missing:
            context.info(f"no commands of attitude by topics: {missing}")

    def begin(self) -> None:
        """Level, without thrust."""
        super().begin()
        self._command = AttitudeCommand()
        self._stamps = [0, 0, 0]
        self._sinking: Optional[float] = None

    def stop(self) -> None:
        """Remove the force and the torque."""
        self.hardware.command(((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))
        super().stop()

    def _receive_stop(self, message: Any) -> None:
        self._stopped = bool(message.data)

    def _receive_attitude(self, message: Any) -> None:
        self._command = self._command._replace(roll=message.roll, pitch=message.pitch)
        self._stamps[0] = self.stamp_of(message)

    def _receive_yawrate(self, message: Any) -> None:
        self._command = self._command._replace(yaw_rate=message.turnrate)
        self._stamps[1] = self.stamp_of(message)

    def _receive_thrust(self, message: Any) -> None:
        self._command = self._command._replace(thrust=message.thrust)
        self._stamps[2] = self.stamp_of(message)

    def update(self, dt: float) -> None:
        """Apply a force and a torque to the body."""
        hardware = self.hardware
        if hardware.attitude is not None:
            self._command = hardware.attitude
            self._stamps = [hardware.attitude.stamp_ns] * 3
        roll, pitch, yaw_rate, thrust = self._limit_command(dt)
        # The acceleration that the command asks for, in axes that turn with the yaw.
        ahead, left, yaw = math.sin(pitch), -math.sin(roll), hardware.yaw
        c, s = math.cos(yaw), math.sin(yaw)
        x, y, _ = hardware.to_body((c * ahead - s * left, s * ahead + c * left, 1.0))
        spin = hardware.to_body(hardware.link.twist.angular)
        inertial = hardware.link.inertial
        torque = (inertial.ixx * self._roll_pid.command(-y, dt),
                  inertial.iyy * self._pitch_pid.command(x, dt),
                  inertial.izz * self._yaw_pid.command(yaw_rate - spin[2], dt))
        hardware.command(((0.0, 0.0, thrust), torque))

    def _limit_command(self, dt: float) -> "tuple[float, float, float, float]":
        """Roll, pitch, yaw rate and thrust now, within their limits, or those of a stop."""
        command, now = self._command, self.context.now_ns
        late = self._time_out_ns > 0 and now > min(self._stamps) + self._time_out_ns
        if self._stopped or late:
            thrust = command.thrust if self._sinking is None else self._sinking
            self._sinking = max(0.0, thrust - self._deceleration
                                * self.hardware.link.inertial.mass * dt)
            return 0.0, 0.0, 0.0, self._sinking
        self._sinking = None
        roll = self._roll_limits.clamp(command.roll)
        pitch = self._pitch_limits.clamp(command.pitch)
        tilt = math.hypot(roll, pitch)
        if tilt > self._most_tilt:
            roll, pitch = roll * self._most_tilt / tilt, pitch * self._most_tilt / tilt
        return roll, pitch, self._yaw_limits.clamp(command.yaw_rate), command.thrust


def _arc_sine(value: float) -> float:
    return math.asin(max(-1.0, min(1.0, value)))
