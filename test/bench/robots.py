#!/usr/bin/env python3
"""Prints what robots cost. Run it in a shell that has sourced the workspace, on a quiet machine.

usage: robots.py [ROW …]   rows: drive ten closed_loop (default: all)

The robots are lab robots with a laser of 360 rays at 10 Hz, a differential drive and joint states
at 50 Hz; all their topics have a subscriber in this process. Shares are of one core. Nothing here
fails on a slow machine. Shares are by sim time: on a loaded machine the real-time factor falls, and
they stay.
"""
from __future__ import annotations

import pathlib
import statistics
import subprocess
import sys
import time
from typing import Callable, Dict, List, Sequence, Tuple

sys.path.insert(0, __file__.rsplit("/", 1)[0])
import scenes
from server import Server, children, master, processor, wait

Row = Tuple[str, str, str, bool]
WORLD = scenes.world("boxes", 0, True, 1000.0)
ROBOT = pathlib.Path(__file__).resolve().parents[2] / "urdf" / "robo.urdf.xacro"
SECONDS = 15.0
TURNS, TURN, TURN_SETTLE = 3, 3.0, 0.5   # of the drive alone: measurements, s of each, s before it


class Shares:
    """Processor shares of the node and of its children, and the real-time factor, over a time."""

    def __init__(self, server: Server) -> None:
        import rospy

        self._node = server.process.pid
        self._engine = rospy.get_param("/gazebo/my_simulations/engine_pid")
        self._others = [pid for pid in children(self._node) if pid != self._engine]
        self._before = self._read()
        self._begun, self._sim = time.perf_counter(), rospy.get_rostime().to_sec()

    def _read(self) -> List[float]:
        return [processor([self._node]), processor([self._engine]), processor(self._others)]

    def end(self) -> Tuple[float, float, float, float]:
        """Of the node, the engine and the sensing process, by sim time; sim time by wall time.

        Processor time by sim time is what a share would be at a real-time factor of 1.
        """
        import rospy

        wall = time.perf_counter() - self._begun
        sim = max(1e-3, rospy.get_rostime().to_sec() - self._sim)
        node, engine, others = ((b - a) / sim for a, b in zip(self._before, self._read()))
        return node, engine, others, sim / wall


def spawn(count: int, laser: bool = True,
          plugins: Sequence[str] = ("diff_drive", "joint_state_publisher")) -> None:
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
    none. The three take turns in one world, so that a load that comes and goes meets all of them.
    """
    import rospy
    from gazebo_msgs.srv import DeleteModel

    sets: Tuple[Tuple[str, ...], ...] = ((), ("diff_drive",),
                                         ("diff_drive", "joint_state_publisher"))
    found: Dict[Tuple[str, ...], List[float]] = {one: [] for one in sets}
    with Server(WORLD) as server:
        heard = listen(1, laser=False)
        for plugins in sets * TURNS:
            spawn(1, laser=False, plugins=plugins)
            heard.clear()
            if plugins:
                wait(lambda plugins=plugins: len(heard) == len(plugins), 30, "odometry")
            time.sleep(TURN_SETTLE)
            shares = Shares(server)
            time.sleep(TURN)
            found[plugins].append(shares.end()[0])
            rospy.ServiceProxy("/gazebo/delete_model", DeleteModel)("r0")
    none, alone, both = (statistics.median(found[one]) for one in sets)
    return [("one diff drive, odometry at 50 Hz published", f"{100 * (alone - none):.1f} % of a core",
             "1 %", alone - none <= 0.01),
            ("the same with joint states at 50 Hz", f"{100 * (both - none):.1f} % of a core", "",
             True)]


def ten() -> List[Row]:
    """Ten robots that see and drive."""
    with Server(WORLD) as server:
        spawn(10)
        heard = listen(10)
        wait(lambda: len(heard) == 3, 60, "scans")
        shares = Shares(server)
        time.sleep(SECONDS)
        node, engine, sensing, factor = shares.end()
    return [("ten robots: real-time factor", f"{factor:.2f}", "1", True),
            ("ten robots: node, that publishes", f"{100 * node:.0f} % of a core", "", True),
            ("ten robots: sensing process", f"{100 * sensing:.1f} % of a core", "", True),
            ("ten robots: publishing and sensing", f"{100 * (node + sensing):.0f} % of a core",
             "25 %", True),
            ("ten robots: engine", f"{100 * engine:.0f} % of a core", "", True)]


def closed_loop() -> List[Row]:
    """A user's controller answers every odometry message of ten robots with a command."""
    import rospy
    from geometry_msgs.msg import Twist
    from nav_msgs.msg import Odometry

    with Server(WORLD) as server:
        spawn(10, laser=False)
        delays: List[float] = []
        for n in range(10):
            command = rospy.Publisher(f"/r{n}/cmd_vel", Twist, queue_size=1, tcp_nodelay=True)

            def control(message: Odometry, command: rospy.Publisher = command) -> None:
                answer = Twist()
                answer.linear.x = 0.2 - 0.1 * message.twist.twist.linear.x
                command.publish(answer)
                delays.append((rospy.get_rostime() - message.header.stamp).to_sec())
            rospy.Subscriber(f"/r{n}/odom", Odometry, control, tcp_nodelay=True)
        wait(lambda: len(delays) > 100, 60, "odometry")
        delays.clear()
        shares = Shares(server)
        time.sleep(SECONDS)
        factor = shares.end()[3]
    late = sorted(delays)
    return [("ten controllers in one program: real-time factor", f"{factor:.2f}", "1", True),
            ("ten controllers: commands a second", f"{len(late) / SECONDS:.0f}", "", True),
            ("ten controllers: age of odometry when answered, median",
             f"{1e3 * late[len(late) // 2]:.1f} ms of sim time", "", True)]


ROWS: Dict[str, Callable[[], List[Row]]] = {"drive": drive, "ten": ten, "closed_loop": closed_loop}


def main() -> None:
    """Measure and print."""
    import rospy

    with master():
        rospy.set_param("/use_sim_time", True)
        rospy.init_node("bench", anonymous=True, disable_signals=True)
        for name in sys.argv[1:] or ROWS:
            for what, found, bar, _ in ROWS[name]():
                print(f"{what:60} {found:28} {bar}", flush=True)


if __name__ == "__main__":
    main()
