#!/usr/bin/env python3
"""Prints how fast the ROS interface is. Run it in a shell with the workspace, on a quiet machine.

usage: ros_interface.py [ROW …]   rows: calls clients ratios states spawns paused (default: all)

Each service is called over a persistent connection, by a client in a process of its own. Nothing
here fails on a slow machine.
"""
from __future__ import annotations

import json
import os
import random
import socket
import subprocess
import sys
import threading
import time
from typing import Any, Callable, Dict, List, Tuple

import scenes
from bench import EMPTY, milliseconds
from clock import Clock
from row_table import Row, Rows, shown_with_ros
from server import Server, wait

from my_simulations.ros.service_connection import ServiceConnection

READ_MS, WRITE_MS, SLOWEST_MS = 0.3, 1.5, 20.0
CALLS = 300
CLIENTS, CLIENT_SECONDS = 8, 30.0
# What Gazebo 11 did on one machine: 8 clients made 15 400 calls/s, one get took 0.039 ms.
SET_OVER_GET, CLIENTS_OVER_ONE, ROUNDS = 1.3, 0.6, 20
CONNECTIONS, LONGEST_WAIT_S = 100, 1.0
RATIO_SECONDS, RATIO_ROUNDS = 5.0, 3
STATES_SECONDS = 10.0

ARM = """<robot name="arm"><link name="world"/><link name="fore"><inertial><mass value="1"/>
  <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <joint name="hinge" type="revolute"><origin xyz="0 50 1"/><parent link="world"/>
  <child link="fore"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="5" velocity="9"/>
  </joint></robot>"""


def proxy(name: str) -> Any:
    """A persistent connection to a service."""
    import rospy

    from my_simulations.ros.interface import SERVES, row_of
    from my_simulations.ros.registration import class_of
    rospy.wait_for_service(f"/gazebo/{name}", 30)
    return rospy.ServiceProxy(f"/gazebo/{name}", class_of(row_of(name, SERVES)), persistent=True)


def put(model: str, x: float, y: float, z: float) -> Any:
    """A request for set_model_state."""
    from gazebo_msgs.msg import ModelState
    state = ModelState(model_name=model)
    state.pose.position.x, state.pose.position.y, state.pose.position.z = x, y, z
    state.twist.linear.z, state.twist.angular.x = 50.0, 1.0
    return state


def requests() -> Tuple[Dict[str, List[Any]], Dict[str, List[Any]]]:
    """Arguments by service, of those that read and those that write."""
    import rospy
    from gazebo_msgs import msg, srv
    from geometry_msgs.msg import Point, Vector3, Wrench
    ode = proxy("get_physics_properties")().ode_config
    link = srv.SetLinkPropertiesRequest(link_name="box::link", mass=1.0, ixx=1.0, iyy=1.0, izz=1.0)
    light = srv.SetLightPropertiesRequest(light_name="sun", attenuation_constant=0.5)
    joint = msg.ODEJointProperties(damping=[0.5])
    reads: Dict[str, List[Any]] = {
        "get_world_properties": [], "get_model_properties": ["box"],
        "get_model_state": ["box", ""], "get_link_state": ["box::link", "arm"],
        "get_link_properties": ["box::link"], "get_joint_properties": ["arm::hinge"],
        "get_light_properties": ["sun"], "get_physics_properties": []}
    writes: Dict[str, List[Any]] = {
        "set_model_state": [put("box", 0.0, 0.0, 9.0)],
        "set_link_state": [msg.LinkState(link_name="box::link", pose=put("", 0, 0, 9.0).pose)],
        "set_model_configuration": ["arm", "", ["hinge"], [0.5]],
        "set_joint_properties": ["arm::hinge", joint], "set_link_properties": [link],
        "set_light_properties": [light],
        "set_physics_properties": [0.001, 1000.0, Vector3(0.0, 0.0, -9.8), ode],
        "apply_body_wrench": ["box::link", "", Point(), Wrench(force=Vector3(1.0, 0.0, 0.0)),
                              rospy.Time(), rospy.Duration(0, 1000000)],
        "apply_joint_effort": ["arm::hinge", 1.0, rospy.Time(), rospy.Duration(0, 1000000)],
        "clear_body_wrenches": ["box::link"], "clear_joint_forces": ["hinge"],
        "pause_physics": [], "unpause_physics": [], "step_world": [1],
        "reset_world": [], "reset_simulation": [], "reset_time": []}
    return reads, writes


def timed(call: Callable[..., Any], arguments: List[Any], count: int = CALLS) -> List[float]:
    """Seconds each call took."""
    took = []
    for _ in range(count):
        began = time.perf_counter()
        answer = call(*arguments)
        took.append(time.perf_counter() - began)
        if not getattr(answer, "success", True):
            raise RuntimeError(str(answer))
    return took


def calls() -> List[Row]:
    rows: List[Row] = []
    with Server(EMPTY.replace("<include><uri>model://ground",
                              "<include><uri>model://sun</uri></include>"
                              "<include><uri>model://ground", 1)):
        from geometry_msgs.msg import Pose
        spawn = proxy("spawn_urdf_model")
        for name, xml in (("box", scenes.box_urdf("box")), ("arm", ARM)):
            spawn(name, xml, "", Pose(), "")
        for kind, bar, of in zip(("read", "write"), (READ_MS, WRITE_MS), requests()):
            for name, arguments in of.items():
                took = timed(proxy(name), arguments)
                middle, most = milliseconds(took), max(took) * 1e3
                rows.append((f"{kind}: {name}, median / slowest", f"{middle:.3f} / {most:.1f} ms",
                             f"{bar:g} / {SLOWEST_MS:g} ms", middle <= bar and most <= SLOWEST_MS))
    return rows


def client(number: int, seconds: float, task: str) -> None:
    """What one of several client processes does: prints what its calls took, as JSON.

    It reads and throws one of a hundred boxes after the other (`throw`), reads its own box and puts
    it down again (`put`), or only reads it (`read`).
    """
    import rospy
    rospy.init_node(f"client_{number}", disable_rostime=True, disable_signals=True)
    get, move = proxy("get_model_state"), proxy("set_model_state")
    took: List[float] = []
    errors = 0
    choose = random.Random(number)
    get(f"b{number}", "")
    until = time.perf_counter() + seconds
    while time.perf_counter() < until:
        n = choose.randrange(100) if task == "throw" else number
        state = put(f"b{n}", 3.0 * (n % 10), 3.0 * (n // 10), 500.0 if task == "throw" else 0.5)
        if task == "put":
            state.twist = type(state.twist)()
        for call, arguments in ((get, (f"b{n}", "")), (move, (state,)))[:1 + (task != "read")]:
            began = time.perf_counter()
            errors += not call(*arguments).success
            took.append(time.perf_counter() - began)
    print(json.dumps({"took": took, "errors": errors}))
    rospy.signal_shutdown("done")


def client_processes(count: int, seconds: float, task: str) -> "List[subprocess.Popen[str]]":
    """Clients at work, for so many seconds each; see `client` for tasks."""
    program = [sys.executable, os.path.abspath(__file__), "--client"]
    return [subprocess.Popen([*program, str(n), str(seconds), task],
                             stdout=subprocess.PIPE, text=True) for n in range(count)]


def clients() -> List[Row]:
    import rospy
    clock = Clock()
    with Server(scenes.world("boxes", 100, True, 1000.0)):
        rospy.wait_for_service("/gazebo/set_model_state", 30)
        move = proxy("set_model_state")
        for n in range(100):
            move(put(f"b{n}", 3.0 * (n % 10), 3.0 * (n // 10), 500.0))
        processes = client_processes(CLIENTS, CLIENT_SECONDS, "throw")
        wait(lambda: clock.sim > 1.0, 30, "a second")
        sim, since = clock.sim, time.perf_counter()
        time.sleep(CLIENT_SECONDS - 3.0)
        factor = (clock.sim - sim) / (time.perf_counter() - since)
        found = [json.loads(process.communicate()[0].splitlines()[-1]) for process in processes]
    clock.close()
    took = [one for each in found for one in each["took"]]
    errors = sum(each["errors"] for each in found)
    tail = milliseconds(took, 0.99)
    return [(f"{CLIENTS} clients, 100 bodies moving: errors / p99 / real-time factor",
             f"{errors} / {tail:.1f} ms / {factor:.3f} ({len(took) / CLIENT_SECONDS:.0f} calls/s)",
             "0 / 25 ms / 0.95", not errors and tail <= 25.0 and factor >= 0.95)]


class Direct(ServiceConnection):
    """A connection to the server of a service, without a question to the master."""

    def __init__(self, host: str, port: int, name: str, kind: Any) -> None:
        self._kind = kind
        self._socket = socket.create_connection((host, port))
        self._shake_hands({"callerid": "/bench", "service": name, "md5sum": kind._md5sum,
                           "type": kind._type, "persistent": "1"})


def longest_wait(name: str, **fields: Any) -> float:
    """Wall seconds of the slowest of many clients that connect and call a service at once."""
    import rosservice
    host, port = rosservice.get_service_uri(name)[len("rosrpc://"):].split(":")
    kind = rosservice.get_service_class_by_name(name)
    together, took = threading.Barrier(CONNECTIONS), []

    def call() -> None:
        together.wait()
        began = time.perf_counter()
        connection = Direct(host, int(port), name, kind)
        connection(**fields)
        took.append(time.perf_counter() - began)
        connection.close()

    threads = [threading.Thread(target=call) for _ in range(CONNECTIONS)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    if len(took) < CONNECTIONS:
        raise RuntimeError(f"{CONNECTIONS - len(took)} of {CONNECTIONS} calls failed")
    return max(took)


def calls_per_second(count: int, task: str) -> float:
    """The calls of some clients together, each for as long as it runs."""
    found = [json.loads(process.communicate()[0].splitlines()[-1])
             for process in client_processes(count, RATIO_SECONDS, task)]
    if any(each["errors"] for each in found):
        raise RuntimeError("calls failed")
    return sum(len(each["took"]) for each in found) / RATIO_SECONDS


def ratios() -> List[Row]:
    from geometry_msgs.msg import Pose
    rows: List[Row] = []
    with Server(EMPTY):
        proxy("spawn_urdf_model")("box", scenes.box_urdf("box"), "", Pose(), "")
        get, move = proxy("get_model_state"), proxy("set_model_state")
        gets, sets = [], []
        for _ in range(ROUNDS):
            gets += timed(get, ["box", ""], CALLS // 3)
            sets += timed(move, [put("box", 0.0, 0.0, 9.0)], CALLS // 3)
        one, other = milliseconds(gets), milliseconds(sets)
        rows.append(("set_model_state over get_model_state, medians",
                     f"{other / one:.2f} ({other:.3f} / {one:.3f} ms)", f"{SET_OVER_GET:g}",
                     other / one <= SET_OVER_GET))
        wait_s = max(longest_wait("/gazebo/get_model_state", model_name="box")
                     for _ in range(ROUNDS))
        rows.append((f"longest wait of {CONNECTIONS} clients that connect at once, {ROUNDS} times",
                     f"{wait_s:.3f} s", f"{LONGEST_WAIT_S:g} s", wait_s < LONGEST_WAIT_S))
        for n in range(CLIENTS):
            where = Pose()
            where.position.x, where.position.z = 3.0 * n, 0.5
            proxy("spawn_urdf_model")(f"b{n}", scenes.box_urdf(f"b{n}"), "", where, "")
        alone = together = 0.0
        for _ in range(RATIO_ROUNDS):
            alone += calls_per_second(1, "read") / RATIO_ROUNDS
            together += calls_per_second(CLIENTS, "put") / RATIO_ROUNDS
        rows.append((f"calls/s of {CLIENTS} clients that get and set, over one that gets",
                     f"{together / alone:.2f} ({together:.0f} / {alone:.0f} calls/s)",
                     f"{CLIENTS_OVER_ONE:g}", together >= CLIENTS_OVER_ONE * alone))
    return rows


def states() -> List[Row]:
    import rospy
    heard = [0]

    def hear(_message: Any) -> None:
        heard[0] += 1

    clock = Clock()
    # AnyMsg keeps the bytes, so that the figure excludes rospy's deserialization.
    subscriber = rospy.Subscriber("/gazebo/model_states", rospy.AnyMsg, hear, tcp_nodelay=True)
    with Server(scenes.world("boxes", 99, True, 1000.0)):
        rospy.wait_for_service("/gazebo/set_model_state", 30)
        move = proxy("set_model_state")
        for n in range(99):
            move(put(f"b{n}", 3.0 * (n % 10), 3.0 * (n // 10), 5000.0))
        wait(lambda: heard[0] > 1000, 60, "states")
        had, sim, since = heard[0], clock.sim, time.perf_counter()
        time.sleep(STATES_SECONDS)
        span = time.perf_counter() - since
        rate, factor = (heard[0] - had) / span, (clock.sim - sim) / span
    subscriber.unregister()
    clock.close()
    return [("model_states of 100 models, moving, at 1000 Hz: rate / real-time factor",
             f"{rate:.0f} Hz / {factor:.3f}", "950 Hz / 0.99", rate >= 950 and factor >= 0.99)]


def spawns() -> List[Row]:
    from geometry_msgs.msg import Pose
    with Server(EMPTY):
        spawn = proxy("spawn_urdf_model")
        began = time.perf_counter()
        for n in range(1000):
            where = Pose()
            where.position.x, where.position.y, where.position.z = 2.0 * (n % 32), 2 * (n // 32), .5
            if not spawn(f"b{n}", scenes.box_urdf(f"b{n}"), "", where, "").success:
                raise RuntimeError(f"b{n} was not spawned")
        span = time.perf_counter() - began
    return [("spawning 1000 boxes, one by one", f"{span:.2f} s", "5 s", span <= 5.0)]


def paused() -> List[Row]:
    import rospy
    from gazebo_msgs.msg import ModelStates
    took = []
    with Server(EMPTY, "-u"):
        proxy("get_world_properties")()
        for _ in range(10):
            began = time.perf_counter()
            rospy.wait_for_message("/gazebo/model_states", ModelStates, timeout=10)
            took.append(time.perf_counter() - began)
    return [("wait_for_message of model_states while paused, slowest of 10",
             f"{max(took):.3f} s", "0.2 s", max(took) <= 0.2)]


ROWS: Rows = {
    "calls": calls, "clients": clients, "ratios": ratios, "states": states, "spawns": spawns,
    "paused": paused}

if __name__ == "__main__":
    if sys.argv[1:2] == ["--client"]:
        client(int(sys.argv[2]), float(sys.argv[3]), sys.argv[4])
    else:
        shown_with_ros(ROWS, __doc__)
