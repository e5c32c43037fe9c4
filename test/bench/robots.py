#!/usr/bin/env python3
"""Prints what robots cost. Run it in a shell that has sourced the workspace, on a quiet machine.

usage: robots.py [ROW …]   rows: drive ten closed_loop small large large_steps many busy acting
(default: all)

The robots are lab robots with a laser of 360 rays at 10 Hz, a differential drive and joint states
at 50 Hz; all their topics have a subscriber in this process. Shares are of one core, by processor
time and by sim time: on a loaded machine the real-time factor falls, and they stay. Nothing here
fails on a slow machine.
"""
from __future__ import annotations

import collections
import pathlib
import random
import re
import statistics
import subprocess
import sys
import time
from typing import Dict, List, Sequence, Tuple

import acting_plugins
import scenes
import stock_robots
from row_table import Row, Rows
from server import Server, master, processor, wait

WORLD = scenes.world("boxes", 0, True, 1000.0)
ROBOT = pathlib.Path(__file__).resolve().parents[2] / "urdf" / "robo.urdf.xacro"
SECONDS = 15.0
TURNS, TURN, TURN_SETTLE = 9, 2.0, 0.5   # of the drive alone: measurements, s of each, s before it
HERTZ, MOST_LAG = 100.0, 6   # of the controllers' odometry; periods


def spawn(count: int, laser: bool = True,
          plugins: Sequence[str] = ("diff_drive", "joint_state_publisher"),
          hertz: float = 50.0) -> None:
    """Put robots into the world, each under its own name, with some of their plugins."""
    import rospy
    from gazebo_msgs.srv import SpawnModel
    from geometry_msgs.msg import Point, Pose, Quaternion

    text = subprocess.run(["xacro", str(ROBOT)], stdout=subprocess.PIPE, text=True,
                          check=True).stdout.replace(">/scan<", ">scan<").replace(
                              "<robotNamespace>/</robotNamespace>", "")
    if not laser:
        text = text.replace("libgazebo_ros_laser.so", "libgazebo_ros_template.so")
    for name in {"diff_drive", "joint_state_publisher"}.difference(plugins):
        text = text.replace(f"libgazebo_ros_{name}.so", "libgazebo_ros_template.so")
    text = re.sub(r"<updateRate>\s*50(\.0)?\s*<", f"<updateRate>{hertz}<", text)
    rospy.wait_for_service("/gazebo/spawn_urdf_model", 30)
    call = rospy.ServiceProxy("/gazebo/spawn_urdf_model", SpawnModel)
    for n in range(count):
        reply = call(f"r{n}", text, f"/r{n}", Pose(
            Point(1.5 * (n % 4), 1.5 * (n // 4), 0.0), Quaternion(0, 0, 0, 1)), "")
        if not reply.success:
            raise SystemExit(reply.status_message)


def listen(count: int, laser: bool = True) -> Dict[str, int]:
    """Hear everything; counts messages by topic."""
    import rospy
    from nav_msgs.msg import Odometry
    from sensor_msgs.msg import JointState, LaserScan

    heard: Dict[str, int] = {}
    kinds = {"odom": Odometry, "joint_states": JointState, **({"scan": LaserScan} if laser else {})}
    for n in range(count):
        for name, kind in kinds.items():
            def hear(message: object, name: str = name) -> None:
                heard[name] = heard.get(name, 0) + 1
            rospy.Subscriber(f"/r{n}/{name}", kind, hear)
    return heard


def drive() -> List[Row]:
    """What the plugin of one drive costs: the node with it, less the node with a robot that has
    none. The three take turns in one world: of each turn a difference, of all turns the median.
    """
    import rospy
    from gazebo_msgs.srv import DeleteModel

    sets: Tuple[Tuple[str, ...], ...] = ((), ("diff_drive",),
                                         ("diff_drive", "joint_state_publisher"))
    turns: List[List[float]] = []
    with Server(WORLD) as server:
        heard = listen(1, laser=False)
        for _ in range(TURNS):
            turns.append([])
            for plugins in sets:
                spawn(1, laser=False, plugins=plugins)
                heard.clear()
                if plugins:
                    wait(lambda plugins=plugins: len(heard) == len(plugins), 30, "odometry")
                time.sleep(TURN_SETTLE)
                used, sim = processor([server.process.pid]), rospy.get_rostime().to_sec()
                time.sleep(TURN)
                turns[-1].append((processor([server.process.pid]) - used)
                                 / max(1e-3, rospy.get_rostime().to_sec() - sim))
                rospy.ServiceProxy("/gazebo/delete_model", DeleteModel)("r0")
    alone, both = ([100.0 * (turn[n] - turn[0]) for turn in turns] for n in (1, 2))
    return [("one diff drive, odometry at 50 Hz published", _spread(alone), "1 %",
             statistics.median(alone) <= 1.0),
            ("the same with joint states at 50 Hz", _spread(both), "", True)]


def _spread(shares: List[float]) -> str:
    return (f"{statistics.median(shares):.2f} % of a core "
            f"({min(shares):.2f} to {max(shares):.2f})")


def ten() -> List[Row]:
    """Ten robots that see and drive."""
    with Server(WORLD) as server:
        spawn(10)
        heard = listen(10)
        wait(lambda: len(heard) == 3, 60, "scans")
        used = stock_robots.measure(server, SECONDS)
    node, engine, sensing = (used.parts[name] for name in ("node", "engine", "sensing"))
    return [("ten robots: real-time factor", f"{used.factor:.2f}", "1", True),
            ("ten robots: node, that publishes", f"{100 * node:.0f} % of a core", "", True),
            ("ten robots: sensing process", f"{100 * sensing:.1f} % of a core", "", True),
            ("ten robots: publishing and sensing", f"{100 * (node + sensing):.0f} % of a core",
             "25 %", True),
            ("ten robots: engine", f"{100 * engine:.0f} % of a core", "", True)]


class Controller:
    """A user's controller of one robot: answers each odometry message with another velocity.

    The velocities differ by a few mm/s at random, which the wheels follow at once: what odometry
    tells says which of them was in force.
    """

    def __init__(self, number: int) -> None:
        import rospy
        from geometry_msgs.msg import Twist
        from nav_msgs.msg import Odometry

        self._random, self._twist = random.Random(number), Twist
        self.told: Dict[int, float] = {}       # velocity by period
        self.commanded: Dict[int, float] = {}  # in answer to the odometry of a period
        self._command = rospy.Publisher(f"/r{number}/cmd_vel", Twist, queue_size=1,
                                        tcp_nodelay=True)
        rospy.Subscriber(f"/r{number}/odom", Odometry, self._control, tcp_nodelay=True)

    def _control(self, message: object) -> None:
        period = round(message.header.stamp.to_sec() * HERTZ)
        self.told[period] = message.twist.twist.linear.x
        answer = self._twist()
        answer.linear.x = self.commanded[period] = 0.2 + self._random.uniform(-0.004, 0.004)
        self._command.publish(answer)

    def lags(self) -> List[int]:
        """Periods between an odometry message and the beginning of what its answer did."""
        found = []
        for period, velocity in sorted(self.told.items()):
            known = {lag: abs(self.commanded[period - lag - 1] - velocity)
                     for lag in range(MOST_LAG) if period - lag - 1 in self.commanded}
            if len(known) == MOST_LAG:
                found.append(min(known, key=known.__getitem__))
        return found


def closed_loop() -> List[Row]:
    """A user's program answers every odometry message of ten robots, at 100 Hz, with a command."""
    with Server(WORLD) as server:
        spawn(10, laser=False, hertz=HERTZ)
        controllers = [Controller(n) for n in range(10)]
        wait(lambda: all(len(one.told) > 100 for one in controllers), 60, "odometry")
        before = sum(len(one.told) for one in controllers)
        used = stock_robots.measure(server, SECONDS)
        count = sum(len(one.told) for one in controllers) - before
        lags = collections.Counter(lag for one in controllers for lag in one.lags())
    total = max(1, sum(lags.values()))
    counts = ", ".join(f"{lag}: {100 * lags[lag] / total:.1f} %" for lag in sorted(lags))
    return [("ten controllers in one program: real-time factor", f"{used.factor:.2f}", "1",
             used.factor > 0.98),
            ("ten controllers: commands a second of wall time", f"{count / SECONDS:.0f}", "1000",
             True),
            ("ten controllers: periods until a command acts", counts, "1", True),
            ("ten controllers: node, engine",
             f"{100 * used.parts['node']:.0f} %, {100 * used.parts['engine']:.0f} % of a core",
             "", True)]


ROWS: Rows = {
    "drive": drive, "ten": ten, "closed_loop": closed_loop,
    "small": lambda: stock_robots.stock(stock_robots.SMALL),
    "large": lambda: stock_robots.stock(stock_robots.LARGE),
    "large_steps": lambda: stock_robots.stock(stock_robots.LARGE_STEPS),
    "many": stock_robots.many, "busy": stock_robots.busy, "acting": acting_plugins.acting}


def main() -> None:
    """Measure and print. Each row has a process of its own: one row's subscribers end with it."""
    import rospy

    names = sys.argv[1:] or list(ROWS)
    if len(names) > 1:
        for name in names:
            subprocess.run([sys.executable, __file__, name], check=True)
        return
    with master():
        rospy.set_param("/use_sim_time", True)
        rospy.init_node("bench", anonymous=True, disable_signals=True)
        for what, found, bar, _ in ROWS[names[0]]():
            print(f"{what:60} {found:28} {bar}", flush=True)


if __name__ == "__main__":
    main()
