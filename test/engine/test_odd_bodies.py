"""Bodies that files describe and no world holds: the engine takes them all the same."""
from __future__ import annotations

import pytest

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.world import World
from my_simulations.engine.bullet.backend import BulletBackend
from my_simulations.engine.inline import InlineEngine
from my_simulations.geometry import Pose
from my_simulations.simulator.simulator import Simulator

PLATE = Inertial(1.0, Pose((0.0, -0.5, 0.0)), ixx=0.05, iyy=0.05, izz=1.5)


def swinging(axis, seconds=0.2):
    """The position of a hinge about x, after a while, of a plate that starts beside it."""
    model = Model("m", Pose((0, 0, 3)), links=[Link("l", inertial=PLATE)],
                  joints=[Joint("j", "revolute", "world", "l", axis=axis)])
    faults = []
    sim = Simulator(World(models=[model]), engine_factory=lambda: InlineEngine(BulletBackend),
                    paused=True, log=faults.append)
    try:
        sim.start()
        sim.advance(round(seconds * 1000))
        ((position, rate),) = sim.joint_states("j")
    finally:
        sim.close()
    assert faults == []
    return position, rate


@pytest.mark.parametrize("damping", [0.0, 5.0])
def test_a_moment_above_the_sum_of_the_others_moves_as_the_file_says(damping):
    position, rate = swinging(JointAxis((1.0, 0.0, 0.0), damping=damping))
    if damping:
        assert 0.3 < rate < 9.8 * 0.5 / damping * 1.01  # at most where damper and weight balance
    else:  # 0.05 + 1 * 0.5^2 kg m^2 about the hinge, which the weight turns by 4.9 N m
        assert position == pytest.approx(0.5 * 4.9 / 0.3 * 0.2 ** 2, rel=0.03)


def test_a_welded_hinge_stays_where_it_is():
    position, rate = swinging(JointAxis((1.0, 0.0, 0.0), lower=0.0, upper=0.0, damping=1.0))
    assert abs(position) < 1e-3 and abs(rate) < 1e-3
