"""A light is a reference frame as models and links are (Gazebo behaviour)."""
from __future__ import annotations

import math

import pytest
from running_simulator import running

from my_simulations.description.light import Light
from my_simulations.description.model import Link, Model
from my_simulations.description.world import World
from my_simulations.geometry import STILL, Pose, quat_from_rpy
from my_simulations.simulator.registry import UnknownFrameError


@pytest.fixture
def sim():
    lamp = Light("lamp", pose=Pose((1.0, 2.0, 3.0), quat_from_rpy(0, 0, math.pi / 2)))
    with running(World(models=[Model("box", links=[Link("link")])], lights=[lamp]),
                 log=print) as made:
        yield made


def test_states_are_told_and_set_in_the_frame_of_a_light(sim):
    sim.states.set_model_state("box", Pose((1.0, 0.0, 0.0)), STILL, "lamp")
    assert sim.states.model_state("box")[0].position == pytest.approx((1.0, 3.0, 3.0))
    assert sim.states.link_state("box::link", "lamp")[0].position == pytest.approx((1.0, 0.0, 0.0))


def test_a_light_that_is_gone_is_no_frame(sim):
    sim.lights.delete("lamp")
    with pytest.raises(UnknownFrameError):
        sim.states.model_state("box", "lamp")
