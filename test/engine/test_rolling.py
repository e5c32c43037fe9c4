"""Cylinders on their side: at rest, rolling free, and as wheels."""
from __future__ import annotations

import math
from typing import Tuple

import numpy as np
import pytest
from conftest import Lab, ground, link_of, slab
from laws import Laws

from my_simulations.description.model import Inertial, Link, Model
from my_simulations.description.shapes import (
    Collision,
    Cylinder,
    Mesh,
    MeshData,
    Surface,
    mesh_key,
)
from my_simulations.geometry import multiply, quat_from_rpy

SIZES = [(0.03, 0.02), (0.03, 0.1), (0.1, 0.3), (0.5, 0.02), (0.5, 0.5)]   # radius, width


def cylinder(radius: float, width: float, name: str = "can", asleep: bool = True) -> Model:
    across, about = (3 * radius * radius + width * width) / 12, radius * radius / 2
    return Model(name, allow_auto_disable=asleep, links=[link_of(
        Cylinder(radius, width), Inertial(1.0, ixx=across, iyy=across, izz=about),
        Surface(mu=1.0))])


def lying(yaw: float) -> "Tuple[float, float, float, float]":
    """With its axis along y, turned by `yaw` about z."""
    return multiply(quat_from_rpy(0, 0, yaw), quat_from_rpy(math.pi / 2, 0, 0))


def _floor(lab: Lab, kind: str) -> None:
    """A level floor; the mesh ones are triangles 0.5 m wide."""
    if kind == "plane":
        lab.load(ground(1.0))
    elif kind == "box":
        lab.load(slab("floor", (40.0, 40.0, 0.2)), (0, 0, -0.1))
    else:
        side = np.linspace(-20, 20, 81)
        x, y = np.meshgrid(side, side)
        points = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
        at = (np.arange(80)[:, None] * 81 + np.arange(80)).ravel()
        faces = np.concatenate([np.stack([at, at + 1, at + 81], 1),
                                np.stack([at + 1, at + 82, at + 81], 1)]).astype(np.int32)
        mesh = Mesh("terrain", "/terrain")
        lab.load(Model("floor", static=True, links=[Link("link", collisions=[
            Collision("c", mesh, surface=Surface(mu=1.0))])]),
            meshes={mesh_key(mesh): MeshData(points, faces)})


@pytest.mark.parametrize("floor", ["plane", "box", "mesh"])
@pytest.mark.parametrize("asleep", [True, False])
def test_a_lying_can_stays_where_it_is(lab: Lab, laws: Laws, floor: str, asleep: bool):
    _floor(lab, floor)
    cans = [lab.load(cylinder(radius, width, f"c{n}{yaw}", asleep), (3 * n - 6, yaw * 8, radius),
                     lying(yaw))
            for n, (radius, width) in enumerate(SIZES) if width > radius / 4   # discs fall over
            for yaw in (0.0, 0.5, 1.3)]
    lab.seconds(0.3)
    starts = [lab.pose(can).position for can in cans]
    lab.seconds(30)
    for can, start in zip(cans, starts):
        laws.at_most(f"a lying can on a {floor}: way in 30 s, m",
                     math.dist(lab.pose(can).position[:2], start[:2]),
                     0.2 if floor == "mesh" else 1e-3)   # on the seams of triangles


@pytest.mark.parametrize("speed", [0.05, 0.5, 3.0])
def test_a_cylinder_rolls_on_at_its_speed(lab: Lab, laws: Laws, speed: float):
    _floor(lab, "plane")
    rolling = [(lab.load(cylinder(radius, width, f"c{n}{yaw}"), (3 * n - 6, yaw * 400, radius),
                         lying(yaw)), radius, yaw)
               for n, (radius, width) in enumerate(SIZES) for yaw in (0.0, 0.5)]
    lab.seconds(0.3)
    for can, radius, yaw in rolling:
        ahead = (math.cos(yaw), math.sin(yaw))
        lab.push(can, (speed * ahead[0], speed * ahead[1], 0),
                 (-ahead[1] * speed / radius, ahead[0] * speed / radius, 0))
    lab.seconds(30)
    for can, _, _ in rolling:
        laws.near("cylinders rolling on a plane for 30 s: speed, m/s",
                  math.hypot(*lab.twist(can).linear[:2]), speed, rel=0.015)


def test_a_cylinder_rolls_down_a_slope(lab: Lab, laws: Laws):
    angle = math.radians(2.0)
    tilt = quat_from_rpy(0.0, angle, 0.0)
    slope = slab("slope", (60, 4, 0.2))
    slope.links[0].collisions[0].surface = Surface(mu=1.0)
    lab.load(slope, (0, 0, 0), tilt)
    up = (0.1 + 0.1) / math.cos(angle)
    can = lab.load(cylinder(0.1, 0.3), (0, 0, up), multiply(tilt, lying(0.0)))
    start = lab.pose(can).position
    lab.seconds(4)
    laws.near("a cylinder rolling down a slope of 2 degrees: way in 4 s, m",
              math.dist(lab.pose(can).position, start),
              (2 / 3) * 9.8 * math.sin(angle) * 16 / 2, rel=0.01)
