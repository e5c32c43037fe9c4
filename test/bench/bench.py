#!/usr/bin/env python3
"""Prints a table of speeds. Run it in a shell that has sourced the workspace, on a quiet machine.

usage: bench.py [ROW …]   rows: start meshes prompt rest services full asleep stacks resting
                          files (default: all)

Figures are compared within one run: "bare" is PyBullet's stepSimulation alone with the same bodies
and default settings, measured alternately with ours. A ratio is the median of the pairs' ratios,
with the least and the largest. Nothing here fails on a slow machine.
"""
from __future__ import annotations

import statistics
import time
from typing import Callable, List, Tuple

import hostile
import pace
import scenes
import starting
from clock import Clock
from row_table import Row, Rows, shown_with_ros
from server import Server, processor, proportional, resident, wait

EMPTY = scenes.world("boxes", 0, True, 1000.0)


def milliseconds(values: List[float], share: float = 0.5) -> float:
    """The quantile `share` of some seconds, in ms."""
    return sorted(values)[min(len(values) - 1, int(share * len(values)))] * 1e3


def start() -> List[Row]:
    found = starting.first_messages(EMPTY)
    own = statistics.median(mine for mine, _ in found)
    return [("first /clock, beside a bare rospy node's first message", starting.shown(found),
             "1.9 times, 0.45 s", starting.ratio(found) <= 1.9 and own <= 0.45)]


def meshes() -> List[Row]:
    found, seconds = starting.divisions()
    return [(f"first start with {starting.WHEELS} undivided meshes, beside known parts",
             f"{starting.shown(found)}, division {seconds:.2f} s of processor each",
             "12 times, 0.8 s",
             starting.ratio(found) <= 12.0 and seconds <= 0.8)]


def prompt() -> List[Row]:
    found = starting.prompts(EMPTY)
    own = statistics.median(mine for mine, _ in found)
    return [("spawn_object.py MY_OBJECT, beside import rospy", starting.shown(found), "0.35 s",
             own <= 0.35)]


def rest() -> List[Row]:
    import rospy
    with Server(EMPTY) as server:
        rospy.wait_for_service("/gazebo/get_world_properties", 30)
        time.sleep(3.0)  # let start-up work end: this is the thing measured, not a wait for it
        memory, shared = resident(server.pids()), proportional(server.pids())
        before, since = processor(server.pids()), time.perf_counter()
        time.sleep(10.0)
        share = (processor(server.pids()) - before) / (time.perf_counter() - since) * 100
    return [("memory, empty world, at rest", f"{shared:.0f} MB PSS, {memory:.0f} MB RSS",
             "100 MB PSS", shared <= 100),
            ("processor at rest, empty world", f"{share:.1f} %", "7 %", share <= 7)]


def _timed(call: Callable[[int], object], count: int) -> List[float]:
    found = []
    for n in range(count):
        began = time.perf_counter()
        answer = call(n)
        found.append(time.perf_counter() - began)
        if not getattr(answer, "success", True):
            raise RuntimeError(str(answer))
    return found


def services() -> List[Row]:
    import rospy
    from gazebo_msgs.msg import ModelState
    from gazebo_msgs.srv import DeleteModel, GetModelState, SetModelState, SpawnModel
    from geometry_msgs.msg import Pose
    rows: List[Row] = []

    def proxy(name: str, kind: type) -> object:
        rospy.wait_for_service("/gazebo/" + name, 30)
        return rospy.ServiceProxy("/gazebo/" + name, kind, persistent=True)

    with Server(EMPTY):
        spawn, delete = proxy("spawn_urdf_model", SpawnModel), proxy("delete_model", DeleteModel)
        get, put = proxy("get_model_state", GetModelState), proxy("set_model_state", SetModelState)

        def spawned(n: int) -> object:
            pose = Pose()
            pose.position.x, pose.position.y, pose.position.z = 2.0 * (n % 32), 2.0 * (n // 32), .5
            return spawn(f"b{n}", scenes.box_urdf(f"b{n}"), "", pose, "")

        spawned(0)
        _state_rows(rows, get, put, ModelState, "idle world", (0.25, 1.0), 1)
        delete("b0")
        took = _timed(spawned, 1000)
        first, last = milliseconds(took[:100]), milliseconds(took[-100:])
        middle, tail = milliseconds(took), milliseconds(took, 0.95)
        rows.append(("spawn_urdf_model of a box, median / p95", f"{middle:.2f} / {tail:.2f} ms",
                     "1.5 / 10 ms", middle <= 1.5 and tail <= 10))
        rows.append(("the last 100 of 1000 against the first", f"{last / first:.2f} times",
                     "2 times", last <= 2 * first))
        took = _timed(lambda n: delete(f"b{n}"), 1000)
        middle, tail = milliseconds(took), milliseconds(took, 0.95)
        rows.append(("delete_model, median / p95", f"{middle:.2f} / {tail:.2f} ms",
                     "0.5 / 10 ms", middle <= 0.5 and tail <= 10))
        for n in range(100):
            spawned(n)
        for n in range(100):
            state = ModelState(model_name=f"b{n}")
            state.pose.position.x, state.pose.position.y = 2.0 * (n % 10), 2.0 * (n // 10)
            state.pose.position.z, state.twist.linear.z = 1000.0, 100.0
            state.twist.angular.x = 1.0
            put(state)
        _state_rows(rows, get, put, ModelState, "100 moving", (1.0, 3.0), 100)
    return rows


def _state_rows(rows: List[Row], get: Callable, put: Callable, kind: type, label: str,
                bars: Tuple[float, float], count: int) -> None:
    read = milliseconds(_timed(lambda n: get(f"b{n % count}", ""), 2000))

    def moved(n: int) -> object:
        state = kind(model_name=f"b{n % count}")
        at = n % count
        state.pose.position.x, state.pose.position.y = 2.0 * (at % 10), 2.0 * (at // 10)
        state.pose.position.z = 1000.0
        state.twist.linear.z = 100.0
        return put(state)

    written = milliseconds(_timed(moved, 1000))
    rows.append((f"get_model_state, {label}, median", f"{read:.3f} ms", f"{bars[0]} ms",
                 read <= bars[0]))
    rows.append((f"set_model_state, {label}, median", f"{written:.3f} ms", f"{bars[1]} ms",
                 written <= bars[1]))


GAZEBO = {("boxes", False): {1: 44.0, 10: 9.3, 100: 1.16, 300: 0.36, 1000: 0.087},
          ("boxes", True): {1: 61.0, 10: 39.0, 100: 17.0, 300: 5.8, 1000: 1.15},
          ("stacks", False): {200: 0.42}, ("stacks", True): {200: 1.0}}


AWAKE = {1: 0.95, 10: 1.2, 100: 1.6, 300: 1.6, 1000: 1.5}
ASLEEP = {1: 0.0, 10: 0.0, 100: 0.95, 300: 0.95, 1000: 0.95}


def _factor(kind: str, count: int, sleeping: bool, bar: float, absolute: float = 0.0) -> Row:
    found = pace.measured(kind, count, sleeping)
    gazebo = GAZEBO[kind, sleeping][count]
    what = f"{count} boxes{' in stacks' if kind == 'stacks' else ''}, "
    what += "asleep" if sleeping else "awake"
    good = found.stand and found.ratio >= bar and found.factor > max(absolute, gazebo)
    wanted = (f"{bar} of bare" if bar else "") + (f" {absolute:g}" if absolute else "")
    return (f"full speed, {what}", str(found), f"{wanted} (Gazebo {gazebo:g})".strip(), good)


def full() -> List[Row]:
    return [_factor("boxes", count, False, bar) for count, bar in AWAKE.items()]


def asleep() -> List[Row]:
    return [_factor("boxes", count, True, bar) for count, bar in ASLEEP.items()]


def stacks() -> List[Row]:
    return [_factor("stacks", 200, False, 2.5), _factor("stacks", 200, True, 0.0, 10.0)]


def resting() -> List[Row]:
    import rospy
    from gazebo_msgs.msg import ModelStates
    heard = []
    subscriber = rospy.Subscriber("/gazebo/model_states", ModelStates,
                                  lambda message: heard.append(len(message.name)))
    clock = Clock()
    with Server(scenes.world("boxes", 1000, True, 1000.0), "_model_states_rate:=50"):
        rospy.wait_for_service("/gazebo/get_world_properties", 60)
        wait(lambda: clock.sim > 5.0, 120, "settled world")
        sim, since, had = clock.sim, time.perf_counter(), len(heard)
        time.sleep(8.0)
        span = time.perf_counter() - since
        factor, rate = (clock.sim - sim) / span, (len(heard) - had) / span
    subscriber.unregister()
    clock.close()
    return [("1000 resting boxes, real time, one subscriber at 50 Hz",
             f"{factor:.3f} ({rate:.0f} messages/s)", "0.99", factor >= 0.99)]


def files() -> List[Row]:
    import tempfile

    import numpy as np
    import trimesh

    from my_simulations.description.shapes import Mesh
    from my_simulations.formats.mesh.loading import load_mesh
    from my_simulations.formats.reading import parse_world
    from my_simulations.resources.resolver import Resolver
    resolver = Resolver.from_environment()
    rows: List[Row] = []

    def took(label: str, bar: float, call: Callable[[], object]) -> None:
        began = time.perf_counter()
        call()
        span = time.perf_counter() - began
        rows.append((label, f"{span:.3f} s", f"{bar} s", span <= bar))

    large = scenes.world("boxes", 1000, True, 1000.0)
    took("reading a world of 1000 models", 1.0, lambda: parse_world(large, resolver,
                                                                        file="large.world"))
    with tempfile.NamedTemporaryFile(suffix=".stl") as stream:
        side = np.arange(225.0)
        x, y = np.meshgrid(side, side)
        corners = np.stack([x.ravel(), y.ravel(), np.sin(x).ravel()], axis=1)
        at = (np.arange(224)[:, None] * 225 + np.arange(224)).ravel()
        faces = np.concatenate([np.stack([at, at + 1, at + 225], 1),
                                np.stack([at + 1, at + 226, at + 225], 1)])
        trimesh.Trimesh(corners, faces, process=False).export(stream.name)
        took("first load of a mesh of 100 000 triangles", 3.0,
             lambda: load_mesh(Mesh("m", stream.name)))
        took("the same again", 0.1, lambda: load_mesh(Mesh("m", stream.name)))
    for what, seconds, megabytes in hostile.measured():
        rows.append((f"refusing {what}", f"{seconds:.3f} s, {megabytes:.0f} MB at most",
                     f"{hostile.SECONDS:g} s, {hostile.MEGABYTES:g} MB",
                     seconds <= hostile.SECONDS and megabytes <= hostile.MEGABYTES))
    return rows


ROWS: Rows = {
    "start": start, "meshes": meshes, "prompt": prompt, "rest": rest, "services": services,
    "full": full, "asleep": asleep, "stacks": stacks, "resting": resting, "files": files}

if __name__ == "__main__":
    shown_with_ros(ROWS, __doc__)
