"""libgazebo_ros_create.so: the base of the first TurtleBot, iRobot Create.

Topics, frames and laws are those of hector_gazebo_plugins, gazebo_ros_create.cpp. The original
publishes in every step and ignores `<updateRate>`; here that is the rate, if there is one. It takes
contacts in the world frame, which is right only where the robot was spawned; here they are in the
base. The message of the sensors comes from the package create_node; without it the base drives all
the same.
"""
from __future__ import annotations

import math
from typing import Dict, List, Optional

from ...geometry import inverse, transform
from ..context import Context, Joint, PluginError
from ..frames import stamp_message
from ..time_out import Stopwatch
from .floor_rays import FloorRays, sensor_named
from .odometry import Odometer, WheelCounter
from .velocity_drive import VelocityDrive
from .wheels import WheelStates

_COVARIANCE = (1e-3, 1e-3, 1e6, 1e6, 1e6, 1e3)
_PATIENCE = 0.6                                 # s, for the next command
_WALL, _CLIFF = 0.04, 0.02                      # m: nearer is a wall, farther a cliff
_BUMPER_X, _BUMPER_HEIGHT = 0.012, (0.01, 0.06)  # m, in the base
_OVERLAP = 0.16495 * math.sin(math.radians(10.0))   # m, of the two halves of the bumper
_RIGHT, _LEFT = 1, 2                            # bits of create_node/TurtlebotSensorState
_CLIFFS = {"left_cliff_sensor": "cliff_left", "leftfront_cliff_sensor": "cliff_front_left",
           "rightfront_cliff_sensor": "cliff_front_right", "right_cliff_sensor": "cliff_right"}


class Create(VelocityDrive):
    """Two driven wheels, two castors, a bumper, and rays to the wall and the floor."""

    def load(self) -> None:
        context, p = self.context, self.context.parameters
        context.use_namespace(p.text("node_namespace"))
        left, right = (context.joint(p.text(f"{side}_wheel_joint", f"{side}_wheel_joint"))
                       for side in ("left", "right"))
        self._wheels = (left, right)
        self._separation = p.positive("wheel_separation", 0.34)
        self._radius = p.positive("wheel_diameter", 0.15) / 2.0
        self._torque = p.number("torque", 10.0)
        self._counter = WheelCounter(left, right, self._radius, self._separation)
        self._odometer = Odometer(context, "/odom", "odom", "base_footprint", _COVARIANCE,
                                  _COVARIANCE)
        self._states = WheelStates(context, [left, right, *self._castors()], motion=True,
                                   topic="/joint_states", queue=1)
        hertz = p.number("updateRate", 0.0)
        self.follow_commands(hertz, "cmd_vel", _PATIENCE)
        self._sensors: Optional[CreateSensors] = None
        try:
            self._sensors = CreateSensors(context, left.parent, hertz)
        except PluginError as missing:
            context.warn(f"no bumper, cliff and wall sensors: {missing}")
        self._stopwatch = Stopwatch(context)
        self.reset()
        context.observe(hertz, self._publish, [*self._odometer.topics, *self._states.topics],
                        remembers=True)

    def _castors(self) -> List[Joint]:
        """The joints of the castors that the model has."""
        p = self.context.parameters
        names = [p.text(f"{place}_castor_joint", f"{place}_castor_joint")
                 for place in ("front", "rear")]
        moving = {one.name for one in self.context.description.joints if one.type != "fixed"}
        return [self.context.joint(name) for name in names if name in moving]

    def restart_odometry(self) -> None:
        self._counter.reset()

    def clock_set(self) -> None:
        """Count from the present time on."""
        super().clock_set()
        self._stopwatch.restart()
        if self._sensors is not None:
            self._sensors.clock_set()

    def _drive(self) -> None:
        for wheel, speed in zip(self._wheels, self._command.wheel_speeds(self._separation)):
            wheel.drive(speed / self._radius, self._torque)

    def _publish(self) -> None:
        velocity = self._counter.count(self._stopwatch.lap())
        self._odometer.publish(self._counter.pose, velocity)
        self._states.send()


class CreateSensors:
    """Publishes create_node/TurtlebotSensorState: bumper, cliffs, wall.

    Args:
        context: of the plugin.
        base: the link with the bumper.
        hertz: of the messages; 0 is every step.
    """

    def __init__(self, context: Context, base: str, hertz: float) -> None:
        self._context, self._base = context, context.link(base)
        self._scoped = context.scoped(base)
        self._rays = FloorRays(context, {name: sensor_named(context, name)
                                         for name in ("wall_sensor", *_CLIFFS)}, self._receive)
        self._distances: Dict[str, float] = {}
        self._topic = context.publish("sensor_state", "create_node/TurtlebotSensorState")
        context.observe(hertz, self._rays.cast, [self._topic], world=True)
        context.observe(hertz, self._publish, [self._topic], contacts=True)

    def clock_set(self) -> None:
        self._rays.clock_set()

    def _receive(self, distances: Dict[str, float]) -> None:
        self._distances = distances

    def _publish(self) -> None:
        """Publish the last distances of the rays and the present contacts."""
        if not self._distances:
            return
        message = stamp_message(self._context, "create_node/TurtlebotSensorState")
        message.wall = self._distances["wall_sensor"] < _WALL
        for sensor, field in _CLIFFS.items():
            setattr(message, field, self._distances[sensor] > _CLIFF)
        message.bumps_wheeldrops = self._bumps()
        self._topic.publish(message)

    def _bumps(self) -> int:
        """Which halves of the bumper are pressed, as bits."""
        found, to_base = 0, inverse(self._base.pose)
        for one, other, contact in self._context.contacts():
            if self._scoped not in (one, other):
                continue
            x, y, z = transform(to_base, contact.position)
            if x > _BUMPER_X and _BUMPER_HEIGHT[0] < z < _BUMPER_HEIGHT[1]:
                found |= (_RIGHT if y <= _OVERLAP else 0) | (_LEFT if y >= -_OVERLAP else 0)
        return found
