"""Node, master and sensing process are killed: calls end, nothing true is lost, nothing is left."""
from __future__ import annotations

import contextlib
import logging
import math
import os
import random
import signal
import subprocess
import threading
import time
from unittest import mock

import numpy as np
import pytest
import rospy
import rosservice
from editor_case import box
from free_ports import free_port
from gazebo_msgs import srv
from geometry_msgs.msg import Point, Quaternion
from geometry_msgs.msg import Pose as PoseMessage
from my_simulations_msgs.srv import SaveWorld
from proofs import scaled
from waiting import until

from my_simulations.description.model import Link, Model
from my_simulations.description.shapes import Box, Collision
from my_simulations.description.world import World
from my_simulations.engine.process_engine import ProcessEngine
from my_simulations.formats.sdf.writer.entities import write_entity
from my_simulations.ros.lifecycle import master_api
from my_simulations.sensing.api import Body, CastRays, LoadScene, Mount, RayFan, SensingEndedError
from my_simulations.sensing.process import SensingProcess
from my_simulations.simulator.simulator import Simulator

LONGEST_CALL_S = 60.0
"""Of a call to a node that is gone, on a busy machine."""

ENGINE = "/gazebo/my_simulations/engine_pid"
PLACE = PoseMessage(Point(0.0, 0.0, 0.5), Quaternion(0.0, 0.0, 0.0, 1.0))


def lives(pid):
    try:
        with open(f"/proc/{pid}/stat", encoding="utf-8", errors="replace") as stat:
            return stat.read().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def children(pid):
    found = []
    for task in os.listdir(f"/proc/{pid}/task"):
        # Threads come and go.
        with contextlib.suppress(FileNotFoundError, ProcessLookupError), open(
                f"/proc/{pid}/task/{task}/children", encoding="ascii") as stream:
            found += list(map(int, stream.read().split()))
    return found


class Graph:
    """A master and a node, each of which can be killed and started again."""

    def __init__(self, home):
        port = free_port()
        self.uri = f"http://127.0.0.1:{port}"
        self._port = str(port)
        self._environment = {**os.environ, "ROS_MASTER_URI": self.uri, "HOME": home,
                             "ROS_HOME": os.path.join(home, ".ros"), "ROS_IP": "127.0.0.1"}
        self._log = open(os.path.join(home, "log"), "wb")
        self.world = os.path.join(home, "my_simulations", "worlds", "kept.world")
        self.master = self.node = None
        self.start_master()
        self.start_node()

    def _run(self, *words):
        return subprocess.Popen(words, env=self._environment, stdin=subprocess.DEVNULL,
                                stdout=self._log, stderr=self._log, start_new_session=True)

    def start_master(self):
        self.master = self._run("rosmaster", "--core", "-p", self._port)
        until(lambda: not master_api.fault_of(self.uri, "/proof"), "the master")

    def start_node(self):
        files = [self.world] if os.path.exists(self.world) else []
        self.node = self._run("rosrun", "gazebo_ros", "gzserver", "-u", *files)
        until(self.answers, "the node")
        until(lambda: master_api.call(self.uri, "lookupService", "/proof", "/gazebo/save_world"),
              "the services that a start does not wait for")

    def answers(self):
        assert self.node.poll() is None
        try:
            return self.call("get_world_properties", srv.GetWorldProperties) is not None
        except (rospy.ServiceException, rospy.ROSException, OSError):
            return False

    def call(self, name, kind, **fields):
        with mock.patch.dict(os.environ, ROS_MASTER_URI=self.uri):
            return rospy.ServiceProxy(f"/gazebo/{name}", kind)(**fields)

    def names(self):
        found = self.call("get_world_properties", srv.GetWorldProperties).model_names
        return set(found) - {"ground_plane"}

    def close(self):
        for process in (self.node, self.master):
            if process is not None and process.poll() is None:
                process.send_signal(signal.SIGINT)
                try:
                    process.wait(30)
                except subprocess.TimeoutExpired:
                    os.killpg(process.pid, signal.SIGKILL)
                    process.wait()
        self._log.close()


class Caller(threading.Thread):
    """Spawns and deletes models of its own by services, and notes what it was told."""

    def __init__(self, graph, number, shared):
        super().__init__(daemon=True)
        self.ledger, self.unsure, self.wrong = set(), set(), []
        self.done = self.failed = 0
        self.slowest = 0.0
        self._graph, self._number, self._shared = graph, number, shared
        self._made = 0
        self._random = random.Random(number)
        self._stopping = threading.Event()

    def run(self):
        while not self._stopping.is_set():
            with self._shared:  # held while the world is saved
                began = time.monotonic()
                try:
                    self._one()
                    self.done += 1
                except (rospy.ServiceException, rospy.ROSException, OSError):
                    self.failed += 1
                    time.sleep(0.01)
                except Exception as defect:
                    self.wrong.append(repr(defect))
                    return
                self.slowest = max(self.slowest, time.monotonic() - began)
            time.sleep(0.001)

    def _one(self):
        if self.ledger and self._random.random() < 0.4:
            name = self._random.choice(sorted(self.ledger))
            self.unsure.add(name)
            answer = self._graph.call("delete_model", srv.DeleteModel, model_name=name)
            self.ledger.discard(name)
        else:
            self._made += 1
            name = f"c{self._number}_{self._made}"
            self.unsure.add(name)
            answer = self._graph.call(
                "spawn_sdf_model", srv.SpawnModel, model_name=name, initial_pose=PLACE,
                model_xml=write_entity(box(name, static=True)).decode())
            self.ledger.add(name)
        self.unsure.discard(name)
        if not answer.success:
            self.wrong.append(answer.status_message)

    def stop(self):
        self._stopping.set()
        self.join(2 * LONGEST_CALL_S)
        assert not self.is_alive(), "a call never ended"


@pytest.fixture
def graph(tmp_path, monkeypatch):
    monkeypatch.setattr(logging.getLogger("rospy.service"), "disabled", True)  # each failed look-up
    made = Graph(str(tmp_path))
    yield made
    made.close()


def start_callers(graph):
    shared = [threading.Lock() for _ in range(scaled(2, 8))]
    callers = [Caller(graph, n, lock) for n, lock in enumerate(shared)]
    for caller in callers:
        caller.start()
    return callers, shared


def progress(callers, what):
    before = [caller.done for caller in callers]
    until(lambda: all(caller.done > done for caller, done in zip(callers, before)), what)


def test_a_killed_node_leaves_nothing_behind_and_comes_back_as_it_was_saved(graph, record):
    callers, shared = start_callers(graph)
    kills = scaled(2, 50)
    for n in range(kills):
        progress(callers, "calls")
        for lock in shared:
            lock.acquire()
        told = set().union(*(caller.ledger for caller in callers))
        unsure = set().union(*(caller.unsure for caller in callers))
        answer = graph.call("save_world", SaveWorld, path=graph.world, overwrite=True)
        assert answer.success, answer.status_message
        assert graph.names() ^ told <= unsure
        node = until_pid(graph)
        left = [node, *children(node)]
        if n % 2:  # now and then while calls are under way
            for lock in shared:
                lock.release()
        os.killpg(graph.node.pid, signal.SIGKILL)
        graph.node.wait()
        until(lambda pids=left: not any(map(lives, pids)), "the end of node and engine")
        if n % 2:
            for lock in shared:
                lock.acquire()
        graph.start_node()
        assert graph.names() ^ told <= unsure
        # What was told after the save went with the node.
        there = graph.names()
        for caller in callers:
            caller.ledger = {name for name in there if name.startswith(f"c{caller._number}_")}
            caller.unsure.clear()
        for lock in shared:
            lock.release()
    progress(callers, "calls")
    for caller in callers:
        caller.stop()
    assert [wrong for caller in callers for wrong in caller.wrong] == []
    slowest = max(caller.slowest for caller in callers)
    assert slowest < LONGEST_CALL_S
    record("node killed", kills=kills, callers=len(callers), left_behind=0, lost=0, wrong=0,
           operations=sum(caller.done for caller in callers),
           failed_calls=sum(caller.failed for caller in callers), slowest_call_s=round(slowest, 1))


def until_pid(graph):
    """The node's process (rosrun may be its parent)."""
    found = []
    until(lambda: found.append(master_api.running_node(graph.uri, "/gazebo")) or found[-1],
          "the node's process")
    return found[-1][1]


def test_a_killed_master_that_is_started_again_has_the_node_again(graph, record):
    callers, _ = start_callers(graph)
    kills = scaled(1, 30)
    for _ in range(kills):
        progress(callers, "calls")
        engine = children(until_pid(graph))
        os.killpg(graph.master.pid, signal.SIGKILL)
        graph.master.wait()
        graph.start_master()
        until(graph.answers, "the node's registration")
        progress(callers, "calls by the new master")
        assert children(until_pid(graph)) == engine  # neither node nor engine noticed
    for caller in callers:
        caller.stop()
    assert [wrong for caller in callers for wrong in caller.wrong] == []
    told = set().union(*(caller.ledger for caller in callers))
    unsure = set().union(*(caller.unsure for caller in callers))
    assert graph.names() ^ told <= unsure
    with mock.patch.dict(os.environ, ROS_MASTER_URI=graph.uri):
        assert "/gazebo/spawn_sdf_model" in rosservice.get_service_list()
    record("master killed", kills=kills, callers=len(callers), lost=0, wrong=0,
           operations=sum(caller.done for caller in callers),
           failed_calls=sum(caller.failed for caller in callers))


def test_a_killed_sensing_process_costs_its_requests_only(record):
    simulator = Simulator(World(models=[box("a")], gravity=(0.0, 0.0, 0.0)), paused=True,
                          engine_factory=ProcessEngine, log=lambda issue: None)
    simulator.start()
    sensing = SensingProcess()
    deaths = []
    sensing.on_problem(deaths.append)
    kills, lost, answers = scaled(4, 200), 0, 0
    fan, mount = RayFan(31, -math.pi / 2, math.pi / 2, far=20.0), Mount()
    try:
        shape = Collision("c", Box((0.2, 10.0, 12.0)))
        wall = Model("wall", links=[Link("link", collisions=[shape])])
        sensing.change(LoadScene([Body("wall", wall, 1, {})], []))
        # Rows as the ring holds them: poses and twists of the world and of the wall.
        places = np.array([[x, 0, 0, 0, 0, 0, 1, *[0] * 6] for x in (0.0, 5.1)]).tobytes()
        expected = sensing.cast(CastRays(mount, fan, at=places)).result(LONGEST_CALL_S).ranges
        for n in range(kills):
            asked = [sensing.cast(CastRays(mount, fan, at=places)) for _ in range(20)]
            asked[n % len(asked)].result(LONGEST_CALL_S)
            os.kill(sensing.pid, signal.SIGKILL)
            for one in asked:
                try:
                    assert list(one.result(LONGEST_CALL_S).ranges) == list(expected)
                    answers += 1
                except SensingEndedError:
                    lost += 1
            # All may have been answered before the kill: then its death was not seen yet.
            until(lambda n=n: len(deaths) > n, "the death to be seen")
            again = sensing.cast(CastRays(mount, fan, at=places)).result(LONGEST_CALL_S)
            assert list(again.ranges) == list(expected)
            simulator.clock.advance(5)
        assert simulator.clock.step == 5 * kills and simulator.models.names() == ["a"]
    finally:
        sensing.close()
        simulator.close()
    record("sensing process killed", kills=kills, answers=answers, refused=lost, wrong=0)
