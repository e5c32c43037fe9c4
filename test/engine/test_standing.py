"""Structures that must stand: stacks, unlike masses, cards, meshes."""
from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from conftest import Lab, box, ground, inertial_of_box, link_of, slab
from laws import Laws
from test_contact import _cube_mesh

from my_simulations.description.model import Model
from my_simulations.description.shapes import Box, Mesh, MeshData, Surface, mesh_key
from my_simulations.geometry import Pose


def _assert_stack_stands(lab: Lab, laws: Laws, masses, seconds: float, law: str, bar: float):
    """Put boxes of these masses, kg, on each other; none may ever be deactivated."""
    lab.load(ground())
    stack = [lab.load(replace(box(f"b{n}", mass=float(mass)), allow_auto_disable=False),
                      (0, 0, 0.5 + n)) for n, mass in enumerate(masses)]
    lab.seconds(seconds)
    for n, model in enumerate(stack):
        laws.near(f"{law}: off their place, m", lab.pose(model).position, (0, 0, 0.5 + n), abs=bar)


@pytest.mark.parametrize("seconds", [10, pytest.param(60, marks=pytest.mark.long)])
def test_twenty_boxes_on_each_other_stand(lab: Lab, laws: Laws, seconds: int):
    _assert_stack_stands(lab, laws, [1.0] * 20, seconds,
                         f"twenty boxes on each other, awake, for {seconds} s", 0.01)


@pytest.mark.parametrize("masses", [(1, 100, 1000), (1000, 100, 1), (1, 1000, 1)])
def test_heavy_boxes_stand_on_light_ones(lab: Lab, laws: Laws, masses):
    _assert_stack_stands(lab, laws, masses, 20,
                         "masses 1, 100 and 1000 kg on each other for 20 s", 2e-3)


@pytest.mark.parametrize("step_size", [0.002, 0.005])
@pytest.mark.parametrize("masses", [(1, 100, 1000), (1, 1000, 1)])
def test_heavy_boxes_stand_on_light_ones_with_longer_steps(lab: Lab, laws: Laws, masses,
                                                           step_size: float):
    """With the iterations of a step of 1 ms they sank into each other by up to 0.34 m."""
    lab.configure(step_size=step_size)
    _assert_stack_stands(lab, laws, masses, 5,
                         "masses 1 to 1000 kg on each other, steps of 2 and 5 ms", 5e-3)


def test_twenty_cards_lie_on_each_other(lab: Lab, laws: Laws):
    size = (0.06, 0.09, 0.002)
    lab.load(ground())
    cards = [lab.load(Model(f"card{n}", allow_auto_disable=False, links=[link_of(
        Box(size), inertial_of_box(0.002, *size), Surface(mu=0.5))]),
        (0, 0, 0.001 + 0.002 * n)) for n in range(20)]
    lab.seconds(10)
    for n, card in enumerate(cards):
        laws.near("twenty cards of 2 g for 10 s: off their place, m",
                  lab.pose(card).position, (0, 0, 0.001 + 0.002 * n), abs=5e-4)


@pytest.mark.parametrize("floor", ["plane", "box"])
def test_a_mesh_rests_at_its_height(lab: Lab, laws: Laws, floor: str):
    if floor == "plane":
        lab.load(ground())
    else:
        lab.load(slab("floor", (20, 20, 1)), (0, 0, -0.5))
    mesh = Mesh("cube", "/cube")
    cube = lab.load(Model("cube", allow_auto_disable=False, links=[link_of(
        mesh, inertial_of_box(1, 1, 1, 1))]), (0, 0, 0.55), meshes={mesh_key(mesh): _cube_mesh()})
    lab.seconds(2)
    start = lab.pose(cube).position
    laws.near("a mesh of one convex piece at rest: height, m", start[2], 0.5, abs=1e-4)
    lab.seconds(30)
    laws.at_most("a mesh of one convex piece at rest: way in 30 s, m",
                 math.dist(lab.pose(cube).position, start), 1e-4)


@pytest.mark.parametrize("floor", ["plane", "box"])
def test_a_mesh_of_several_pieces_rests_at_its_height(lab: Lab, laws: Laws, floor: str):
    if floor == "plane":
        lab.load(ground())
    else:
        lab.load(slab("floor", (20, 20, 1)), (0, 0, -0.5))
    cube, mesh = _cube_mesh(), Mesh("u", "/u")
    boxes = [((1, 0.5, 0.1), (0, 0, 0)), ((0.1, 0.5, 0.5), (-0.45, 0, 0.3)),
             ((0.1, 0.5, 0.5), (0.45, 0, 0.3))]
    parts = [MeshData(cube.vertices * size + at, cube.triangles) for size, at in boxes]
    whole = MeshData(np.concatenate([part.vertices for part in parts]),
                     np.concatenate([cube.triangles + 8 * n for n in range(3)]), parts)
    u = lab.load(Model("u", allow_auto_disable=False, links=[link_of(
        mesh, inertial_of_box(3, 1, 0.5, 0.6, Pose((0, 0, 0.15))))]), (0, 0, 0.06),
        meshes={mesh_key(mesh): whole})
    lab.seconds(2)
    laws.near("a mesh of several convex pieces at rest: height, m", lab.pose(u).position[2],
              0.05, abs=1e-4)
