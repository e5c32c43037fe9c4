"""libgazebo_ros_kobuki.so: the base of TurtleBot 2, with bumper, cliff and wheel drop sensors.

Parameters, topics, frames and events are those of kobuki_gazebo_plugins. Where it differs: the way
comes from the positions of the wheels; an `<update_rate>` of 0 is 50 Hz, that of the real base. The
messages of events come from the package kobuki_msgs; without it the base drives all the same.
"""
from __future__ import annotations

import math
from typing import Any, Dict, List, Tuple

from ...geometry import compose, rpy_from_quat, scale
from ..context import PluginError, Publication
from ..frames import add_tf_prefix, stamp_message
from ..imu_meter import ImuMeter
from ..standard_messages import diagonal_covariance, imu_message
from ..time_out import Stopwatch
from .floor_rays import FloorRays, sensor_named
from .odometry import Odometer, WheelRotations, planar_pose
from .velocity_drive import VelocityDrive
from .wheels import WheelStates

_HERTZ = 50.0
_COVARIANCE = (0.1, 0.1, 1e6, 1e6, 1e6, 0.05)
_SIDES = ("left", "center", "right")
_BITS = {"left": 4, "center": 2, "right": 1}    # in kobuki_msgs/SensorState
_BUMPER_HEIGHT = (0.01, 0.13)                   # m above the base
_SECTOR = math.pi / 6.0                         # half of a bumper's arc
_READING, _READING_AT = 76123.0, 0.995          # of GazeboRosKobuki::updateCliffSensor


class Kobuki(VelocityDrive):
    """Two driven wheels, odometry, an IMU and the events of the base."""

    def load(self) -> None:
        context, p = self.enter_namespace(self.context.model)
        self._wheels = [context.joint(self.required_text(f"{side}_wheel_joint_name"))
                        for side in ("left", "right")]
        self._turns = WheelRotations(self._wheels)
        self._separation = self.required_number("wheel_separation")
        self._radius = self.required_number("wheel_diameter") / 2.0
        self._torque = self.required_number("torque")
        link, sensor = sensor_named(context, self.required_text("imu_name"))
        self._imu_link = context.link(link)
        # Gazebo's ImuSensor reports orientations relative to the one at loading.
        self._imu = ImuMeter(context, self._imu_link, sensor.pose, compose(
            self._imu_link.pose, sensor.pose).orientation)
        self._stopwatch = Stopwatch(context)
        self._odometer = Odometer(context, "odom", "odom", "base_footprint", _COVARIANCE)
        self._broadcasts = p.flag("publish_tf", False)
        self._states = WheelStates(context, self._wheels, motion=True,
                                   frame=add_tf_prefix(context, "base_link"))
        prefix = str(context.parameter("base_prefix", "mobile_base")).strip("/")
        hertz = p.number("update_rate", 0.0)
        hertz = hertz if hertz > 0.0 else _HERTZ
        self.follow_commands(hertz, f"{prefix}/commands/velocity",
                             p.number("velocity_command_timeout", 0.6))
        context.subscribe(f"{prefix}/commands/reset_odometry", "std_msgs/Empty",
                          lambda message: self._begin_count(), 10)
        self._imu_topic = context.publish(f"{prefix}/sensors/imu_data", "sensor_msgs/Imu")
        self._events = KobukiEvents(self, prefix)
        self._powered = True
        self.reset()
        context.observe(hertz, self.publish, transforms=self._broadcasts, remembers=True, topics=[
            *self._states.topics, *self._odometer.topics, self._imu_topic])
        self._events.publish_at(hertz)

    def required_number(self, name: str) -> float:
        """Return the number of a child element. Raises PluginError if it is not above 0."""
        text, found = self.required_text(name), self.context.parameters.positive(name, 0.0)
        if not found:
            raise PluginError(f"<{name}> must be a number above 0, it is {text!r}")
        return found

    def power(self, on: bool) -> None:
        self._powered = on
        self._change.begin()

    def restart_odometry(self) -> None:
        self._begin_count()
        self._turns.restart()
        self._heading = self._yaw()

    def clock_set(self) -> None:
        """Compute accelerations from the present time and velocity on."""
        super().clock_set()
        self._stopwatch.restart()
        self._imu.restart()
        self._events.clock_set()

    def _begin_count(self) -> None:
        self._place = (0.0, 0.0, 0.0)

    def _yaw(self) -> float:
        return rpy_from_quat(self._imu_link.pose.orientation)[2]

    def publish(self) -> None:
        """Publish joint states, odometry and IMU, as they are before the command of an update."""
        dt = self._stopwatch.lap()
        if dt <= 0.0:
            return
        self._states.send()
        self._publish_odometry(dt)
        self._publish_imu()

    def _publish_odometry(self, dt: float) -> None:
        """Publish odometry; the heading is that of the gyroscope, as on the real base."""
        way = sum(self._turns.rotations_since_last(dt)) * self._radius / 2.0
        last, self._heading = self._heading, self._yaw()
        turn = math.remainder(self._heading - last, 2.0 * math.pi)
        x, y, yaw = self._place
        self._place = (x + way * math.cos(yaw + turn / 2.0), y + way * math.sin(yaw + turn / 2.0),
                       yaw + turn)
        pose = planar_pose(*self._place)
        if self._broadcasts:
            self._odometer.transform(pose)
        self._odometer.publish(pose, (way / dt, 0.0, turn / dt))

    def _publish_imu(self) -> None:
        context, sample = self.context, self._imu.measure()
        if not self._imu_topic.wanted:
            return
        message = imu_message(context, add_tf_prefix(context, "base_link"), *sample)
        message.orientation_covariance = diagonal_covariance((1e6, 1e6, 0.05))
        message.angular_velocity_covariance = list(message.orientation_covariance)
        self._imu_topic.publish(message)

    def _drive(self) -> None:
        speeds = self._command.wheel_speeds(self._separation) if self._powered else (0.0, 0.0)
        for wheel, speed in zip(self._wheels, speeds):
            wheel.drive(speed / self._radius, self._torque)


class KobukiEvents:
    """Bumper, cliff and wheel drop events, and the state of all sensors."""

    def __init__(self, base: Kobuki, prefix: str) -> None:
        context = self._context = base.context
        self._rays = FloorRays(
            context, {side: sensor_named(context, base.required_text(f"cliff_sensor_{side}_name"))
                      for side in _SIDES}, self._receive_cliffs)
        self._edge = base.required_number("cliff_detection_threshold")
        self._bumper = sensor_named(context, base.required_text("bumper_name"))[0]
        self._drops = {
            side: sensor_named(context, base.required_text(f"wheel_drop_{side}_sensor_name"))[0]
            for side in ("left", "right")}
        self._pressed: Dict[str, bool] = dict.fromkeys(_SIDES, False)
        self._over: Dict[str, bool] = dict.fromkeys(_SIDES, False)
        self._dropped: Dict[str, bool] = dict.fromkeys(self._drops, False)
        self._bottoms = dict.fromkeys(_SIDES, 0)
        self._topics: Dict[str, Publication] = {}
        try:
            context.subscribe(f"{prefix}/commands/motor_power", "kobuki_msgs/MotorPower",
                              lambda message: base.power(bool(message.state)), 10)
            for name, kind in (("events/cliff", "CliffEvent"), ("events/bumper", "BumperEvent"),
                               ("events/wheel_drop", "WheelDropEvent"),
                               ("sensors/core", "SensorState")):
                self._topics[name] = context.publish(f"{prefix}/{name}", f"kobuki_msgs/{kind}")
        except PluginError as missing:
            context.warn(f"no bumper, cliff and wheel drop events: {missing}")

    def clock_set(self) -> None:
        """Discard pending rays after sim time was set."""
        self._rays.clock_set()

    def publish_at(self, hertz: float) -> None:
        """Publish at a rate in Hz while there are subscribers."""
        if not self._topics:
            return
        cliff, core = self._topics["events/cliff"], self._topics["sensors/core"]
        self._context.observe(hertz, self._rays.cast, [cliff, core], world=True)
        self._context.observe(
            hertz, self.update, [self._topics["events/bumper"], self._topics["events/wheel_drop"],
                                 core], resume=self._resume, contacts=True)

    def update(self) -> None:
        """Publish what differs from the last update, and the state of all sensors."""
        bumps, drops = self._contact_states()
        self._change("events/bumper", "bumper", "BumperEvent", self._pressed, bumps)
        self._change("events/wheel_drop", "wheel", "WheelDropEvent", self._dropped, drops)
        self._publish_state()

    def _resume(self) -> None:
        """Events are differences to the first update with subscribers."""
        self._pressed, self._dropped = self._contact_states()
        self._publish_state()

    def _contact_states(self) -> Tuple[Dict[str, bool], Dict[str, bool]]:
        """Which bumpers are pressed, and which wheels have dropped."""
        contacts, model = self._context.contacts(), self._context.model
        touching = {name for one, other, _ in contacts for name in (one, other)}
        return self._bumps(contacts), {side: f"{model}::{link}" not in touching
                                       for side, link in self._drops.items()}

    def _publish_state(self) -> None:
        core = self._topics["sensors/core"]
        if core.wanted:
            core.publish(self._state())

    def _bumps(self, contacts: List[Any]) -> Dict[str, bool]:
        """Which bumpers are pressed, by the direction of the contact."""
        found = dict.fromkeys(_SIDES, False)
        pose = self._context.pose
        heading = rpy_from_quat(pose.orientation)[2]
        mine = f"{self._context.model}::{self._bumper}"
        for one, other, contact in contacts:
            height = contact.position[2] - pose.position[2]
            if mine not in (one, other) or not (
                    _BUMPER_HEIGHT[0] <= height <= _BUMPER_HEIGHT[1]):
                continue
            x, y, _ = scale(contact.normal, -1.0 if one == mine else 1.0)
            angle = math.remainder(math.atan2(y, x) - heading, 2.0 * math.pi)
            if abs(angle) <= _SECTOR:
                found["center"] = True
            elif abs(angle) <= 3.0 * _SECTOR:
                found["left" if angle > 0.0 else "right"] = True
        return found

    def _receive_cliffs(self, distances: Dict[str, float]) -> None:
        self._bottoms = {side: _adc_value(distance) for side, distance in distances.items()}
        self._change("events/cliff", "sensor", "CliffEvent", self._over,
                     # nothing below is a cliff
                     {side: not distance < self._edge for side, distance in distances.items()})

    def _change(self, topic: str, field: str, kind: str, known: Dict[str, bool],
                now: Dict[str, bool]) -> None:
        """Publish an event for each side that is not as before."""
        for number, side in enumerate(known):
            if now[side] != known[side]:
                known[side] = now[side]
                message = self._context.message(f"kobuki_msgs/{kind}")
                setattr(message, field, number)
                message.state = int(now[side])
                if known is self._over:
                    message.bottom = self._bottoms[side]
                self._topics[topic].publish(message)

    def _state(self) -> Any:
        message = stamp_message(self._context, "kobuki_msgs/SensorState",
                                add_tf_prefix(self._context, "base_link"))
        message.bumper = sum(_BITS[side] for side, on in self._pressed.items() if on)
        message.cliff = sum(_BITS[side] for side, on in self._over.items() if on)
        message.wheel_drop = (2 if self._dropped["left"] else 0) + self._dropped["right"]
        return message


def _adc_value(distance: float) -> int:
    """Return the reading of the analogue-digital converter at a distance (m), 16 bits."""
    return int(_READING * math.atan2(_READING_AT, distance)) & 0xFFFF
