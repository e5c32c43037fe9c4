"""The commands of `gz` that call the ROS services of a running simulator."""
from __future__ import annotations

import argparse
import os
import sys
import time
from typing import Any, Iterator, Sequence, Tuple

from ..geometry import Vec3, rpy_from_quat
from ..objects.object_documents import decoded, root_tag
from ..objects.selection import closest
from ..ros.lifecycle import master_api
from . import object_client as client

OK = client.OK
FIND_SECONDS = 10.0
STEP_SECONDS = 0.1
"""Wall seconds that `gz world -m` allows for each step; a single step can render a picture."""
STATS_SECONDS = 0.2
"""Wall seconds between two lines of `gz stats` (Gazebo behaviour)."""


class Running:
    """The running simulator."""

    def __init__(self, node: str, remappings: Sequence[str]) -> None:
        """Connect to the simulator. Raises ToolError if it does not run."""
        self.node = client.full_name(node, remappings)
        self.parameters = client.Parameters(remappings)
        self.simulator = client.SimulatorClient(self.parameters, self.node, FIND_SECONDS)

    def call_service(self, service: str, kind: str, timeout: float = FIND_SECONDS, **fields: Any
                     ) -> Any:
        """The response of a service within `timeout` wall s. Raises ToolError if it fails."""
        answer = self.simulator.call_service(service, kind, timeout, **fields)
        if not getattr(answer, "success", True):
            raise client.ToolError(answer.status_message)
        return answer


def world(options: argparse.Namespace, running: Running) -> int:
    done = 0
    if options.pause is not None:
        running.call_service("pause_physics" if options.pause else "unpause_physics", "Empty")
        done += 1
    for wanted, service in ((options.reset_all, "reset_simulation"),
                            (options.reset_time, "reset_time"),
                            (options.reset_models, "reset_world")):
        if wanted:
            running.call_service(service, "Empty")
            done += 1
    steps = 1 if options.step else options.multi_step
    if steps:
        _make_steps(running, steps)
        done += 1
    return _something(done, "gz world", "-p 0|1, -s, -m N, -r, -t or -o")


def _make_steps(running: Running, steps: int) -> None:
    if not running.parameters.has_service(f"{running.node}/step_world"):
        raise client.ToolError(f"{running.node} has no service step_world; "
                               "launch it with the argument extensions:=true")
    running.call_service("step_world", "StepWorld", FIND_SECONDS + STEP_SECONDS * steps,
                         steps=steps)


def model(options: argparse.Namespace, running: Running) -> int:
    if options.list:
        for name in running.simulator.model_names():
            print(name)
        return OK
    name = options.model_name
    if not name:
        raise client.ToolError("give -l, or -m NAME")
    if options.spawn_file or options.spawn_string:
        return _spawn(options, running)
    known = running.simulator.model_names()
    if name not in known:
        near = closest(name, known)
        raise client.ToolError(f"unknown model '{name}'" + (
            f"; did you mean {' or '.join(near)}?" if near else "; run gz model -l for a list"))
    given = [getattr(options, axis) for axis in "xyzRPY"]
    if options.delete:
        running.simulator.delete(name)
    elif options.info:
        _show(running, name)
    elif options.pose or all(value is None for value in given):
        position, rpy = _pose(running, name)
        print(" ".join(f"{value:.6g}" for value in (*position, *rpy)))
    else:
        position, rpy = _pose(running, name)
        now = [old if new is None else new for old, new in zip((*position, *rpy), given)]
        _place(running, name, now)
    return OK


def physics(options: argparse.Namespace, running: Running) -> int:
    now = running.call_service("get_physics_properties", "GetPhysicsProperties")
    fields = {"time_step": now.time_step, "max_update_rate": now.max_update_rate,
              "gravity": now.gravity, "ode_config": now.ode_config}
    changed = False
    if options.gravity is not None:
        now.gravity.x, now.gravity.y, now.gravity.z = _vector(options.gravity)
        changed = True
    if options.iters is not None:
        now.ode_config.sor_pgs_iters = options.iters
        changed = True
    for key, value in (("time_step", options.step_size), ("max_update_rate", options.update_rate)):
        if value is not None:
            fields[key], changed = value, True
    if changed:
        running.call_service("set_physics_properties", "SetPhysicsProperties", **fields)
        return OK
    print(f"gravity: {now.gravity.x:g},{now.gravity.y:g},{now.gravity.z:g} m/s^2\n"
          f"step size: {now.time_step:g} s\nupdate rate: {now.max_update_rate:g} Hz\n"
          f"iterations: {now.ode_config.sor_pgs_iters}")
    return OK


def stats(options: argparse.Namespace, running: Running) -> int:
    """`gz stats`: one line five times a second; real time counts from the first line."""
    if options.plot:
        print("# real-time factor (percent), simtime (sec), realtime (sec), paused (T or F)")
    for factor, sim, real, paused in _measure_speed(running, options.duration):
        still = "T" if paused else "F"
        if options.plot:
            print(f"{100 * factor:4.2f}, {sim:16.6f}, {real:16.6f}, {still}", flush=True)
        else:
            print(f"Factor[{factor:4.2f}] SimTime[{sim:4.2f}] RealTime[{real:4.2f}] "
                  f"Paused[{still}]", flush=True)
    return OK


def topic(options: argparse.Namespace, running: Running) -> int:
    for word in ("echo", "info", "hz", "bw"):
        name = getattr(options, word)
        if name:
            try:
                os.execvp("rostopic", ["rostopic", word, name])
            except OSError as fault:
                raise client.ToolError(f"cannot start rostopic: {fault}") from fault
    if not options.list:
        raise client.ToolError("give -l, -e TOPIC, -i TOPIC, -z TOPIC or -b TOPIC")
    state = master_api.call(running.parameters.uri, "getSystemState", client.CALLER) or ((), (), ())
    names = {name for part in state[:2] for name, nodes in part if running.node in nodes}
    print("\n".join(sorted(names)))
    return OK


def _measure_speed(running: Running, duration: float) -> Iterator[Tuple[float, float, float, bool]]:
    """Real-time factor, sim time (s), real time (s) and paused, for `duration` wall seconds."""
    began = before = time.monotonic()
    sim_before = running.call_service("get_world_properties", "GetWorldProperties").sim_time
    while before - began < duration:
        time.sleep(STATS_SECONDS)
        paused = running.call_service("get_physics_properties", "GetPhysicsProperties").pause
        sim, now = running.call_service("get_world_properties", "GetWorldProperties").sim_time, \
            time.monotonic()
        yield max(0.0, sim - sim_before) / (now - before), sim, now - began, paused
        sim_before, before = sim, now


def _spawn(options: argparse.Namespace, running: Running) -> int:
    if options.spawn_file:
        try:
            with open(options.spawn_file, "rb") as file:
                text = decoded(file.read(), options.spawn_file)
        except OSError as fault:
            raise client.ToolError(f"cannot read {options.spawn_file}: {fault}") from fault
    else:
        text = decoded(sys.stdin.buffer.read(), "standard input")
    x, y, z, roll, pitch, yaw = (getattr(options, axis) or 0.0 for axis in "xyzRPY")
    running.simulator.spawn(options.model_name, text, root_tag(text) != "robot", (x, y, z),
                            (roll, pitch, yaw))
    return OK


def _pose(running: Running, name: str) -> Tuple[Vec3, Vec3]:
    state = running.call_service("get_model_state", "GetModelState", model_name=name)
    place, turn = state.pose.position, state.pose.orientation
    return (place.x, place.y, place.z), rpy_from_quat((turn.x, turn.y, turn.z, turn.w))


def _place(running: Running, name: str, numbers: Sequence[float]) -> None:
    """Moves a model, at rest, to x y z R P Y."""
    from ..geometry import Pose, quat_from_rpy

    x, y, z, roll, pitch, yaw = numbers
    running.simulator.set_model_pose(name, Pose((x, y, z), quat_from_rpy(roll, pitch, yaw)))


def _show(running: Running, name: str) -> None:
    """Print a model's links, collisions, joints and nested models as YAML."""
    found = running.call_service("get_model_properties", "GetModelProperties", model_name=name)
    position, rpy = _pose(running, name)
    print(f"name: {name}\nis_static: {str(found.is_static).lower()}\n"
          f"pose: [{', '.join(f'{value:.6g}' for value in (*position, *rpy))}]\n"
          f"canonical_link: {found.canonical_body_name}")
    for title, names in (("links", found.body_names), ("collisions", found.geom_names),
                         ("joints", found.joint_names), ("models", found.child_model_names)):
        print(f"{title}: [{', '.join(names)}]")


def _vector(text: str) -> Vec3:
    try:
        x, y, z = (float(word) for word in text.replace(",", " ").split())
    except ValueError as fault:
        raise client.ToolError(f"-g takes three numbers such as 0,0,-9.8, not {text!r}") from fault
    return x, y, z


def _something(done: int, command: str, options: str) -> int:
    if not done:
        raise client.ToolError(f"nothing to do; {command} takes {options}")
    return OK
