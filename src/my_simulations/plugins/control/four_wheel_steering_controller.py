"""four_wheel_steering_controller: four wheels that are driven, and steered, on their own.

Joints, parameters, topics and commands are those of ros_controllers. The odometry is the motion of
the base that fits the rolling of all four wheels best (least squares); if the wheels agree, it
equals the odometry of the original.
"""
from __future__ import annotations

import math
from collections import deque
from typing import Any, Deque, List, NamedTuple, Sequence, Tuple

from ...geometry import Vec3
from ..context import PluginError, Publication
from ..frames import stamp_message
from .base_controller import BaseController, Planar
from .hardware import POSITION, VELOCITY, HardwareJoint
from .speed_limits import clamp

_HALF_TURN = math.pi / 2.0
_ALIKE = 0.01     # rad: angles of axles that go straight (ros_controllers)
_SLOWEST = 0.001  # m/s: below it wheels stand (ros_controllers)
_MESSAGES = "four_wheel_steering_msgs"


class Corner(NamedTuple):
    """A wheel: where its steering axis is from the middle of the wheels, m, and how far the wheel
    is outside of that axis, m; positive to the left.
    """

    x: float
    y: float
    offset: float


def corners_of(track: float, base: float, offset: float) -> List[Corner]:
    """Front left, front right, rear left, rear right, from lengths in m."""
    half = track / 2.0 - offset
    return [Corner(x, side * half, side * offset)
            for x in (base / 2.0, -base / 2.0) for side in (1.0, -1.0)]


def wheel_motions(corners: Sequence[Corner], motion: Planar) -> List[Tuple[float, float]]:
    """Return steering angle, -pi/2..pi/2 rad, and rim speed, m/s, of each wheel.

    Args:
        corners: the wheels.
        motion: velocity of the midpoint of the wheels.
    """
    x, y, yaw = motion
    found = []
    for corner in corners:
        u, v = x - yaw * corner.y, y + yaw * corner.x
        angle = math.atan(v / u) if abs(u) > 1e-12 else math.copysign(_HALF_TURN, v)
        if abs(u) <= 1e-12 and abs(v) <= 1e-12:
            angle = 0.0
        speed = math.copysign(math.hypot(u, v), x) - yaw * corner.offset
        found.append((angle, speed))
    return found


def fitted_motion(corners: Sequence[Corner], wheels: Sequence[Tuple[float, float]]) -> Planar:
    """Return the motion of the wheels' midpoint that fits (angle, rim speed) of all wheels best."""
    rows = []
    for corner, (angle, speed) in zip(corners, wheels):
        c, s = math.cos(angle), math.sin(angle)
        rows.append((corner.x - corner.offset * s, corner.y + corner.offset * c, speed * c,
                     speed * s))
    n = len(rows)
    mx, my, mu, mv = (sum(row[k] for row in rows) / n for k in range(4))
    spread = sum((x - mx) ** 2 + (y - my) ** 2 for x, y, _, _ in rows)
    yaw = sum((x - mx) * v - (y - my) * u for x, y, u, v in rows) / spread
    return mu + yaw * my, mv - yaw * mx, yaw


class FourWheelSteeringController(BaseController):
    """Joints `front_wheel`, `rear_wheel`, `front_steering`, `rear_steering`: left and right each.

    Commands: geometry_msgs/Twist on `cmd_vel`, or a speed and two angles on
    `cmd_four_wheel_steering`; the last one counts.
    """

    smooths = False

    def load_wheels(self) -> None:
        s = self.settings
        self.counted = self._pairs(VELOCITY, "front_wheel", "rear_wheel")
        self._steers = self._pairs(POSITION, "front_steering", "rear_steering")
        wheels = [self.context.joint(one.name).spec for one in self.counted]
        steer = self.context.joint(self._steers[0].name).spec
        at = [self.joint_location(joint) for joint in wheels]
        track = s.number("track", _distance(at[0], at[1]))
        base = s.number("wheel_base", _distance(at[0], at[2]))
        self._radius = self.wheel_radius(wheels[0])
        self._base, self._by_angles = base, False
        offset = _distance(at[0], self.joint_location(steer))
        self.positive(track=track, wheel_base=base, wheel_radius=self._radius,
                      steering_track=track - 2.0 * offset)
        self._corners = corners_of(track, base, offset)
        self._odom_steer = None
        try:
            self.subscribe("cmd_four_wheel_steering", f"{_MESSAGES}/FourWheelSteering",
                           self._receive_angles)
            self._odom_steer = self.publish("odom_steer", f"{_MESSAGES}/FourWheelSteeringStamped",
                                            100)
        except PluginError as missing:
            self.context.warn(f"controller '{self.name}' subscribes to cmd_vel only: {missing}")

    def _pairs(self, interface: str, *axles: str) -> List[HardwareJoint]:
        found: List[HardwareJoint] = []
        for axle in axles:
            names = self.settings.texts(axle)
            if len(names) != 2:
                raise PluginError(f"parameter {self.name}/{axle} must name a left and a right"
                                  f" joint, it names {len(names)}")
            found += [self.claim_joint(interface, name) for name in names]
        return found

    def _receive_angles(self, message: Any) -> None:
        if self.follow_command((float(message.speed), float(message.front_steering_angle),
                      float(message.rear_steering_angle))):
            self._by_angles = True

    def _receive(self, message: Any) -> None:
        if self.follow_twist(message):
            self._by_angles = False

    def limit(self, wanted: Planar, dt: float) -> Planar:
        """The speed within its limits; angles within a quarter turn, else the yaw rate."""
        speed, _, yaw = super().limit((wanted[0], 0.0, wanted[2]), dt)
        if not self._by_angles:
            return speed, 0.0, yaw
        return (speed, clamp(wanted[1], -_HALF_TURN, _HALF_TURN),
                clamp(wanted[2], -_HALF_TURN, _HALF_TURN))

    def drive(self, velocity: Planar) -> None:
        """Steer each wheel at right angles to the line to the centre of the turn, and drive it."""
        motions = self._by_two_angles(*velocity) if self._by_angles else self._by_twist(
            velocity[0], velocity[2])
        for wheel, steer, (angle, speed) in zip(self.counted, self._steers, motions):
            steer.command(angle)
            wheel.command(speed / self._radius)

    def _by_twist(self, x: float, yaw: float) -> List[Tuple[float, float]]:
        """Front and rear wheels are steered against each other."""
        if abs(x) <= _SLOWEST:
            return [(0.0, 0.0)] * 4
        found = wheel_motions(self._corners, (x, 0.0, yaw))
        if abs(x) > abs(yaw * self._corners[0].y):
            return found
        # The centre of the turn lies between the wheels.
        return [(math.copysign(_HALF_TURN, yaw * corner.x), speed)
                for corner, (_, speed) in zip(self._corners, found)]

    def _by_two_angles(self, speed: float, front: float, rear: float) -> List[Tuple[float, float]]:
        """Axles are steered by an angle each; the wheels of an axle stand for their own circles."""
        moving = speed if abs(speed) > _SLOWEST else 0.0
        if abs(front - rear) < _ALIKE:  # sideways: the speed is that along the wheels
            return [((front + rear) / 2.0, moving)] * len(self._corners)
        ahead, behind = math.tan(front), math.tan(rear)
        motion = (1.0, (ahead + behind) / 2.0, (ahead - behind) / self._base)
        angles = wheel_motions(self._corners, motion)
        return [(angle, rim * moving) for angle, rim in angles]

    def begin_count(self) -> None:
        super().begin_count()
        self._changes: Deque[Tuple[float, float, float, float]] = deque(maxlen=self.window)
        self._state = (0.0, 0.0, 0.0)

    def displacement(self, dt: float) -> Planar:
        """Return the motion of the base from rotation and steering angles of all wheels."""
        ways = [turn * self._radius for turn in self.count_rotations()]
        angles = [steer.position for steer in self._steers]
        found = fitted_motion(self._corners, list(zip(angles, ways)))
        self._record_axle_states(math.copysign(math.hypot(*found[:2]), found[0]) / dt, angles, dt)
        return found

    def _record_axle_states(self, speed: float, angles: List[float], dt: float) -> None:
        """Store the speed and axle angles, and their derivatives, for `odom_steer`."""
        state = (speed, _axle(angles[0], angles[1]), _axle(angles[2], angles[3]))
        changes = [(now - then) / dt for now, then in zip(state, self._state)]
        jerk = (changes[0] - self._changes[-1][0]) / dt if self._changes else 0.0
        self._changes.append((changes[0], jerk, changes[1], changes[2]))
        self._state = state

    def more_topics(self) -> List[Publication]:
        return [] if self._odom_steer is None else [self._odom_steer]

    def publish_more(self) -> None:
        """Publish speed and steering angle of each axle."""
        if self._odom_steer is None or not self._odom_steer.wanted or not self._changes:
            return
        means = [sum(one[k] for one in self._changes) / len(self._changes) for k in range(4)]
        message = stamp_message(self.context, f"{_MESSAGES}/FourWheelSteeringStamped", "odom")
        data = message.data
        data.speed, data.front_steering_angle, data.rear_steering_angle = self._state
        data.acceleration, data.jerk = means[:2]
        data.front_steering_angle_velocity, data.rear_steering_angle_velocity = means[2:]
        self._odom_steer.publish(message)


def _distance(one: Vec3, other: Vec3) -> float:
    """Along the ground, m."""
    return math.hypot(one[0] - other[0], one[1] - other[1])


def _axle(left: float, right: float) -> float:
    """The angle of a wheel in the middle of an axle: cotangents have their mean."""
    if abs(left) <= _SLOWEST and abs(right) <= _SLOWEST:
        return 0.0
    one, other = math.tan(left), math.tan(right)
    total = one + other
    return math.atan(2.0 * one * other / total) if abs(total) > 1e-12 else 0.0
