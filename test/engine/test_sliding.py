"""Boxes that slide and land: on planes, on boxes, in eight directions."""
from __future__ import annotations

import math

import numpy as np
import pytest
from conftest import Lab, box, ground, inertial_of_box, link_of, slab
from laws import Laws
from pushing import PushedBox, ways

from my_simulations.description.model import Inertial, Link, Model
from my_simulations.description.shapes import (
    Box,
    Collision,
    Cylinder,
    Heightmap,
    MeshData,
    Surface,
    mesh_key,
)
from my_simulations.engine.timed_forces import AddTimedForces, TimedWrench
from my_simulations.geometry import Pose, quat_from_rpy

G = 9.8
CUBE, FLAT = (1.0, 1.0, 1.0), (1.0, 1.0, 0.1)


def _floor(lab: Lab, kind: str) -> None:
    if kind == "plane":
        lab.load(ground(1.0))
    else:
        lab.load(slab("floor", (600.0, 600.0, 2.0)), (0, 0, -1.0))


def _tilt(lab: Lab, model: int) -> float:
    x, y = lab.pose(model).orientation[:2]
    return math.degrees(2 * math.asin(math.hypot(x, y)))


@pytest.mark.parametrize("floor", ["plane", "box"])
@pytest.mark.parametrize("size", [CUBE, FLAT], ids=["cube", "flat"])
def test_a_box_slides_as_far_in_every_direction(lab: Lab, laws: Laws, size, floor: str):
    _floor(lab, floor)
    sliding = []
    for n, mu in enumerate((0.2, 0.4, 0.6, 0.8, 1.0)):
        for eighth in range(8):
            model = Model(f"b{n}{eighth}", links=[link_of(
                Box(size), inertial_of_box(1.0, *size), Surface(mu=mu))])
            number = lab.load(model, (30 * n - 60, 30 * eighth - 100, size[2] / 2))
            sliding.append((number, mu, math.pi / 4 * eighth))
    lab.steps(200)
    starts = [lab.pose(number).position for number, _, _ in sliding]
    # From 2 m/s. Each step moves a body at its velocity at the end: half a step less of the way.
    for number, _, angle in sliding:
        lab.push(number, (2 * math.cos(angle), 2 * math.sin(angle), 0))
    lab.seconds(1.5)
    for (number, mu, _), start in zip(sliding, starts):
        laws.near("boxes sliding in eight directions, mu 0.2 to 1: way to a stop, m",
                  math.dist(lab.pose(number).position, start),
                  4 / (2 * mu * G) - lab.settings.step_size, rel=0.02)


@pytest.mark.parametrize("push", [0.95, 1.1, 1.3, 2.0])
@pytest.mark.parametrize("size", [0.02, 0.2, 0.5, 1.0])
def test_a_cube_slides_as_coulomb_says_however_it_is_pushed(laws: Laws, size: float, push: float):
    boxes = [PushedBox(size, size, mu, push, math.pi / 4 * n)
             for n, mu in enumerate((0.1, 0.5, 0.69, 0.75, 0.8))]
    for pushed, way in zip(boxes, ways(boxes)):
        if push < 1.0:
            laws.at_most("cubes that less than mu N pushes: way in 1 s, m", way, 1e-4)
        else:
            laws.near("cubes that 1.1 to 2 mu N push: way in 1 s, m", way, pushed.way(), rel=0.02)


@pytest.mark.parametrize("height", [0.5, 2.0, 4.5, 4.996, 5.0])
def test_a_box_that_lands_flat_does_not_tilt(lab: Lab, laws: Laws, height: float):
    lab.load(ground())
    boxes = [(lab.load(box(), (0, 0, height + 0.5)), 0.5),
             (lab.load(Model("brick", links=[link_of(
                 Box((0.03, 0.05, 0.1)), inertial_of_box(0.2, 0.03, 0.05, 0.1))]),
                 (5, 0, height + 0.05)), 0.05)]
    landed = round(1000 * math.sqrt(2 * height / G))
    for _ in range(landed + 300):
        lab.steps(1)
        for number, rest in boxes:
            laws.at_most("a drop from up to 5 m: tilt, degrees", _tilt(lab, number), 0.05)
            laws.at_most("a drop from up to 5 m: depth, m", rest - lab.pose(number).position[2],
                         2e-3)
    for number, rest in boxes:
        laws.near("a drop from up to 5 m: height 0.3 s after landing, m",
                  lab.pose(number).position[2], rest, abs=2e-3)


def test_a_box_far_from_the_origin_meets_the_plane(lab: Lab):
    lab.load(ground())
    far = lab.load(box(), (300000.0, -200000.0, 0.5))
    lab.seconds(1)
    assert lab.pose(far).position[2] == pytest.approx(0.5, abs=1e-3)


def test_boxes_and_other_shapes_meet_a_tilted_plane_on_one_side_only(lab: Lab):
    from conftest import ball

    from my_simulations.description.shapes import Plane
    lab.configure(gravity=(-9.8, 0.0, 0.0))
    wall = Model("wall", static=True, links=[Link("link", collisions=[
        Collision("c", Plane((1.0, 0.0, 0.0)), Pose((-2.0, 0.0, 0.0)))])])
    lab.load(wall)
    cube, round_one = lab.load(box(), (0, 0, 0)), lab.load(ball(), (0, 5, 0))
    lab.seconds(2)
    for model in (cube, round_one):
        assert lab.pose(model).position[0] == pytest.approx(-1.5, abs=1e-3)


def test_what_is_spawned_after_a_model_of_two_bodies_left_collides(lab: Lab):
    # Bullet reuses the numbers of removed bodies and keeps their disabled collision pairs.
    lab.configure(gravity=(0.0, 0.0, 0.0))
    inertial = inertial_of_box(1, 1, 1, 1)
    pair = lab.load(Model("pair", links=[
        Link(name, Pose((x, 0, 0)), inertial, [Collision("c", Box(CUBE))])
        for name, x in (("a", 0.0), ("b", 0.6))]))
    lab.remove(pair)
    left, right = lab.load(box("left"), (0, 0, 0)), lab.load(box("right"), (2, 0, 0))
    lab.push(right, (-1, 0, 0))
    lab.seconds(2)
    assert lab.pose(left).position[0] < -0.1


def _upright(radius: float, height: float, mu: float) -> Model:
    across = (3 * radius * radius + height * height) / 12
    return Model("can", links=[link_of(
        Cylinder(radius, height), Inertial(1.0, ixx=across, iyy=across, izz=radius * radius / 2),
        Surface(mu=mu))])


CANS = [(0.1, 0.1), (0.03, 0.12)]   # radius, height


@pytest.mark.parametrize("speed", [0.3, 1.0, 2.7])
@pytest.mark.parametrize("mu", [0.0, 0.3])
def test_an_upright_cylinder_slides_on_a_floor_not_in_it(lab: Lab, laws: Laws, speed: float,
                                                         mu: float):
    _floor(lab, "plane")
    cans = [(lab.load(_upright(radius, height, mu), (0, n, height / 2)), height / 2)
            for n, (radius, height) in enumerate(CANS)]
    lab.seconds(1)
    for can, _ in cans:
        lab.push(can, (speed, 0, 0))
    for _ in range(100):
        lab.steps(10)
        for can, half in cans:
            laws.at_most("upright cylinders that slide at 0.3 to 2.7 m/s: depth, m",
                         half - lab.pose(can).position[2], 3e-4)
    for can, _ in cans:
        way = speed if mu == 0.0 else speed ** 2 / (2 * mu * G)
        laws.near("upright cylinders that slide at 0.3 to 2.7 m/s: way in 1 s, m",
                  lab.pose(can).position[0], way, rel=0.02)


@pytest.mark.parametrize("speed", [0.3, 2.0])
def test_upright_cylinders_slide_and_wheels_roll_on_triangles_in_one_world(lab: Lab, laws: Laws,
                                                                           speed: float):
    """Both need other contact points than usual, which Bullet finds by one world-wide rule."""
    _floor(lab, "plane")
    wheel = terrain(lab)
    for tile in range(8):
        lab.load(slab(f"tile{tile}", (1.0, 4.0, 0.2)), (tile - 0.5, -9.5, -0.08))
    cans = [(lab.load(_upright(radius, height, 0.0), (0, n + y, height / 2 + base)),
             height / 2 + base, deepest) for n, (radius, height) in enumerate(CANS)
            for y, base, deepest in ((0, 0.0, 3e-4), (-10, 0.02, 1e-3))]
    lab.seconds(0.5)
    lab.push(wheel, (0.5, 0, 0), (0, 5.0, 0))
    lab.seconds(0.5)
    for can, *_ in cans:
        lab.push(can, (speed, 0, 0))
    start = lab.pose(wheel).position[0]
    for _ in range(150):
        lab.steps(10)
        for can, half, deepest in cans:
            laws.at_most("upright cylinders beside a wheel on triangles: depth, m",
                         half - lab.pose(can).position[2], deepest)
    for can, *_ in cans:
        laws.near("upright cylinders beside a wheel on triangles: speed, m/s",
                  lab.twist(can).linear[0], speed, rel=0.02)
    laws.near("a wheel on triangles beside upright cylinders that slide: speed, m/s",
              (lab.pose(wheel).position[0] - start) / 1.5, 0.5, rel=0.005)


def terrain(lab: Lab) -> int:
    """A wheel that rolls at 0.5 m/s on a height map 20 m aside, 0.5 m high."""
    x, y = np.meshgrid(np.arange(14.0), np.arange(3.0))
    points = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    at = (np.arange(2)[:, None] * 14 + np.arange(13)).ravel()
    faces = np.concatenate([np.stack([at, at + 1, at + 14], 1),
                            np.stack([at + 1, at + 15, at + 14], 1)]).astype(np.int32)
    terrain = Heightmap("terrain", "/terrain")
    lab.load(Model("terrain", static=True, links=[Link("link", collisions=[
        Collision("c", terrain, surface=Surface(mu=1.0))])]), (0, 20, 0.5),
        meshes={mesh_key(terrain): MeshData(points, faces)})
    across = (3 * 0.1 ** 2 + 0.3 ** 2) / 12
    wheel = lab.load(Model("wheel", allow_auto_disable=False, links=[link_of(
        Cylinder(0.1, 0.3), Inertial(1.0, ixx=across, iyy=across, izz=0.005), Surface(mu=1.0))]),
        (0.3, 20.9, 0.6), quat_from_rpy(math.pi / 2, 0, 0))
    lab.seconds(0.1)
    lab.push(wheel, (0.5, 0, 0), (0, 5.0, 0))
    return wheel


@pytest.mark.parametrize("step_size", [0.001, 0.002])
def test_cans_that_slide_in_a_wind_stay_on_the_floor(lab: Lab, laws: Laws, step_size: float):
    """Each force that was renewed dropped their contact points: they sank by 3 mm at 1 ms."""
    lab.configure(step_size=step_size)
    _floor(lab, "plane")
    cans = [(lab.load(_upright(radius, height, 0.0), (0, n, height / 2)), height / 2)
            for n, (radius, height) in enumerate(CANS)]
    begin = round(1.0 / step_size)
    for step in range(2 * begin):
        if step == begin:
            for can, _ in cans:
                lab.push(can, (1.0, 0, 0))
        gust = 1e-3 * math.cos(20 * math.pi * step * step_size)
        lab.apply(AddTimedForces(tuple(
            TimedWrench(2 * step + n + 1, lab.rows[can, "link"], step, step + 1,
                        (0.6 * gust, 0.8 * gust, 0.0)) for n, (can, _) in enumerate(cans))))
        lab.steps(1)
        for can, half in cans:
            laws.at_most("cans that slide in a wind, steps of 1 and 2 ms: depth, m",
                         half - lab.pose(can).position[2], 1e-3)


@pytest.mark.parametrize("speed", [0.3137, 0.7071, 1.618, 2.718])
@pytest.mark.parametrize("start", [-1.5, -1.4563])
def test_an_upright_cylinder_slides_over_the_seams_of_level_boxes(lab: Lab, laws: Laws,
                                                                  speed: float, start: float):
    for x in range(-2, 8):
        lab.load(slab(f"tile{x}", (1.0, 10.0, 0.2)), (x + 0.5, 0, -0.1))
    cans = [(lab.load(_upright(radius, height, 0.0), (start, n, height / 2)), height / 2)
            for n, (radius, height) in enumerate(CANS)]
    lab.seconds(0.1)
    for can, _ in cans:
        lab.push(can, (speed, 0, 0))
    for _ in range(240):
        lab.steps(10)
        for can, half in cans:
            laws.at_most("upright cylinders that slide over level boxes: lifted by, m",
                         lab.pose(can).position[2] - half, 1e-3)
    for can, _ in cans:
        laws.near("upright cylinders that slide over level boxes: speed, m/s",
                  lab.twist(can).linear[0], speed, rel=0.02)


def test_an_upright_cylinder_stops_at_a_step(lab: Lab):
    for n, height in enumerate((0.2, 0.21)):
        lab.load(slab(f"tile{n}", (1.0, 10.0, height)), (n - 0.5, 0, height / 2 - 0.2))
    can = lab.load(_upright(0.1, 0.1, 0.0), (-0.5, 0, 0.05))
    lab.push(can, (0.3, 0, 0))
    lab.seconds(2.4)
    assert lab.pose(can).position[0] < -0.095 and lab.twist(can).linear[0] < 0.05
