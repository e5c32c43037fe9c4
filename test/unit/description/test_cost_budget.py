"""Limits of what a model and a world may cost, refused before the engine builds anything."""
from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from my_simulations.description.cost_budget import (
    MODEL_BUDGET,
    WORLD_BUDGET,
    Cost,
    budget_faults,
    cost_of,
    world_excess,
)
from my_simulations.description.flatten import flatten_model
from my_simulations.description.model import Joint, Link, Model
from my_simulations.description.plugin import PluginSpec
from my_simulations.description.sensor import Sensor
from my_simulations.description.shapes import Box, Collision, Mesh, MeshData, mesh_key


def link(name, count=1, **more):
    return Link(name, collisions=[Collision(f"c{n}", Box()) for n in range(count)], **more)


def test_links_and_shapes_of_nested_models_are_counted():
    model = Model("m", static=True, links=[link("a", 3), Link("b")],
                  models=[Model("n", links=[link("c", 2)])])
    assert cost_of(model) == Cost(links=3, shapes=5)


def test_links_without_collisions_make_no_pairs():
    assert cost_of(Model("m", links=[Link(f"l{n}") for n in range(100)])).pairs == 0


def test_pairs_of_a_tree_count_only_if_it_collides_with_itself():
    links = [link(f"l{n}") for n in range(4)]
    joints = [Joint("a", "revolute", "l0", "l1"), Joint("b", "fixed", "l1", "l2")]
    assert cost_of(Model("m", links=links, joints=joints)).pairs == 3
    assert cost_of(Model("m", links=links, joints=joints)).colliding_pairs == 0
    asking = cost_of(Model("m", links=links, joints=joints, self_collide=True))
    assert (asking.pairs, asking.colliding_pairs) == (6, 6)
    one = [*links[:3], dataclasses.replace(links[3], self_collide=True)]
    assert cost_of(Model("m", links=one, joints=joints)).colliding_pairs == 3
    assert cost_of(Model("m", links=links, joints=joints, static=True)).pairs == 0


def test_a_joint_to_the_world_connects_no_links():
    links = [link("l0"), link("l1")]
    joints = [Joint("a", "fixed", "world", "l0"), Joint("b", "fixed", "world", "l1")]
    assert cost_of(Model("m", links=links, joints=joints)).pairs == 1


def test_a_mesh_counts_for_each_collision_and_its_parts_count_as_shapes_if_it_moves():
    mesh = Mesh("x", "/x.stl")
    part = MeshData(np.zeros((3, 3)), np.zeros((1, 3), np.int32))
    table = {mesh_key(mesh): MeshData(np.zeros((3, 3)), np.zeros((7, 3), np.int32), [part] * 4)}
    links = [Link("l", collisions=[Collision("a", mesh), Collision("b", mesh)])]
    assert cost_of(Model("m", links=links), table) == Cost(1, 8, 14)
    assert cost_of(Model("m", links=links, static=True), table) == Cost(1, 2, 14)
    assert cost_of(Model("m", links=links)) == Cost(1, 2, 0)


def test_plugins_of_sensors_and_nested_models_are_counted():
    plugin = PluginSpec("p", "libp.so")
    sensor = Sensor("s", "imu", plugins=[plugin])
    inner = Model("n", plugins=[plugin, plugin], links=[Link("c", sensors=[sensor])])
    model = Model("m", plugins=[plugin], links=[Link("a", sensors=[sensor]), Link("b")],
                  joints=[Joint("j", "fixed", "a", "b", sensors=[sensor])], models=[inner])
    for one in (model, flatten_model(model)):
        assert cost_of(one).plugins == 6


@pytest.mark.parametrize("name", [field.name for field in dataclasses.fields(Cost)])
def test_each_limit_is_reported_with_both_numbers(name):
    most = getattr(MODEL_BUDGET, name)
    model = Model("m")
    assert not list(budget_faults(Cost(**{name: most}), model))
    (fault,) = budget_faults(Cost(**{name: most + 1}), model)
    assert fault.code == "model-too-large"
    assert f"{most + 1} " in fault.message and f"{most} are possible" in fault.message
    assert fault.hint and fault.subject is model
    most = getattr(WORLD_BUDGET, name)
    assert world_excess(Cost(**{name: most})) == ""
    assert f"{most + 1} " in world_excess(Cost(**{name: most + 1}))


def test_large_useful_models_are_within_the_limits():
    assert not list(budget_faults(Cost(links=300, shapes=1000, triangles=500_000, pairs=44_850,
                                  colliding_pairs=44_850), Model("robot")))
    assert not world_excess(Cost(links=10_000, shapes=40_000, triangles=2_000_000, pairs=500_000,
                                 colliding_pairs=50_000))
