"""Large static meshes: built in pieces, and in advance, while simulated time goes on."""
from __future__ import annotations

import math

import numpy as np
import pytest
from conftest import Lab, ball

from my_simulations.description.model import Link, Model
from my_simulations.description.shapes import Collision, Mesh, MeshData, mesh_key
from my_simulations.engine.bullet import collision_shapes, shape_preparation
from my_simulations.engine.commands import ContinuePreparation, PrepareModel
from my_simulations.geometry import Pose

MOST = 300
MESH = Mesh("terrain", "/terrain")
MODEL = Model("terrain", static=True, links=[Link("link", collisions=[
    Collision("c", MESH, pose=Pose((0.0, 0.0, 0.5)))])])


def terrain(count=20):
    """A bowl of squares of 1 m, two triangles each."""
    at = np.arange(count + 1) - count / 2
    x, y = (side.ravel() for side in np.meshgrid(at, at, indexing="ij"))
    points = np.stack([x, y, 0.02 * (x * x + y * y)], axis=1)
    a = (np.arange(count)[:, None] * (count + 1) + np.arange(count)).ravel()
    b = a + count + 1
    return MeshData(points, np.concatenate([np.stack([a, b, a + 1], axis=1),
                                            np.stack([a + 1, b, b + 1], axis=1)]).astype(np.int32))


@pytest.fixture(autouse=True)
def small(monkeypatch):
    monkeypatch.setattr(collision_shapes, "MAX_TRIANGLES", MOST)


@pytest.fixture
def made(monkeypatch):
    """Triangles of the file of each shape that is made."""
    counts = []
    make = collision_shapes.Recipe.make

    def counted(recipe):
        for path in filter(None, recipe.arguments["fileNames"]):
            with open(path, encoding="ascii") as stream:
                counts.append(sum(row.startswith("f") for row in stream))
        return make(recipe)

    monkeypatch.setattr(collision_shapes.Recipe, "make", counted)
    return counts


def test_a_large_mesh_is_divided_and_carries_as_a_whole(lab: Lab, made):
    lab.load(MODEL, meshes={mesh_key(MESH): terrain()})
    assert made == [MOST, MOST, 800 - 2 * MOST]
    balls = [lab.load(ball(f"b{n}", radius=0.3), (2.0 * n - 8.0, 0.1, 3.0)) for n in range(9)]
    lab.seconds(3.0)
    for number in balls:
        x, y, z = lab.pose(number).position
        assert z == pytest.approx(0.02 * (x * x + y * y) + 0.8, abs=0.15)
        assert math.hypot(x, y) < 9.0


def test_a_prepared_model_is_loaded_without_making_a_shape(lab: Lab, made, monkeypatch):
    monkeypatch.setattr(shape_preparation.time, "perf_counter",
                        iter(n / 2 for n in range(1000)).__next__)
    monkeypatch.setattr(shape_preparation, "_SLICE_S", 0.6)   # one shape at a time
    meshes = {mesh_key(MESH): terrain()}
    falling = lab.load(ball("falling", radius=0.3), (0.0, 0.0, 50.0))
    assert lab.apply(PrepareModel(77, MODEL, meshes)) is True
    before, rounds = len(made), 0
    assert before == 0
    while lab.apply(ContinuePreparation(77)):
        assert len(made) <= before + 1
        before, rounds = len(made), rounds + 1
        lab.steps(1)
    assert made == [MOST, MOST, 800 - 2 * MOST] and rounds >= 3
    assert lab.pose(falling).position[2] < 50.0
    assert lab.apply(ContinuePreparation(77)) is False
    lab.load(MODEL, meshes=meshes)
    assert len(made) == 3
    lab.load(MODEL, (0.0, 0.0, -5.0), meshes=meshes)   # prepared shapes are used once
    assert len(made) == 6


def test_a_preparation_that_fails_ends_and_an_unknown_one_is_done(lab: Lab):
    assert lab.apply(PrepareModel(5, MODEL, {})) is True
    assert lab.apply(ContinuePreparation(5)) is False
    assert lab.apply(ContinuePreparation(6)) is False
