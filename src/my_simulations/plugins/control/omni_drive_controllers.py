"""cob_omni_drive_controller: bases that go in any direction on wheels that are driven and steered.

Parameters, topics, services and laws are those of the package of that name. Two differences: the
drive of a wheel that stands beside its steering axis is corrected by the rate of the steering (the
original takes its angle, so that such a wheel turns while the base stands), and the odometry counts
how far joints have turned, along arcs.
"""
from __future__ import annotations

import math
from typing import Any, List, Optional

from ..context import PluginError, Publication
from ..drive.odometry import planar_pose, planar_twist
from ..frames import stamp_message
from ..standard_messages import diagonal_covariance, odometry_message
from ..stepwise_change import StepwiseChange
from ..time_out import TimeOut
from .base_controller import STANDING, Planar, along_arc
from .controller import RUNNING, Controller
from .hardware import VELOCITY
from .omni_wheels import WheelState, WheelTarget, base_displacement, clamp, read_wheels

_UPDATE_HZ = 100.0
_STILL = 1e-4   # rad/s, of the steering
_MESSAGES = "cob_base_controller_utils/WheelCommands"


class WheelController(Controller):
    """Follows geometry_msgs/Twist on `command` until `timeout`."""

    def load(self) -> None:
        s = self.settings
        self._wheels = read_wheels(self.context, s, steered=True)
        self._steers = [self.claim_joint(VELOCITY, wheel.steer) for wheel in self._wheels]
        self._drives = [self.claim_joint(VELOCITY, wheel.drive) for wheel in self._wheels]
        self._most_turn = s.number("max_rot_velocity", 0.0)
        self._most_speed = s.number("max_trans_velocity", 0.0)
        timeout = s.number("timeout", 1.0)
        for name, value in (("max_rot_velocity", self._most_turn), ("timeout", timeout),
                            ("max_trans_velocity", self._most_speed)):
            if value < 0.0:
                raise PluginError(f"parameter {s.name}/{name} must not be negative")
        self._time_out = TimeOut(self.context, timeout if timeout else math.inf)
        self._command: Optional[Planar] = None   # that the targets are not made of yet
        self._commands: Optional[Publication] = None
        self._hertz = 1.0 / self.period if self.period else _UPDATE_HZ
        self._change = StepwiseChange(self.context, self._hertz, self._update)
        if s.number("pub_divider", 0.0) > 0.0:
            self._offer_commands()
        self.subscribe("command", "geometry_msgs/Twist", self._receive, checks=True)

    def _offer_commands(self) -> None:
        try:
            self._commands = self.publish("wheel_commands", _MESSAGES, 5)
        except PluginError as missing:
            self.context.warn(f"controller '{self.name}' does not publish wheel_commands:"
                              f" {missing}")

    def start(self) -> None:
        """Stop the base; keep the steering angles."""
        self._command, self._moving = None, False
        self._targets = [WheelTarget(joint.position, 0.0) for joint in self._steers]
        self._rates = [0.0] * len(self._wheels)
        self._steered = self._driven = self._deltas = self._rates
        self.stop()
        if self._commands is not None:
            self.observe(self._hertz, self._publish, [self._commands])

    def stop(self) -> None:
        self._change.end()
        for joint in (*self._steers, *self._drives):
            joint.command(0.0)

    def _receive(self, message: Any) -> None:
        """Follow a command; one that is not finite stops the base, as in the original."""
        wanted = (float(message.linear.x), float(message.linear.y), float(message.angular.z))
        if not all(map(math.isfinite, wanted)):
            self.context.warn(f"controller '{self.name}' stops the base: a command is not finite")
            wanted = STANDING
        self._command = (clamp(wanted[0], self._most_speed), clamp(wanted[1], self._most_speed),
                         clamp(wanted[2], self._most_turn))
        self._time_out.begin()
        self._change.begin()

    def _update(self, dt: float) -> bool:
        """Follow the command; return whether the base stands still."""
        angles = [joint.position for joint in self._steers]
        if self._moving and self._time_out.is_over:
            self._command = STANDING
        if self._command is not None:
            self._moving = self._command != STANDING
            self._targets = [
                wheel.target(self._command, angle, target.angle)
                for wheel, angle, target in zip(self._wheels, angles, self._targets)]
            self._command = None
        self._drive(angles, dt)
        stands = not self._moving and max(map(abs, self._rates)) < _STILL
        if stands:
            self.stop()
        return stands

    def _drive(self, angles: List[float], dt: float) -> None:
        steps = max(1, round(dt / self.context.step_size))
        self._deltas = [math.remainder(target.angle - angle, 2.0 * math.pi)
                        for target, angle in zip(self._targets, angles)]
        steered, driven, rates = [], [], []
        for n, (wheel, target) in enumerate(zip(self._wheels, self._targets)):
            assert wheel.steering is not None
            turned, rate = wheel.steering.advance(self._deltas[n], self._rates[n], dt, steps)
            rates.append(rate)
            steered.append(clamp(turned / dt, wheel.most_steer))
            driven.append(clamp(target.rate + steered[n] * wheel.drive_per_steer, wheel.most_drive))
            self._steers[n].command(steered[n])
            self._drives[n].command(driven[n])
        self._rates, self._steered, self._driven = rates, steered, driven

    def _publish(self) -> None:
        assert self._commands is not None
        message = stamp_message(self.context, _MESSAGES)
        message.drive_target_velocity = list(self._driven)
        message.steer_target_velocity = list(self._steered)
        message.steer_target_position = [target.angle for target in self._targets]
        message.steer_target_error = list(self._deltas)
        self._commands.publish(message)


class OdometryController(Controller):
    """Publishes `odometry` and its transform; `reset_odometry` begins at the origin again."""

    def load(self) -> None:
        s = self.settings
        self._wheels = read_wheels(self.context, s, steered=False)
        self._joints = [(self.hardware.state(wheel.steer), self.hardware.state(wheel.drive))
                        for wheel in self._wheels]
        self._publish_hz = s.number("publish_rate")
        if self._publish_hz <= 0.0:
            raise PluginError(f"parameter {s.name}/publish_rate must be positive")
        self._frames = (s.text("frame_id", "odom"), s.text("child_frame_id", "base_footprint"))
        self._covariances = [diagonal_covariance((s.number(f"cov_{what}", 0.1),) * 6)
                             for what in ("pose", "twist")]
        self._broadcasts = s.flag("broadcast_tf", True)
        self._odometry = self.publish("odometry", "nav_msgs/Odometry")
        self.serve("reset_odometry", "std_srvs/Trigger", self._reset)
        self._stopped_ns = -1
        self._pose = self._velocity = STANDING

    def start(self) -> None:
        """Begin at the origin, or at the last pose after a stop in the same step."""
        self._now_ns = self.context.now_ns
        if self._now_ns != self._stopped_ns:
            self._pose = STANDING
        self._velocity, self._states = STANDING, self._read()
        hertz = 1.0 / self.period if self.period else max(_UPDATE_HZ, self._publish_hz)
        self.observe(hertz, self._integrate_odometry, [self._odometry], transforms=self._broadcasts,
                     remembers=True)
        self.observe(self._publish_hz, self._publish, [self._odometry],
                     transforms=self._broadcasts)

    def stop(self) -> None:
        """Keep the pose."""
        self._stopped_ns = self.context.now_ns

    def _read(self) -> List[WheelState]:
        return [WheelState(steer.position, drive.position) for steer, drive in self._joints]

    def _integrate_odometry(self) -> None:
        """Integrate the odometry exactly along an arc."""
        now = self.context.now_ns
        dt, self._now_ns = (now - self._now_ns) * 1e-9, now
        if dt <= 0.0:
            return
        before, self._states = self._states, self._read()
        way = base_displacement(self._wheels, before, self._states)
        self._pose = along_arc(self._pose, way)
        self._velocity = (way[0] / dt, way[1] / dt, way[2] / dt)

    def _publish(self) -> None:
        pose = planar_pose(*self._pose)
        if self._broadcasts:
            self.context.transform(*self._frames, pose)
        if self._odometry.wanted:
            self._odometry.publish(odometry_message(
                self.context, self._frames, pose, planar_twist(self._velocity), self._covariances))

    def _reset(self, request: Any, response: Any) -> None:
        response.success = self.state == RUNNING
        if response.success:
            self._pose = STANDING
        else:
            response.message = "not running"
