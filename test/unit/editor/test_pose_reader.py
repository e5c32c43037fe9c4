"""Poses that pages and logs get are those of the step that they are stamped with."""
from __future__ import annotations

import time

import pytest
from editor_case import box
from running_simulator import started

from my_simulations.description.world import World
from my_simulations.editor.transport.pose_reader import PoseReader
from my_simulations.engine.ring import RingWriter
from my_simulations.geometry import Pose, Twist


@pytest.fixture
def flight():
    """A box that flies with 1 m/s along x from the origin, at sim time 0; twists are unused."""
    simulator = started(World(models=[box("a")], gravity=(0.0, 0.0, 0.0)))
    simulator.states.set_model_state("a", Pose(), Twist((1.0, 0.0, 0.0)))
    yield simulator
    simulator.close()


def poses_of(simulator):
    return PoseReader(simulator).read(simulator.models.revision, 0.0)


def test_a_moving_body_is_where_it_was_at_the_time_of_its_poses(flight):
    flight.feed.request("test", poses_hz=10.0)
    flight.clock.unpause()
    found, end = {}, time.monotonic() + 60.0
    while len(found) < 6:
        assert time.monotonic() < end
        poses = poses_of(flight)
        found[poses.step] = (float(poses.values[0][0]), poses.sim_time)
    for where, when in found.values():
        assert where == pytest.approx(when, abs=1e-5)


def test_poses_that_are_older_than_the_step_count_say_so(flight):
    before = poses_of(flight)
    # Not every step is read out: the engine goes on before it writes again.
    RingWriter(memory=flight._session.ring.memory).set_step(before.step + 40)
    assert flight.clock.step == before.step + 40
    after = poses_of(flight)
    assert (after.step, after.sim_time) == (before.step, before.sim_time)


def test_a_body_at_rest_is_where_it_was_until_now(flight):
    flight.states.set_model_state("a", Pose((2.0, 0.0, 0.0)), Twist())
    flight.feed.request("test", poses_hz=1000.0)
    flight.clock.advance(500)
    assert poses_of(flight).step == flight.clock.step == 500
