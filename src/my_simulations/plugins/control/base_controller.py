"""What controllers of wheeled bases share: commands that grow old, limits, odometry, tf.

Parameters, topics and limits are those of ros_controllers. While the velocity changes, updates
come 100 times a second of sim time, or as often as `controlPeriod` says; ramps are exact to that.
Odometry is integrated exactly along arcs, as often as it is published.
"""
from __future__ import annotations

import math
from collections import deque
from typing import Any, Deque, List, Sequence, Tuple

from ...description.model import Joint as JointSpec
from ...description.shapes import Cylinder, Sphere
from ...geometry import Vec3
from ..call_slot import CallSlot
from ..context import PluginError, Publication
from ..drive.odometry import planar_pose, planar_twist
from ..frames import stamp_message
from ..standard_messages import diagonal_covariance, odometry_message
from ..stepwise_change import StepwiseChange
from ..time_out import TimeOut
from .controller import Controller
from .hardware import HardwareJoint
from .limits import joint_origin
from .speed_limits import read_speed_limits

_UPDATE_HZ = 100.0
_ORIGINAL_HZ = 1000.0

Planar = Tuple[float, float, float]
"""Along x and y of the base, and about its z: m/s and rad/s, or m and rad."""

STANDING: Planar = (0.0, 0.0, 0.0)


def along_arc(pose: Planar, displacement: Planar) -> Planar:
    """Return the pose after a displacement along an arc of a circle: m, m, rad.

    Args:
        pose: of the base before.
        displacement: in the axes that the base has at the start.
    """
    (x, y, yaw), (forward, sideways, turn) = pose, displacement
    half = turn / 2.0
    chord = math.sin(half) / half if abs(half) > 1e-9 else 1.0
    c, s = chord * math.cos(yaw + half), chord * math.sin(yaw + half)
    return x + c * forward - s * sideways, y + s * forward + c * sideways, yaw + turn


class BaseController(Controller):
    """Subscribes to `cmd_vel`; publishes `odom` and the transform from odom to the base.

    Attributes:
        open_loop: odometry integrates the commands, else the rotation of the wheels.
        smooths: the published velocity is the mean of the last ones.
        goes_sideways: a command's `linear.y` is used.
        publish_hz, hertz: how often odometry is published, and commands are applied, Hz.
        broadcasts: whether the transform is published.
        counted: the joints whose rotation gives the odometry.
    """

    counted: Sequence[HardwareJoint] = ()

    smooths = True
    goes_sideways = False

    # -- for subclasses ----------------------------------------------------------------------------

    def load_wheels(self) -> None:
        """Read the geometry; claim the joints."""
        raise NotImplementedError

    def drive(self, velocity: Planar) -> None:
        """Drive the wheels so that the base moves with a velocity."""
        raise NotImplementedError

    def begin_count(self) -> None:
        """Store the positions of `counted` as the start of the odometry."""
        self._turned = [joint.position for joint in self.counted]

    def count_rotations(self) -> List[float]:
        """Return how far each of `counted` has turned since the last call, rad."""
        before = self._turned
        BaseController.begin_count(self)
        return [now - then for now, then in zip(self._turned, before)]

    def displacement(self, dt: float) -> Planar:
        """Return the motion of the base in the last `dt` s from its wheels: m, m, rad."""
        raise NotImplementedError

    def limit(self, wanted: Planar, dt: float) -> Planar:
        """Return a command within the limits."""
        found = [limits.limit(new, last, before, dt) for limits, new, last, before in zip(
            self.limits, wanted, self.last, self.before)]
        return found[0], found[1], found[2]

    def publish_more(self) -> None:
        """Publish further messages with the odometry."""

    def more_topics(self) -> List[Publication]:
        return []

    # -- Controller --------------------------------------------------------------------------------

    def load(self) -> None:
        s = self.settings
        self.load_wheels()
        self.publish_hz = s.number("publish_rate", 50.0)
        self.open_loop = s.flag("open_loop", False)
        self._time_out = TimeOut(self.context, s.number("cmd_vel_timeout", 0.5))
        self.limits = tuple(read_speed_limits(s, path)
                            for path in ("linear/x", "linear/y", "angular/z"))
        self.hertz = 1.0 / self.period if self.period else max(_UPDATE_HZ, self.publish_hz)
        self._change = StepwiseChange(self.context, self.hertz, self._update)
        self._expiry = CallSlot()   # of the last command
        self._count_hz = self.hertz if self.period else self.publish_hz or _UPDATE_HZ
        window = s.number("velocity_rolling_window_size", 10.0) * self._count_hz / _ORIGINAL_HZ
        self.window = max(1, round(window))
        self._frames = (s.text("odom_frame_id", "odom"), s.text("base_frame_id", "base_link"))
        self.broadcasts = s.flag("enable_odom_tf", True)
        self._covariances = [
            diagonal_covariance(s.numbers(f"{what}_covariance_diagonal", 6, [0.0] * 6))
            for what in ("pose", "twist")]
        self._odom = self.publish("odom", "nav_msgs/Odometry", 100)
        self._limited = self.publish("cmd_vel_out", "geometry_msgs/TwistStamped", 100) \
            if s.flag("publish_cmd", False) else None
        self.command, self._reported_nonfinite = STANDING, False
        self.subscribe("cmd_vel", "geometry_msgs/Twist", self._receive, checks=True)
        self._pose: Planar = STANDING

    def start(self) -> None:
        """Stop the base, and restart the odometry."""
        self.command = STANDING
        self.last = self.before = STANDING
        self._velocities: Deque[Planar] = deque(maxlen=self.window if self.smooths else 1)
        self.begin_count()
        self._now_ns = self.context.now_ns
        self.drive(STANDING)
        self.observe_all()

    def observe_all(self) -> None:
        """Begin the odometry and what the controller publishes."""
        topics = [self._odom, *self.more_topics()]
        self.observe(self._count_hz, self._integrate_odometry, topics, transforms=self.broadcasts,
                     remembers=True)
        if self._limited is not None:
            self.observe(self.hertz, self._publish_command, [self._limited])
        if self.publish_hz > 0.0:
            self.observe(self.publish_hz, self._publish_odometry, topics,
                         transforms=self.broadcasts)

    def stop(self) -> None:
        self._expiry.end()
        self._change.end()
        self.drive(STANDING)

    def _receive(self, message: Any) -> None:
        self.follow_twist(message)

    def follow_twist(self, message: Any) -> bool:
        """Follow a geometry_msgs/Twist; see `follow_command`."""
        return self.follow_command((float(message.linear.x),
                          float(message.linear.y) if self.goes_sideways else 0.0,
                          float(message.angular.z)))

    def follow_command(self, command: Planar) -> bool:
        """Follow a command from now on; ignore one that is not finite, and warn once."""
        finite = all(map(math.isfinite, command))
        if finite:
            self.command = command
            self._time_out.begin()
            self._expiry.set(self._change.begin_after(self.context.now_ns + self._time_out.ns))
            self._change.begin()
        elif not self._reported_nonfinite:
            self._reported_nonfinite = True
            self.context.warn(f"controller '{self.name}' ignores commands that are not finite")
        return finite

    def _update(self, dt: float) -> bool:
        """Apply the command within its limits; return whether the velocity no longer changes."""
        wanted = STANDING if self._time_out.is_over else self.command
        limited = self.limit(wanted, dt)
        done = self.before == self.last == limited
        self.before, self.last = self.last, limited
        self.drive(limited)
        return done

    def _publish_command(self) -> None:
        assert self._limited is not None
        message = stamp_message(self.context, "geometry_msgs/TwistStamped")
        message.twist.linear.x, message.twist.linear.y, message.twist.angular.z = self.last
        self._limited.publish(message)

    def _integrate_odometry(self) -> None:
        """Integrate the odometry exactly along an arc."""
        now = self.context.now_ns
        dt = (now - self._now_ns) * 1e-9
        self._now_ns = now
        if dt <= 0.0:
            return
        forward, sideways, turn = self.displacement(dt)
        self._pose = along_arc(self._pose, (forward, sideways, turn))
        self._velocities.append((forward / dt, sideways / dt, turn / dt))

    @property
    def velocity(self) -> Planar:
        """Return the velocity that the odometry message contains: m/s, m/s, rad/s."""
        count = max(1, len(self._velocities))
        forward, sideways, turn = (sum(one[axis] for one in self._velocities) / count
                                   for axis in range(3))
        return forward, sideways, turn

    def _publish_odometry(self) -> None:
        pose = planar_pose(*self._pose)
        if self.broadcasts:
            self.context.transform(*self._frames, pose)
        self.publish_more()
        if self._odom.wanted:
            self._odom.publish(self._odometry())

    def _odometry(self) -> Any:
        return odometry_message(self.context, self._frames, planar_pose(*self._pose),
                                planar_twist(self.velocity), self._covariances)

    # -- geometry ----------------------------------------------------------------------------------

    def joint_location(self, joint: JointSpec) -> Vec3:
        """Return the position of a joint in the model frame at joint positions 0, m."""
        return joint_origin(joint, self.context.description)

    def wheel_radius(self, joint: JointSpec) -> float:
        """Return the parameter `wheel_radius`, else the radius of a wheel (`radius_of`), m."""
        if self.settings.get("wheel_radius") is None:
            return self.radius_of(joint)
        return self.settings.number("wheel_radius")

    def radius_of(self, joint: JointSpec, rollers: bool = False) -> float:
        """Return the radius of a wheel's cylinder or sphere, m; `rollers`: of one of its rollers.

        Raises PluginError: the collision has another shape.
        """
        child = joint.child
        if rollers:
            child = next((one.child for one in self.context.description.joints
                          if one.parent == child), child)
        for link in self.context.description.links:
            if link.name == child:
                for collision in link.collisions:
                    if isinstance(collision.geometry, (Cylinder, Sphere)):
                        return collision.geometry.radius
        raise PluginError(f"the wheel of joint '{joint.name}' is no cylinder or sphere: set"
                          f" {self.name}/wheel_radius")

    def positive(self, **lengths: float) -> None:
        """Check that lengths (m) are above 0. Raises PluginError."""
        for name, length in lengths.items():
            if length <= 0.0:
                raise PluginError(f"{self.name}: {name} is {length:g} m; it must be positive")
