"""Static meshes: bodies that slide over, rest on and hit their flat faces; curved faces."""
from __future__ import annotations

import math
from typing import Callable, List, Sequence, Tuple

import numpy as np
import pytest
from conftest import Lab, ball, box, inertial_of_box, link_of
from laws import Laws
from test_sliding import terrain

from my_simulations.description.model import Inertial, Link, Model
from my_simulations.description.shapes import (
    Collision,
    Cylinder,
    Ellipsoid,
    Geometry,
    Mesh,
    MeshData,
    Surface,
    mesh_key,
)
from my_simulations.engine.commands import SetModelState
from my_simulations.geometry import STILL, Pose, quat_from_rpy

Cell = Tuple[int, int]
SMOOTH = Surface(mu=0.0)


def floor(count: int = 20, without: Sequence[Cell] = (),
          height: Callable[[float, float], float] = lambda x, y: 0.0) -> MeshData:
    """Squares of 1 m about the origin, two triangles each, seen from above."""
    start = -count / 2
    points = [(start + x, start + y, height(start + x, start + y))
              for x in range(count + 1) for y in range(count + 1)]
    faces: List[Tuple[int, int, int]] = []
    for x in range(count):
        for y in range(count):
            if (x, y) not in without:
                a, b = x * (count + 1) + y, (x + 1) * (count + 1) + y
                faces += [(a, b, a + 1), (a + 1, b, b + 1)]
    return MeshData(np.array(points, float), np.array(faces, np.int32))


def crate(inside_out: bool = False, size: float = 1.0) -> MeshData:
    """The six walls of a closed cube about the origin."""
    corners = size * np.array([(x, y, z) for x in (-.5, .5) for y in (-.5, .5) for z in (-.5, .5)])
    faces = np.array([(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7),
                      (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)], np.int32)
    return MeshData(corners, faces[:, ::-1] if inside_out else faces)


def static(lab: Lab, data: MeshData, name: str = "floor",
           position: Tuple[float, float, float] = (0.0, 0.0, 0.0),
           orientation: Tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)) -> int:
    mesh = Mesh(name, f"/{name}")
    return lab.load(Model(name, static=True, links=[Link("link", collisions=[
        Collision("c", mesh, surface=Surface(mu=1.0))])]), position, orientation,
        meshes={mesh_key(mesh): data})


def moving(geometry: Geometry, surface: Surface = SMOOTH) -> Model:
    return Model("thing", allow_auto_disable=False, links=[
        link_of(geometry, inertial_of_box(1.0, 0.2, 0.2, 0.1), surface)])


@pytest.mark.parametrize("speed", [0.3137, 0.7071, 1.618])
def test_what_slides_over_a_level_mesh_keeps_its_speed(lab: Lab, laws: Laws, speed: float):
    static(lab, floor())
    things = [(lab.load(model, (-7.5, y, height)), height) for y, (model, height) in enumerate([
        (box(size=0.2, surface=SMOOTH), 0.1), (moving(Cylinder(0.1, 0.1)), 0.05),
        (moving(Ellipsoid((0.1, 0.1, 0.05))), 0.05)])]
    lab.steps(50)
    for thing, _ in things:
        lab.push(thing, (speed, 0.0, 0.0))
    highest = 0.0
    for _ in range(300):
        lab.steps(10)
        highest = max(highest, *(lab.pose(thing).position[2] - height for thing, height in things))
    for thing, _ in things:
        laws.near("sliding over the triangles of a level mesh for 3 s: speed, m/s",
                  lab.twist(thing).linear[0], speed, rel=1e-3)
    laws.at_most("the same: how far it leaps, m", highest, 1e-5)


def test_a_box_slides_over_the_seams_of_the_rectangles_of_a_floor_and_a_ball_falls_through_its_hole(
        lab: Lab, laws: Laws):
    static(lab, floor(20, [(10, 0), (10, 19)]))
    sliding = lab.load(box(size=0.2, surface=SMOOTH), (-0.5, 0.3, 0.1))
    falling = lab.load(ball("ball", radius=0.1), (0.5, 9.5, 0.5))
    lab.steps(50)
    lab.push(sliding, (0.7, 0.0, 0.0))
    lab.seconds(4)
    laws.near("a box over the seams of the rectangles of a mesh: speed, m/s",
              lab.twist(sliding).linear[0], 0.7, rel=1e-3)
    assert lab.pose(sliding).position[0] > 2.0 and lab.pose(falling).position[2] < -1.0


@pytest.mark.parametrize("angle", [0.0, 0.3])
def test_things_rest_on_a_flat_mesh_at_its_height(lab: Lab, laws: Laws, angle: float):
    """On a level floor, and on the same turned by 0.3 rad about the vertical."""
    static(lab, floor(), orientation=quat_from_rpy(0.0, 0.0, angle))
    for n, (model, height) in enumerate([
            (box(size=0.2), 0.1), (ball(radius=0.1), 0.1), (moving(Cylinder(0.1, 0.1)), 0.05)]):
        thing = lab.load(model, (n, 0.0, height + 0.001))
        lab.seconds(2)
        laws.near("at rest on a flat static mesh: height, m", lab.pose(thing).position[2], height,
                  abs=1e-4)


@pytest.mark.parametrize("step_size", [0.001, 0.01])
def test_a_can_is_put_down_while_a_wheel_rolls_on_triangles(lab: Lab, laws: Laws, step_size: float):
    """Its contact points were kept as close as those of the wheel: it sank into the floor."""
    lab.configure(step_size=step_size)
    static(lab, floor(), orientation=quat_from_rpy(0.0, 0.0, 0.3))
    terrain(lab)
    lab.seconds(1)
    can = lab.load(moving(Cylinder(0.1, 0.1)), (2.0, 0.0, 0.051))
    lab.seconds(1.0)
    laws.near("a can put down while a wheel rolls on triangles: height, m",
              lab.pose(can).position[2], 0.05, abs=6e-4)


def test_a_floor_of_which_some_triangles_look_down_has_no_steps(lab: Lab, laws: Laws):
    mixed = floor()
    down = (mixed.vertices[mixed.triangles][:, :, 0].mean(axis=1) // 2).astype(int) % 2 == 0
    mixed.triangles[down] = mixed.triangles[down][:, ::-1]
    static(lab, mixed)
    sliding = lab.load(box(size=0.2, surface=SMOOTH), (-7.5, 0.0, 0.101))
    lab.seconds(1)
    lab.push(sliding, (1.5, 0.0, 0.0))
    for _ in range(300):
        lab.steps(10)
        laws.near("sliding over a mesh with triangles the wrong way round: height, m",
                  lab.pose(sliding).position[2], 0.101, abs=3e-4)
    laws.near("the same: speed, m/s", lab.twist(sliding).linear[0], 1.5, rel=1e-3)


@pytest.mark.parametrize("inside_out", [False, True])
def test_a_closed_crate_of_triangles_stays_hollow(lab: Lab, inside_out: bool):
    """Its walls hold from both sides, whichever side their triangles tell."""
    static(lab, crate(inside_out))
    inside = lab.load(ball("inside", radius=0.1), (0.1, 0.05, 0.0))
    above = lab.load(box("above", size=0.2), (0.0, 0.0, 0.65))
    lab.push(inside, (3.0, 2.0, 3.0))
    for _ in range(200):
        lab.steps(10)
        assert max(map(abs, lab.pose(inside).position)) < 0.41
    assert lab.pose(inside).position[2] == pytest.approx(-0.4, abs=3e-3)
    assert lab.pose(above).position[2] == pytest.approx(0.6, abs=3e-3)


def test_a_box_is_stopped_by_a_sheet_from_behind(lab: Lab):
    """A wall that is one sheet, its triangles seen from the left."""
    lab.configure(gravity=(0.0, 0.0, 0.0))
    static(lab, floor(2), orientation=quat_from_rpy(0.0, -math.pi / 2, 0.0))
    for n, side in enumerate((-1.0, 1.0)):
        thing = lab.load(box(f"b{n}", size=0.2), (side, 0.5 * n, 0.3))
        lab.push(thing, (-2.0 * side, 0.0, 0.0))
        lab.seconds(1)
        assert side * lab.pose(thing).position[0] == pytest.approx(0.1, abs=4e-3)


def test_the_faces_of_a_mesh_move_and_go_with_it(lab: Lab):
    table = static(lab, crate(), "table", (0.0, 0.0, 0.5))
    below = static(lab, floor(), "floor")
    lab.apply(SetModelState(table, Pose((3.0, 0.0, 0.5), quat_from_rpy(0.0, 0.0, 0.5)), STILL))
    on = lab.load(box("on", size=0.2), (3.0, 0.0, 1.15))
    beside = lab.load(box("beside", size=0.2), (0.0, 0.0, 1.15))
    lab.seconds(2)
    assert lab.pose(on).position[2] == pytest.approx(1.1, abs=1e-3)
    assert lab.pose(beside).position[2] == pytest.approx(0.1, abs=1e-3)
    lab.remove(table)
    lab.seconds(2)
    assert lab.pose(on).position[2] == pytest.approx(0.1, abs=1e-3)
    lab.remove(below)
    lab.seconds(1)
    assert max(lab.pose(on).position[2], lab.pose(beside).position[2]) < -1.0


def test_a_ball_rolls_over_a_mesh_that_is_not_flat(lab: Lab):
    static(lab, floor(height=lambda x, y: 0.02 * math.sin(x) * math.cos(y)))
    moment = 0.4 * 0.2 * 0.2
    rolling = lab.load(Model("ball", links=[link_of(
        ball(radius=0.2).links[0].collisions[0].geometry,
        Inertial(1.0, ixx=moment, iyy=moment, izz=moment), Surface(mu=1.0))]), (-5.0, 0.0, 0.23))
    lab.steps(200)
    lab.push(rolling, (1.5, 0.0, 0.0), (0.0, 7.5, 0.0))
    lab.seconds(4)
    x, y, z = lab.pose(rolling).position
    assert x > 0.0 and abs(y) < 1.0 and z == pytest.approx(0.2, abs=0.03)
