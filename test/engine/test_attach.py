"""Links that are attached to others while the world runs, and let go."""
from __future__ import annotations

import os
import signal

import pytest
from conftest import box, ground
from inline_engine import InlineEngine
from running_simulator import started

from my_simulations.description.model import Joint, Link, Model
from my_simulations.description.world import Physics, World
from my_simulations.engine.bullet.backend import BulletBackend
from my_simulations.engine.process_engine import ProcessEngine
from my_simulations.errors import CommandError
from my_simulations.geometry import STILL, Pose, Twist, compose, inverse


def world(make):
    held, hand = box("held", 0.1, 0.5), box("hand", 0.2, 2.0)
    held.pose, hand.pose = Pose((0.0, 0.0, 0.849)), Pose((0.0, 0.0, 1.0))
    made = started(World(models=[ground(mu=1.0), held, hand]), engine=make)
    made.models.hold("hand", True)
    return made


@pytest.fixture
def sim():
    engine = InlineEngine(BulletBackend)
    made = world(lambda: engine)
    yield made
    made.close()


def pose(sim, name):
    return sim.states.model_state(name)[0]


def test_what_is_attached_hangs_and_what_is_let_go_falls_at_g(sim):
    sim.models.attach("grasp", "hand::link", "held::link")
    sim.clock.advance(1000)
    assert pose(sim, "held").position == pytest.approx((0.0, 0.0, 0.849), abs=1e-4)
    assert sim.models.detach("grasp") and not sim.models.detach("grasp")
    sim.clock.advance(200)
    fallen = 0.849 - pose(sim, "held").position[2]
    assert fallen == pytest.approx(9.8 * 0.2 ** 2 / 2, rel=0.01)


@pytest.mark.parametrize("step", [0.001, 0.002, 0.005])
@pytest.mark.parametrize("parent", ["post::post", "world"])
def test_a_load_at_a_joint_does_not_make_it_yield(step, parent):
    """Weight and a wrench; by 5 a dt^2 it would yield, 64 mm at steps of 5 ms."""
    post = Model("post", links=[Link("post")], joints=[Joint("foot", "fixed", "world", "post")])
    held = box("held", 0.1, 0.5)
    held.pose = Pose((0.3, 0.0, 1.0))
    sim = started(World(models=[post, held], physics=Physics(max_step_size=step)),
                  engine=lambda: InlineEngine(BulletBackend))
    sim.models.attach("grasp", parent, "held::link")
    sim.wrenches.apply_wrench("held::link", (0.0, 200.0, -100.0), (0.0, 0.0, 0.0))
    sim.clock.advance(round(0.5 / step))
    assert pose(sim, "held").position == pytest.approx((0.3, 0.0, 1.0), abs=1e-5)
    sim.close()


def test_it_is_carried_without_slipping(sim):
    sim.models.attach("grasp", "hand::link", "held::link")
    before = compose(inverse(pose(sim, "hand")), pose(sim, "held"))
    sim.models.hold("hand", False)
    for _ in range(100):
        here = pose(sim, "hand")
        sim.states.set_model_state("hand", here, Twist((0.5, 0.2, 0.3), (0.0, 0.0, 1.0)))
        sim.clock.advance(10)
    after = compose(inverse(pose(sim, "hand")), pose(sim, "held"))
    assert after.position == pytest.approx(before.position, abs=5e-3)


def test_they_collide_again(sim):
    sim.models.attach("grasp", "hand::link", "held::link")
    sim.clock.advance(10)
    sim.models.detach("grasp")
    sim.models.hold("hand", False)
    sim.clock.advance(2000)
    assert pose(sim, "hand").position[2] > 0.15


def test_a_reset_lets_go(sim):
    sim.models.attach("grasp", "hand::link", "held::link")
    sim.resets.reset_simulation()
    sim.models.hold("hand", True)
    sim.clock.advance(1000)
    assert pose(sim, "held").position[2] == pytest.approx(0.05, abs=1e-3)


def test_a_new_engine_holds_on():
    sim = world(ProcessEngine)
    try:
        sim.models.attach("grasp", "hand::link", "held::link")
        os.kill(sim.engine_pid, signal.SIGKILL)
        sim.states.fresh()  # waits for the new one
        sim.clock.advance(500)
        assert pose(sim, "held").position == pytest.approx((0.0, 0.0, 0.849), abs=1e-4)
    finally:
        sim.close()


def test_links_that_are_not_there_are_refused(sim):
    with pytest.raises(CommandError, match="nothing"):
        sim.models.attach("grasp", "hand::nothing", "held::link")
    sim.states.set_model_state("held", Pose((0.0, 0.0, 2.0)), STILL)
    sim.models.attach("grasp", "world", "held::link")
    sim.clock.advance(300)
    assert pose(sim, "held").position[2] == pytest.approx(2.0, abs=1e-4)
