"""States that are set without waiting for the engine, and shown by whatever reads states."""
from __future__ import annotations

import threading
import time

import pytest
from inline_engine import InlineEngine
from kinematic_backend import KinematicBackend
from running_simulator import started

from my_simulations.description.model import Inertial, Link, Model
from my_simulations.description.world import World
from my_simulations.engine.api import MOST_POSTED, CommandRefusedError
from my_simulations.engine.commands import SetModelState
from my_simulations.geometry import STILL, Pose

WAIT = 60.0
THERE = Pose((1.0, 2.0, 3.0))


class Gate(KinematicBackend):
    """Stops at commands that move models while the gate is shut."""

    open = threading.Event()
    reached = threading.Event()
    faults: "list[Exception]" = []

    def apply(self, command):
        if isinstance(command, SetModelState):
            self.reached.set()
            assert self.open.wait(WAIT)
            if self.faults:
                raise self.faults.pop()
        return super().apply(command)


class Case:
    def __init__(self):
        Gate.open, Gate.reached, Gate.faults = threading.Event(), threading.Event(), []
        self.issues = []
        self.engine = InlineEngine(Gate)
        world = World(models=[Model("a", links=[Link("link", inertial=Inertial())])])
        self.sim = started(world, engine=lambda: self.engine, log=self.issues.append)

    def put(self, pose=THERE):
        self.sim.states.set_model_state("a", pose, STILL)

    def position(self):
        return self.sim.states.model_state("a")[0].position


@pytest.fixture
def case():
    made = Case()
    yield made
    Gate.open.set()
    made.sim.close()


def in_thread(call):
    found = []
    thread = threading.Thread(target=lambda: found.append(call()), daemon=True)
    thread.start()
    return thread, found


READERS = {
    "a model": lambda sim: sim.states.model_state("a")[0].position,
    "a model in a frame": lambda sim: sim.states.model_state("a", "a::link")[0].position,
    "a link": lambda sim: sim.states.link_state("a::link")[0].position,
    "a row": lambda sim: sim.states.link_at(0)[0].position,
    "all": lambda sim: sim.states.latest()[1].link(0)[0].position,
    "a capture": lambda sim: sim.states.capture().models["a"].pose.position,
}


@pytest.mark.parametrize("name", READERS)
def test_setting_does_not_wait_for_a_busy_engine_and_reading_does(case, name):
    case.put()
    assert Gate.reached.wait(WAIT)  # `put` has returned, and the engine is still at it
    thread, found = in_thread(lambda: READERS[name](case.sim))
    assert not found
    Gate.open.set()
    thread.join(WAIT)
    assert found == [(0.0, 0.0, 0.0) if "frame" in name else THERE.position]


def test_the_states_of_many_calls_arrive_in_order_and_more_than_may_wait_do(case):
    thread, done = in_thread(lambda: [case.put(Pose((float(n), 0.0, 0.0)))
                                      for n in range(2 * MOST_POSTED)])
    deadline = time.monotonic() + WAIT
    while len(case.engine._posts._unshown) < MOST_POSTED:
        assert time.monotonic() < deadline
        time.sleep(0.001)
    assert not done  # the next one waits for its turn
    Gate.open.set()
    thread.join(WAIT)
    assert case.position() == (2.0 * MOST_POSTED - 1.0, 0.0, 0.0)


def test_what_an_engine_had_not_applied_when_it_died_is_applied_by_the_next_one(case):
    case.put()
    assert Gate.reached.wait(WAIT)
    killing = threading.Thread(target=case.engine.kill)
    killing.start()
    deadline = time.monotonic() + WAIT
    while case.engine._alive:  # it is told to end before it has applied the command
        assert time.monotonic() < deadline
        time.sleep(0.001)
    Gate.open.set()
    killing.join(WAIT)
    assert case.position() == THERE.position
    assert [issue.code for issue in case.issues] == ["engine-died"]


def test_a_refusal_that_nobody_waits_for_is_logged(case):
    Gate.faults.append(CommandRefusedError("the pose is odd"))
    Gate.open.set()
    case.put()
    assert case.position() == (0.0, 0.0, 0.0)
    assert [(issue.code, issue.message) for issue in case.issues] == [
        ("command-refused", "the pose is odd")]


def test_a_state_is_set_while_models_change_and_waits_for_the_engine_then(case):
    with case.sim.change_lock:
        thread, done = in_thread(lambda: case.put() or True)
        assert Gate.reached.wait(WAIT) and not done
        Gate.open.set()
        thread.join(WAIT)
        assert done
    assert case.position() == THERE.position
