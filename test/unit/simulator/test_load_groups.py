"""The models of a world are loaded by few commands; those that are refused cost only themselves."""
from __future__ import annotations

import pytest
from kinematic_backend import KinematicBackend
from running_simulator import running

from my_simulations.description.model import Joint, JointAxis, Link, Model
from my_simulations.description.shapes import Box, Collision, Mesh
from my_simulations.description.world import World
from my_simulations.engine.api import CommandRefusedError
from my_simulations.engine.commands import LoadModel
from my_simulations.simulator import load_groups
from my_simulations.simulator.load_groups import small_groups


def model(name, links=1, shapes=0, geometry=None, joints=()):
    return Model(name, links=[
        Link(f"l{n}", collisions=[Collision(f"c{k}", geometry or Box()) for k in range(shapes)])
        for n in range(links)], joints=list(joints))


def names(groups):
    return [[one.name for one in group] for group in groups]


def test_groups_keep_the_order_and_the_limits(monkeypatch):
    monkeypatch.setattr(load_groups, "_MOST_MODELS", 3)
    monkeypatch.setattr(load_groups, "_MOST_LINKS", 5)
    monkeypatch.setattr(load_groups, "_MOST_SHAPES", 4)
    models = [model("a"), model("b"), model("c"), model("d", 5), model("e"), model("f", 1, 3),
              model("g", 1, 2), model("h", 9)]
    assert names(small_groups(models)) == [["a", "b", "c"], ["d"], ["e", "f"], ["g"], ["h"]]
    assert names(small_groups([])) == []


@pytest.mark.parametrize("other", [
    model("x", 1, 1, Mesh("m", "/m")),
    model("x", joints=[Joint("j", "revolute", "l0", "nowhere", axis=JointAxis())]),
    model("a"), model("")])
def test_models_with_meshes_and_those_that_may_be_refused_are_alone(other):
    found = names(small_groups([model("a"), model("b"), other, model("c"), model("d")]))
    assert found == [["a", "b"], [other.name], ["c", "d"]]


class Backend(KinematicBackend):
    """Refuses models of one name, and counts what it loads."""

    loaded: list = []

    def apply(self, command):
        if isinstance(command, LoadModel):
            if command.model.name == "bad":
                raise CommandRefusedError("it is bad")
            self.loaded.append(command.model.name)
        return super().apply(command)


def test_a_refused_model_costs_only_itself():
    issues = []
    with running(World(models=[model(name) for name in ("a", "bad", "b")]), Backend,
                 log=issues.append) as simulator:
        assert simulator.models.names() == ["a", "b"]
        refused = [one.message for one in issues if one.code == "model-refused"]
        assert refused == ["skipped model 'bad': it is bad"]
        assert simulator.models.losses == refused
