"""Shapes of large static models are made by commands of their own while simulated time runs."""
from __future__ import annotations

import numpy as np
import pytest
from kinematic_backend import KinematicBackend
from running_simulator import running

from my_simulations.description.model import Link, Model
from my_simulations.description.shapes import Collision, Mesh, MeshData, mesh_key
from my_simulations.description.world import World
from my_simulations.engine.commands import Batch, ContinuePreparation, LoadModel, PrepareModel
from my_simulations.simulator.load_groups import PLAIN_TRIANGLES

MESH = Mesh("m", "/m")


class Backend(KinematicBackend):
    """Stores what it is told; a preparation takes three more commands."""

    def __init__(self, told):
        super().__init__()
        self._told, self._left = told, 3

    def apply(self, command):
        if isinstance(command, (LoadModel, PrepareModel, ContinuePreparation, Batch)):
            self._told.append(type(command).__name__)
        if isinstance(command, PrepareModel):
            return True
        if isinstance(command, ContinuePreparation):
            self._left -= 1
            return self._left > 0
        return super().apply(command)


@pytest.fixture
def told():
    return []


@pytest.fixture
def simulator(told):
    with running(World(), lambda: Backend(told), paused=False) as made:
        yield made


def spawn(simulator, triangles, static=True):
    link = Link("l", collisions=[Collision("c", MESH)])
    data = MeshData(np.eye(3), np.tile(np.arange(3, dtype=np.int32), (triangles, 1)), parts=[])
    simulator.models.spawn(Model("m", static=static, links=[link]),
                           meshes={mesh_key(MESH): data})


def test_a_large_static_model_is_prepared_until_nothing_is_left_to_do(simulator, told):
    spawn(simulator, PLAIN_TRIANGLES + 1)
    assert told == ["PrepareModel", *["ContinuePreparation"] * 3, "LoadModel"]


@pytest.mark.parametrize("triangles, static", [(PLAIN_TRIANGLES, True),
                                               (PLAIN_TRIANGLES + 1, False)])
def test_small_and_moving_models_are_loaded_at_once(simulator, told, triangles, static):
    spawn(simulator, triangles, static)
    assert told == ["LoadModel"]


def test_nothing_is_prepared_while_time_is_paused(simulator, told):
    simulator.clock.pause()
    spawn(simulator, PLAIN_TRIANGLES + 1)
    assert told == ["LoadModel"]
