"""libaudibot_interface_plugin.so: the car of audibot_gazebo.

Names, topics and laws are those of audibot_gazebo's AudibotInterfacePlugin. Where it differs: laws
are computed at 100 Hz, not in every step; brakes and rolling resistance are friction, so that a
braked car stands still on a slope.
"""
from __future__ import annotations

import math
from typing import Any, List

from ...engine.drive_commands import JointServo
from ...geometry import conjugate, rotate
from ...geometry_messages import fill_pose
from ..base import Plugin
from ..context import Joint
from ..finite_messages import subscribe_finite
from ..frames import data_message, stamp_message
from ..time_out import TimeOut
from .wheels import apply_torque

_HERTZ, _FEEDBACK_HERTZ = 100.0, 50.0
_PATIENCE = 0.25                      # s, for the next throttle and brake
_STEERING_RATIO = 17.3                # steering wheel by front wheel
_MOST_STEERING = math.pi * 3.2 / _STEERING_RATIO           # rad, of a front wheel
_STEERING_RATE = math.radians(800.0) / _STEERING_RATIO     # rad/s
_WHEELBASE, _TRACK, _RADIUS = 2.65, 1.638, 0.36            # m
_ROLLING = 0.01 * 1700.0 * 9.81       # N m: rolling resistance of all wheels
_DRAG = 0.35                          # N s^2/m^2
_MOST_BRAKE = 8000.0                  # N m
_ENGINE, _FORWARD_LOSS, _REVERSE_LOSS = 4000.0, 40.1, 250.0   # N m; N s
_DRIVE, _REVERSE = 0, 1               # gears
_TILTED = 0.2                         # x or y of a quaternion: the car has rolled over
_TILTED_BRAKE = 1000.0                # N m s


class Audibot(Plugin):
    """Follows topics for throttle, brake, steering and gear, and reports its motion."""

    def load(self) -> None:
        context, p = self.context, self.context.parameters
        name = p.text("robotName")
        context.use_namespace(name)
        self._rear = self._joints("wheel_r{}_joint")
        self._front = self._joints("wheel_f{}_joint")
        self._steering = self._joints("steer_f{}_joint")
        self._footprint = context.link("base_footprint")
        self._frame = f"{name}/base_footprint" if name else "base_footprint"
        self._throttle_time, self._brake_time = (TimeOut(context, _PATIENCE) for _ in range(2))
        subscribe_finite(context, "steering_cmd", "std_msgs/Float64", self._receive_steering)
        subscribe_finite(context, "throttle_cmd", "std_msgs/Float64", self._receive_throttle)
        subscribe_finite(context, "brake_cmd", "std_msgs/Float64", self._receive_brake)
        context.subscribe("gear_cmd", "std_msgs/UInt8", self._receive_gear)
        self._twist = context.publish("twist", "geometry_msgs/TwistStamped")
        self._gear_state = context.publish("gear_state", "std_msgs/UInt8")
        self._odom = context.publish("odom", "nav_msgs/Odometry")
        self._steering_state = context.publish("steering_state", "std_msgs/Float64")
        self.reset()
        context.every(_HERTZ, self._drive)
        context.observe(_FEEDBACK_HERTZ, self._publish, [
            self._twist, self._gear_state, self._odom, self._steering_state])
        if p.flag("pubTf", False):
            context.observe(p.positive("tfFreq", 100.0), self._broadcast, transforms=True)

    def reset(self) -> None:
        self._throttle = self._brake = self._target = self._angle = 0.0
        self._gear = _DRIVE
        self._drive()

    def _joints(self, name: str) -> List[Joint]:
        return [self.context.joint(name.format(side)) for side in "lr"]

    def _receive_steering(self, message: Any) -> None:
        """`data` is the angle of the steering wheel, rad."""
        self._target = max(-_MOST_STEERING, min(_MOST_STEERING, message.data / _STEERING_RATIO))

    def _receive_throttle(self, message: Any) -> None:
        self._throttle = max(0.0, min(1.0, message.data))
        self._throttle_time.begin()

    def _receive_brake(self, message: Any) -> None:
        """`data` is the torque of all wheels, N m."""
        self._brake = max(0.0, min(_MOST_BRAKE, message.data))
        self._brake_time.begin()

    def _receive_gear(self, message: Any) -> None:
        if message.data > _REVERSE:
            self.context.warn(f"there is no gear {message.data}: 0 drives, 1 reverses")
        else:
            self._gear = message.data

    def _speed(self) -> float:
        """Along the x axis of the car, m/s."""
        return rotate(conjugate(self._footprint.pose.orientation),
                      self._footprint.twist.linear)[0]

    def _drive(self) -> None:
        self._steer()
        speed = self._speed()
        x, y = self._footprint.pose.orientation[:2]
        if abs(x) > _TILTED or abs(y) > _TILTED:
            for wheel in (*self._front, *self._rear):
                apply_torque(wheel, 0.0, _TILTED_BRAKE * abs(wheel.velocity))
            return
        brake = 0.0 if self._brake_time.is_over else self._brake
        friction = 0.25 * (_ROLLING + _DRAG * speed * speed * _RADIUS + brake)
        torque = self._engine_torque(speed) if brake == 0.0 else 0.0
        for wheel in self._front:
            apply_torque(wheel, 0.0, friction)
        for wheel in self._rear:
            apply_torque(wheel, 0.5 * torque, friction)

    def _engine_torque(self, speed: float) -> float:
        """Of both rear wheels, N m."""
        if self._throttle_time.is_over:
            return 0.0
        if self._gear == _DRIVE:
            return max(0.0, self._throttle * _ENGINE - _FORWARD_LOSS * speed)
        return min(0.0, -self._throttle * _ENGINE - _REVERSE_LOSS * speed)

    def _steer(self) -> None:
        """Turn the front wheels so that the axes of all wheels meet in a point (Ackermann)."""
        most = _STEERING_RATE / _HERTZ
        self._angle += max(-most, min(most, self._target - self._angle))
        tangent = math.tan(self._angle)
        for joint, side in zip(self._steering, (-1.0, 1.0)):
            angle = math.atan(_WHEELBASE * tangent / (_WHEELBASE + side * 0.5 * _TRACK * tangent))
            joint.set_servo(JointServo(0, "position", target=angle))

    def _publish(self) -> None:
        context, pose, twist = self.context, self._footprint.pose, self._footprint.twist
        message = stamp_message(context, "geometry_msgs/TwistStamped", self._frame)
        message.twist.linear.x = self._speed()
        message.twist.angular.z = rotate(conjugate(pose.orientation), twist.angular)[2]
        self._twist.publish(message)
        odom = stamp_message(context, "nav_msgs/Odometry", self._frame)
        odom.twist.twist = message.twist
        fill_pose(odom.pose.pose, pose)
        self._odom.publish(odom)
        self._gear_state.publish(data_message(context, "std_msgs/UInt8", self._gear))
        self._steering_state.publish(data_message(
            context, "std_msgs/Float64", _STEERING_RATIO * self._angle))

    def _broadcast(self) -> None:
        self.context.transform("world", self._frame, self._footprint.pose)
