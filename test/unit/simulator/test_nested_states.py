"""Nested models are models for the services: states, frames and properties (Gazebo behaviour)."""
from __future__ import annotations

import math
from types import SimpleNamespace

import pytest
from running_simulator import running

from my_simulations.description.model import Inertial, Link, Model
from my_simulations.description.world import World
from my_simulations.errors import CommandError
from my_simulations.geometry import STILL, Pose, quat_from_rpy
from my_simulations.ros.services.world_services import WorldServices
from my_simulations.simulator.registry import UnknownEntityError

TURNED = quat_from_rpy(0.0, 0.0, math.pi / 2)


def link(name, pose=Pose()):
    return Link(name, pose, inertial=Inertial(1.0, Pose(), 1.0, 0, 0, 1.0, 0, 1.0))


def position_of(sim, name, frame=""):
    return sim.states.model_state(name, frame)[0].position


@pytest.fixture
def sim():
    deepest = Model("deepest", Pose((0.0, 0.0, 4.0)), links=[link("a"), link("b")])
    inner = Model("inner", Pose((2.0, 0.0, 0.0), TURNED), links=[link("l", Pose((0.5, 0.0, 0.0)))])
    inner_with_more = Model("tree", Pose((0.0, 3.0, 0.0)), links=[link("l")], models=[deepest])
    outer = Model("outer", Pose((1.0, 1.0, 1.0)), links=[link("l")],
                  models=[inner, inner_with_more])
    box = Model("box", links=[link("l")])
    with running(World(models=[box, outer], gravity=(0.0, 0.0, 0.0)), log=print) as made:
        yield made


def test_states_of_nested_models_are_read_by_scoped_and_plain_names(sim):
    assert position_of(sim, "outer::inner") == pytest.approx((3.0, 1.0, 1.0))
    assert position_of(sim, "inner") == pytest.approx((3.0, 1.0, 1.0))
    assert position_of(sim, "outer::tree::deepest") == pytest.approx((1.0, 4.0, 5.0))
    assert position_of(sim, "outer::tree", "outer") == pytest.approx((0.0, 3.0, 0.0))
    for unknown in ("outer::other", "box::inner", "other"):
        with pytest.raises(UnknownEntityError):
            sim.states.model_state(unknown)


def test_a_plain_name_is_that_of_the_first_model_until_it_is_deleted(sim):
    other = Model("other", Pose((0.0, 0.0, 9.0)), links=[link("l")],
                  models=[Model("inner", Pose((1.0, 0.0, 0.0)), links=[link("l")])])
    sim.models.spawn(other)
    assert position_of(sim, "inner") == pytest.approx((3.0, 1.0, 1.0))
    sim.models.delete("outer")
    assert position_of(sim, "inner") == pytest.approx((1.0, 0.0, 9.0))
    sim.models.delete("other")
    with pytest.raises(UnknownEntityError):
        sim.states.model_state("inner")


def test_nested_models_are_reference_frames(sim):
    assert position_of(sim, "outer", "outer::tree") == pytest.approx((0.0, -3.0, 0.0))
    sim.states.set_model_state("box", Pose((1.0, 0.0, 0.0)), STILL, "outer::inner")
    assert position_of(sim, "box") == pytest.approx((3.0, 2.0, 1.0))


def test_a_nested_model_of_one_link_is_moved(sim):
    sim.states.set_model_state("outer::inner", Pose((0.0, 7.0, 1.0)), STILL)
    assert position_of(sim, "outer::inner") == pytest.approx((0.0, 7.0, 1.0))
    assert sim.states.link_state("outer::inner::l")[0].position == pytest.approx((0.5, 7.0, 1.0))
    assert position_of(sim, "outer") == pytest.approx((1.0, 1.0, 1.0))
    with pytest.raises(CommandError, match="nested model of 2 links"):
        sim.states.set_model_state("outer::tree::deepest", Pose(), STILL)


def test_a_nested_model_is_not_deleted(sim):
    with pytest.raises(UnknownEntityError, match="'inner' is nested in model 'outer'; name that"):
        sim.models.delete("inner")


def test_properties_of_nested_models(sim):
    services, response = WorldServices(sim), SimpleNamespace()
    services.get_model(SimpleNamespace(model_name="outer::tree"), response)
    assert (response.parent_model_name, response.body_names) == ("outer", ["l"])
    assert response.child_model_names == ["deepest"]
    services.get_model(SimpleNamespace(model_name="deepest"), response)
    assert (response.parent_model_name, response.body_names) == ("tree", ["a", "b"])
