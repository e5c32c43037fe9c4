"""The simulator refuses models beyond the limits of a model and of a world, of any origin."""
from __future__ import annotations

import pytest
from running_simulator import running

from my_simulations.description import cost_budget
from my_simulations.description.cost_budget import MODEL_BUDGET, Cost
from my_simulations.description.model import Link, Model
from my_simulations.description.world import World
from my_simulations.errors import CommandError


@pytest.fixture
def simulator():
    with running(World()) as made:
        yield made


def model(name, count=1):
    return Model(name, links=[Link(f"l{n}") for n in range(count)])


def test_a_model_beyond_its_limit_is_refused_by_spawn_and_by_edit(simulator):
    large = model("a", MODEL_BUDGET.links + 1)
    with pytest.raises(CommandError, match="has 2001 links; 2000 are possible"):
        simulator.models.spawn(large)
    simulator.models.spawn(model("a"))
    with pytest.raises(CommandError, match="2000 are possible"):
        simulator.models.edit("a", large)
    assert simulator.models.names() == ["a"]


def test_the_limit_of_a_world_counts_what_is_there_now(simulator, monkeypatch):
    monkeypatch.setattr(cost_budget, "WORLD_BUDGET", Cost(links=4, shapes=9, triangles=9))
    simulator.models.spawn(model("a", 3))
    with pytest.raises(CommandError, match="the world would have 5 links; 4 are possible"):
        simulator.models.spawn(model("b", 2))
    simulator.models.delete("a")
    simulator.models.spawn(model("b", 2))
    simulator.models.spawn(model("c", 2))
    with pytest.raises(CommandError):
        simulator.models.spawn(model("d"))
