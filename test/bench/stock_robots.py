"""What the plugins of mobile robots cost: the same robot without, and with them, in one run."""
from __future__ import annotations

import contextlib
import os
import statistics
import subprocess
import sys
import time
from typing import Any, Dict, Iterator, List, NamedTuple, Optional

from mobile_robots import (
    LARGE_CONTROLLERS,
    LARGE_TOPICS,
    SMALL_TOPICS,
    Kinds,
    large_robot,
    small_robot,
)
from row_table import Row
from server import Server, processor, wait

TURNS, MEASURE_S = 5, 2.5
# Sim time until the solver needs few iterations; the robot's velocity is 0 long before.
SETTLE_S, LATEST_S = 8.0, 120.0
MOST_IDLE, MOST_SUBSCRIBED = 1.2, 2.0   # times the processor time of the robot without plugins
BUSY = 15


class Robot(NamedTuple):
    """A robot of `mobile_robots`, as it is measured.

    Attributes:
        name: in the printed rows.
        text: URDF with and without plugins, by `plugins`.
        topics: what its plugins publish.
        controllers: parameters of ros_control's controllers, all started; None for none.
        step_size: s.
    """

    name: str
    text: Dict[bool, str]
    topics: Kinds
    controllers: Optional[Dict[str, Any]]
    step_size: float


SMALL = Robot("small robot", {one: small_robot(one) for one in (False, True)}, SMALL_TOPICS, None,
              0.001)
LARGE = Robot("large robot", {one: large_robot(one) for one in (False, True)}, LARGE_TOPICS,
              LARGE_CONTROLLERS, 0.001)
LARGE_STEPS = LARGE._replace(name="large robot, 10 ms steps", step_size=0.01)


def world(step_size: float) -> str:
    """A ground, steps in real time."""
    return f"""<?xml version='1.0'?><sdf version='1.6'><world name='default'>
      <physics type='ode'><max_step_size>{step_size}</max_step_size>
      <real_time_update_rate>{1.0 / step_size}</real_time_update_rate></physics>
      <include><uri>model://ground_plane</uri></include></world></sdf>"""


def spawn(robot: Robot, plugins: bool, number: int = 0) -> None:
    """Put a robot into the world, and start its controllers."""
    import rospy
    from gazebo_msgs.srv import SpawnModel
    from geometry_msgs.msg import Point, Pose, Quaternion

    space = f"/r{number}"
    if robot.controllers is not None:
        for name, settings in robot.controllers.items():
            rospy.set_param(f"{space}/{name}", settings)
    rospy.wait_for_service("/gazebo/spawn_urdf_model", 30)
    reply = rospy.ServiceProxy("/gazebo/spawn_urdf_model", SpawnModel)(
        f"r{number}", robot.text[plugins].replace("NAMESPACE", space), space,
        Pose(Point(1.5 * (number % 4), 1.5 * (number // 4), 0.15), Quaternion(0, 0, 0, 1)), "")
    if not reply.success:
        raise SystemExit(reply.status_message)
    if robot.controllers is not None and plugins:
        from controller_manager_msgs.srv import LoadController, SwitchController

        manager = f"{space}/controller_manager"
        rospy.wait_for_service(f"{manager}/load_controller", 30)
        for name in robot.controllers:
            rospy.ServiceProxy(f"{manager}/load_controller", LoadController)(name)
        rospy.ServiceProxy(f"{manager}/switch_controller", SwitchController)(
            start_controllers=list(robot.controllers), stop_controllers=[], strictness=2)


@contextlib.contextmanager
def subscriber(topics: Kinds, count: int = 1) -> Iterator["subprocess.Popen[str]"]:
    """Another process that receives all topics of the robots, and does nothing with them."""
    names = dict.fromkeys(name if name.startswith("/") else f"/r{n}/{name}"
                          for n in range(count) for name, _, _ in topics)
    process = subprocess.Popen(
        [sys.executable, os.path.join(os.path.dirname(__file__), "sink.py"), *names],
        stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout is not None
        process.stdout.readline()   # all have come once
        yield process
    finally:
        process.terminate()
        process.wait()


class Used(NamedTuple):
    """Processor seconds of the node and its children for a second of sim time, and sim by wall."""

    share: float
    factor: float
    parts: Dict[str, float]


def measure(server: Server, seconds: float = MEASURE_S) -> Used:
    """What the node and its children use."""
    import rospy

    engine = rospy.get_param("/gazebo/my_simulations/engine_pid")
    pids = server.pids()
    groups = {"node": [server.process.pid], "engine": [engine],
              "sensing": [pid for pid in pids if pid not in (engine, server.process.pid)]}
    before = {name: processor(group) for name, group in groups.items()}
    sim, wall = rospy.get_rostime().to_sec(), time.perf_counter()
    time.sleep(seconds)
    parts = {name: processor(group) - before[name] for name, group in groups.items()}
    passed = max(1e-3, rospy.get_rostime().to_sec() - sim)
    return Used(sum(parts.values()) / passed, passed / (time.perf_counter() - wall),
                {name: one / passed for name, one in parts.items()})


def settle(seconds: float = SETTLE_S) -> None:
    """Wait for a time in sim s: a busy machine takes longer."""
    import rospy

    end = rospy.get_rostime().to_sec() + seconds
    wait(lambda: rospy.get_rostime().to_sec() >= end, LATEST_S, "settled robot")


def turn(robot: Robot, plugins: bool, subscribed: bool) -> Used:
    """Measure one of the three cases, in a world of its own."""
    with Server(world(robot.step_size)) as server:
        spawn(robot, plugins)
        with subscriber(robot.topics) if subscribed else contextlib.nullcontext():
            settle()
            return measure(server)


def stock(robot: Robot) -> List[Row]:
    """The robot without plugins, with them, and with a subscriber of everything."""
    cases = {"without plugins": (False, False), "with plugins": (True, False),
             "with subscribers": (True, True)}
    found: Dict[str, List[Used]] = {name: [] for name in cases}
    for _ in range(TURNS):
        for name, case in cases.items():
            found[name].append(turn(robot, *case))
    middle = {name: statistics.median(one.share for one in all_used)
              for name, all_used in found.items()}
    rows: List[Row] = []
    for name, bar in (("without plugins", 0.0), ("with plugins", MOST_IDLE),
                      ("with subscribers", MOST_SUBSCRIBED)):
        ratio = middle[name] / middle["without plugins"]
        parts = found[name][-1].parts
        text = f"{1e3 * middle[name]:.1f} ms a sim s ({ratio:.2f} times; last: " + ", ".join(
            f"{part} {1e3 * used:.1f}" for part, used in parts.items()) + ")"
        rows.append((f"{robot.name} {name}", text, f"{bar} times" if bar else "",
                     not bar or ratio <= bar))
    return rows


def busy() -> List[Row]:
    """The small robot with its plugins beside processes that compute all the time."""
    with Server(world(SMALL.step_size)) as server:
        spawn(SMALL, True)
        others = [subprocess.Popen([sys.executable, "-c", "while True: pass"])
                  for _ in range(BUSY)]
        try:
            settle()
            alone = measure(server, 2.0 * MEASURE_S).factor
            with subscriber(SMALL.topics):
                settle()
                subscribed = measure(server, 2.0 * MEASURE_S).factor
        finally:
            for one in others:
                one.kill()
                one.wait()
    return [(f"small robot beside {BUSY} busy processes: real-time factor", f"{alone:.2f}", "1",
             alone > 0.98),
            ("the same with subscribers", f"{subscribed:.2f}", "1", subscribed > 0.98)]


def many(count: int = 10) -> List[Row]:
    """Robots that see, feel and drive, all subscribed to, on one core."""
    with Server(world(SMALL.step_size)) as server:
        for number in range(count):
            spawn(SMALL, True, number)
        with subscriber(SMALL.topics, count):
            settle()
            subscribed = measure(server)
        settle()
        alone = measure(server)
    return [(f"{count} small robots, all subscribed: processor time", f"{subscribed.share:.2f} s a "
             f"sim s (real-time factor {subscribed.factor:.2f})", "1", subscribed.share <= 1.0),
            ("the same without subscribers", f"{alone.share:.2f} s a sim s", "", True)]
