"""The lab robot in a few words, for the exercises of the course (`scripts/drive_square.py` ...).

robot = Robot("my_program")
while robot.running() and robot.nearest() > 0.5:
robot.drive(0.2)
robot.stop()
"""
from __future__ import annotations

import math
import threading
import time
from typing import Any, Callable, List, Optional, Tuple

_FIRST_S = 60.0   # of wall time until odometry and a scan are there
_LOOK_S = 1.0     # of wall time between two looks for a shutdown
_STANDS = 1e-3    # m/s or rad/s


class Robot:
    """Drives by `cmd_vel`; knows where it is from `odom`, and what is around it from `scan`.

    Args:
        name: of the ROS node.
        hertz: how often `running` returns, per second of sim time.
    """

    def __init__(self, name: str, hertz: float = 20.0) -> None:
        import rospy
        from geometry_msgs.msg import Twist
        from nav_msgs.msg import Odometry
        from sensor_msgs.msg import LaserScan

        rospy.init_node(name)
        self._rospy, self._twist = rospy, Twist
        self._odometry: Optional[Any] = None
        self._scan: Optional[Any] = None
        self._changed = threading.Condition()
        listener = rospy.SubscribeListener()
        listener.peer_subscribe = lambda *_: self._notify()
        self._command = rospy.Publisher("cmd_vel", Twist, listener, queue_size=1)
        rospy.Subscriber("odom", Odometry, self._receive_odometry, queue_size=1)
        rospy.Subscriber("scan", LaserScan, self._receive_scan, queue_size=1)
        self._wait(lambda: self._odometry is not None, "odometry on odom")
        self._wait(lambda: self._scan is not None, "a laser scan on scan")
        self._wait(lambda: self._command.get_num_connections() > 0, "a robot that hears cmd_vel")
        self._rate = rospy.Rate(hertz, reset=True)  # goes on when the world's time is reset
        rospy.on_shutdown(self.stop)

    def _receive_odometry(self, message: Any) -> None:
        self._odometry = message
        self._notify()

    def _receive_scan(self, message: Any) -> None:
        self._scan = message
        self._notify()

    def _notify(self) -> None:
        with self._changed:
            self._changed.notify_all()

    def _wait(self, condition: Callable[[], bool], what: str) -> None:
        # Messages end the wait, not a period of wall time: in lockstep, each run begins alike.
        deadline = time.monotonic() + _FIRST_S
        with self._changed:
            while not condition():
                if time.monotonic() > deadline or self._rospy.is_shutdown():
                    raise SystemExit(f"{self._rospy.get_name()}: there is no {what}")
                self._changed.wait(_LOOK_S)

    # -- moving ------------------------------------------------------------------------------------

    def drive(self, forward: float, turn: float = 0.0) -> None:
        """Drive at m/s, and turn to the left at rad/s, until told otherwise."""
        message = self._twist()
        message.linear.x, message.angular.z = forward, turn
        self._command.publish(message)

    def stop(self) -> None:
        self.drive(0.0)

    def come_to_rest(self) -> None:
        """Stop, and wait until the robot stands."""
        self.stop()
        while self.running() and not self._stands():
            self.stop()

    def _stands(self) -> bool:
        twist = self._odometry.twist.twist if self._odometry is not None else None
        return twist is not None and abs(twist.linear.x) < _STANDS and abs(
            twist.angular.z) < _STANDS

    def running(self) -> bool:
        """Wait for the next turn of a loop; False when the program is to end."""
        try:
            self._rate.sleep()
        except self._rospy.ROSInterruptException:
            return False
        return not self._rospy.is_shutdown()

    def parameter(self, name: str, default: float) -> float:
        """A number that was given as `_name:=value` on the command line."""
        return float(self._rospy.get_param(f"~{name}", default))

    def say(self, text: str) -> None:
        """Print a line."""
        print(text, flush=True)

    # -- state and parameters --------------------------------------------------------------------

    @property
    def pose(self) -> Tuple[float, float, float]:
        """x, y (m) and heading (rad) since the start, as odometry tells."""
        assert self._odometry is not None
        pose = self._odometry.pose.pose
        return (pose.position.x, pose.position.y,
                2.0 * math.atan2(pose.orientation.z, pose.orientation.w))

    def distance_from(self, start: Tuple[float, float, float]) -> float:
        """Return the distance (m) of the robot from an earlier pose."""
        x, y, _ = self.pose
        return math.hypot(x - start[0], y - start[1])

    def angle_from(self, heading: float) -> float:
        """Return the angle (rad, -pi to pi) that the robot has turned to the left since a
        heading.
        """
        return math.remainder(self.pose[2] - heading, 2.0 * math.pi)

    def distances(self, towards: float = 0.0, width: float = 0.4) -> List[Tuple[float, float]]:
        """What the laser sees in a sector: (angle, distance), rad and m.

        Args:
            towards: the middle of the sector, rad, to the left of straight ahead.
            width: of the sector, rad.
        """
        scan = self._scan
        assert scan is not None
        found = []
        for n, distance in enumerate(scan.ranges):
            angle = scan.angle_min + n * scan.angle_increment
            if abs(math.remainder(angle - towards, 2.0 * math.pi)) <= width / 2.0 \
                    and math.isfinite(distance):
                found.append((math.remainder(angle, 2.0 * math.pi), distance))
        return found

    def nearest(self, towards: float = 0.0, width: float = 0.4) -> float:
        """The smallest distance in a sector, m; infinite where the laser sees nothing."""
        return min((distance for _, distance in self.distances(towards, width)), default=math.inf)

    def direction_of_nearest(self, towards: float = 0.0, width: float = 2.0 * math.pi) -> float:
        """In which direction the nearest thing of a sector is, rad to the left."""
        return min(self.distances(towards, width), key=lambda pair: pair[1], default=(0.0, 0.0))[0]
