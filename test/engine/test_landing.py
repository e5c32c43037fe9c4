"""What lands flat stays upright, whatever its shape and what it lands on."""
from __future__ import annotations

import math
from pathlib import Path
from typing import Dict, List, Tuple

import numpy as np
import pybullet
import pytest
from conftest import Lab, ground, inertial_of_box, link_of, slab
from laws import Laws

import my_simulations
from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.shapes import (
    Box,
    Collision,
    Cylinder,
    Geometry,
    Mesh,
    MeshData,
    Sphere,
    Surface,
    mesh_key,
)
from my_simulations.engine.drive_commands import JointMotor, SetMotors
from my_simulations.geometry import Pose, Quat, dot, quat_from_rpy, rotate

G = 9.8
HEIGHTS = (0.01, 0.05, 0.3, 0.5, 1.0, 5.0)
CARTON = Path(__file__).resolve().parents[2] / "objects/MY_OBJECT.urdf"
HALF = 0.1       # m, of all these: 0.2 m high
RADIUS = 0.035   # m


def _prism(corners: int, thin: float = 1.0) -> Tuple[Geometry, Dict[str, MeshData]]:
    """A mesh whose base is regular, or pressed flat to the share `thin`."""
    base = [(RADIUS * math.cos(a), thin * RADIUS * math.sin(a))
            for a in (2 * math.pi * (n + 0.5) / corners for n in range(corners))]
    points = np.array([(x, y, z) for z in (-HALF, HALF) for x, y in base])
    triangles = []
    for n in range(corners):
        m = (n + 1) % corners
        triangles += [(n, m, corners + n), (m, corners + m, corners + n)]
    for n in range(1, corners - 1):
        triangles += [(0, n + 1, n), (corners, corners + n, corners + n + 1)]
    shape = Mesh(f"prism_{corners}_{thin}.obj")
    return shape, {mesh_key(shape): MeshData(points, np.array(triangles))}


SHAPES = {"can": (Cylinder(RADIUS, 2 * HALF), {}), "triangle": _prism(3), "square": _prism(4),
          "hexagon": _prism(6), "slab": _prism(4, 0.4), "round": _prism(24),
          "box": (Box((2 * RADIUS, 2 * RADIUS, 2 * HALF)), {})}
INERTIAL = Inertial(0.5, Pose(), .0015, 0, 0, .0015, 0, .0005)


def _drop(lab: Lab, name: str, bottom, turn: Quat = (0, 0, 0, 1), mu: float = 1.0) -> int:
    shape, meshes = SHAPES[name]
    model = Model(name, links=[link_of(shape, INERTIAL, Surface(mu=mu))])
    x, y, z = bottom
    return lab.load(model, (x, y, z + HALF), turn, meshes)


def _table(name: str) -> Model:
    collisions = [Collision("top", Box((0.5, 0.5, 0.04)), Pose((0, 0, 0.38)))]
    collisions += [Collision(f"leg{x}{y}", Box((0.04, 0.04, 0.36)), Pose((x, y, 0.18)))
                   for x in (-0.2, 0.2) for y in (-0.2, 0.2)]
    return Model(name, links=[Link("link", inertial=Inertial(
        15.0, Pose((0, 0, 0.3)), .7, 0, 0, .7, 0, .8), collisions=collisions)])


def _tilt(lab: Lab, number: int, link: str = "link") -> float:
    up = rotate(lab.pose(number, link).orientation, (0.0, 0.0, 1.0))
    return math.degrees(math.hypot(up[0], up[1])) if up[2] > 0 else 180.0


def _turned(lab: Lab, number: int) -> float:
    x, y, _ = rotate(lab.pose(number).orientation, (1.0, 0.0, 0.0))
    return math.degrees(math.atan2(y, x))


@pytest.mark.parametrize("floor", ["plane", "box", "table"])
@pytest.mark.parametrize("name", sorted(SHAPES))
def test_what_is_dropped_upright_lands_upright(lab: Lab, laws: Laws, name: str, floor: str):
    lab.load(ground())
    top = {"plane": 0.0, "box": 0.2, "table": 0.4}[floor]
    if floor == "box":
        lab.load(slab("floor", (20, 20, 0.2)), (0, 0, 0.1))
    if floor == "table":
        for n in range(len(HEIGHTS)):
            lab.load(_table(f"t{n}"), (n, 0, 0))
        lab.steps(200)
    dropped = []
    for n, height in enumerate(HEIGHTS):
        yaw = 0.3 + 0.7 * n
        number = _drop(lab, name, (n, 0, top + height), quat_from_rpy(0, 0, yaw))
        dropped.append((n, number, yaw, round(1000 * math.sqrt(2 * height / G)) + 2))
    for step in range(4, 1500, 5):
        lab.steps(5)
        for _, number, _, landed in dropped:
            laws.at_most("what is dropped upright from up to 5 m: tilt, degrees",
                         _tilt(lab, number), 0.1)
            laws.at_most("the same: depth while it lands, m",
                         top + HALF - lab.pose(number).position[2], 2e-3)
            if landed + 500 <= step < landed + 505:
                twist = lab.twist(number)
                speeds = map(abs, (*twist.linear, *(RADIUS * rate for rate in twist.angular)))
                laws.at_most("the same: speed 0.5 s after landing, m/s", max(speeds), 2e-3)
            if step > landed:
                laws.at_most("the same: bounce without restitution, m",
                             lab.pose(number).position[2] - top - HALF, 1e-4)
    for n, number, yaw, _ in dropped:
        x, y, _ = lab.pose(number).position
        laws.at_most("the same: way sideways, m", math.hypot(x - n, y), 2e-4)
        laws.at_most("the same: yaw, degrees", abs(math.remainder(
            _turned(lab, number) - math.degrees(yaw), 360.0)), 0.1)


def test_a_carton_of_convex_pieces_lands_upright(laws: Laws):
    with my_simulations.open_world() as world:
        for n, height in enumerate(HEIGHTS):
            world.spawn(CARTON.read_text(encoding="utf-8"), f"carton{n}", [n, 0, height, 0, 0, n])
        for _ in range(300):
            world.step(5)
            poses = world.states().pose
            for n in range(len(HEIGHTS)):
                _, _, _, x, y, _, _ = poses[f"carton{n}"]
                laws.at_most("a carton dropped from up to 5 m: tilt, degrees",
                             math.degrees(2 * math.hypot(x, y)), 0.1)


@pytest.mark.parametrize("height", [0.05, 0.5, 1.0])
def test_what_has_wheels_or_legs_lands_level(lab: Lab, laws: Laws, height: float):
    lab.load(ground())
    wheels = [Link(f"wheel{y}", Pose((0.08, y, 0.05), quat_from_rpy(math.pi / 2, 0, 0)),
                   inertial_of_box(0.3, 0.1, 0.1, 0.03),
                   [Collision("c", Cylinder(0.05, 0.03))]) for y in (-0.13, 0.13)]
    base = Link("link", Pose((0, 0, 0.08)), inertial_of_box(5.0, 0.3, 0.2, 0.06),
                [Collision("c", Box((0.3, 0.2, 0.06))),
                 Collision("caster", Sphere(0.025), Pose((-0.12, 0, -0.055)))])
    robot = lab.load(Model("robot", links=[base, *wheels], joints=[
        Joint(wheel.name, "continuous", "link", wheel.name, axis=JointAxis())
        for wheel in wheels]), (0, 0, height), quat_from_rpy(0, 0, 0.3))
    stool = Model("stool", links=[Link("link", inertial=inertial_of_box(
        8.0, 0.4, 0.4, 0.3, Pose((0, 0, 0.3))), collisions=[
            Collision("seat", Cylinder(0.2, 0.04), Pose((0, 0, 0.42))),
            *(Collision(f"leg{n}", Cylinder(0.02, 0.4), Pose((
                0.15 * math.cos(2 * n), 0.15 * math.sin(2 * n), 0.2))) for n in range(4))])])
    seat = lab.load(stool, (2, 0, height))
    for _ in range(250):
        lab.steps(4)
        for number in (robot, seat):
            laws.at_most("robots and stools dropped from up to 1 m: tilt, degrees",
                         _tilt(lab, number), 0.1)


def _falling_corner(lab: Lab, number: int, lever: float) -> Tuple[float, float]:
    """Rate of turning, rad/s, right after the first impact, and what the momentum about the
    corner, which an impact there does not change, says: m v x / (I + m r^2)."""
    for _ in range(1000):
        linear, at = lab.twist(number).linear, lab.pose(number)
        lab.steps(1)
        spin = lab.twist(number).angular
        if math.hypot(*spin) > 0.01:
            break
    down = [dot(rotate(at.orientation, (0, side * lever, -HALF)), (0, 0, 1)) for side in (-1, 1)]
    corner = rotate(at.orientation, (0, lever if down[1] < down[0] else -lever, -HALF))
    inertia = INERTIAL.ixx + INERTIAL.mass * dot(corner, corner)
    speed = -linear[2] + G * 0.001
    return math.hypot(*spin), INERTIAL.mass * speed * abs(corner[1]) / inertia


@pytest.mark.parametrize("name", ["can", "square", "box"])
@pytest.mark.parametrize("degrees", [5, 20])
def test_the_first_impact_of_a_corner_turns_as_momentum_says(lab: Lab, laws: Laws, name: str,
                                                             degrees: int):
    lab.load(ground())
    turn = quat_from_rpy(math.radians(degrees), 0, 0)
    number = _drop(lab, name, (0, 0, 0.2), turn, mu=50.0)
    lever = RADIUS * (math.sqrt(0.5) if name == "square" else 1.0)
    rate, expected = _falling_corner(lab, number, lever)
    laws.near("a tilted landing on a corner: rate after it, rad/s", rate, expected, abs=0.15)


@pytest.mark.parametrize("rate, bottom, partners", [(0.0, 0.1, 1), (20.0, 0.12, 0)])
def test_only_what_can_land_flat_is_measured_against_what_is_below(
        lab: Lab, monkeypatch: pytest.MonkeyPatch, rate: float, bottom: float, partners: int):
    lab.load(ground())
    can = _drop(lab, "can", (0, 0, bottom))
    lab.push(can, (0, 0, 0), (rate, 0, 0))
    measured: List[Tuple[int, int]] = []
    closest = pybullet.getClosestPoints

    def record(one: int, other: int, reach: float) -> object:
        measured.append((one, other))
        return closest(one, other, reach)
    monkeypatch.setattr(pybullet, "getClosestPoints", record)
    lab.steps(140)
    reach = math.hypot(HALF, RADIUS) if rate else HALF
    assert lab.pose(can).position[2] > reach   # it has touched nothing
    # Of a plane and the box below it, the can meets the plane.
    assert len(set(measured)) == partners


def test_what_rolls_is_not_measured_against_its_floor(lab: Lab, monkeypatch: pytest.MonkeyPatch):
    lab.load(ground())
    can = _drop(lab, "can", (0, 0, RADIUS - HALF), quat_from_rpy(math.pi / 2, 0, 0))
    lab.push(can, (0.1, 0, 0), (0, 0.1 / RADIUS, 0))
    lab.steps(200)
    measured: List[int] = []
    monkeypatch.setattr(pybullet, "getClosestPoints", lambda one, *_: measured.append(one))
    lab.steps(400)
    assert lab.pose(can).position[0] == pytest.approx(0.06, abs=0.001)
    assert measured == []


@pytest.mark.parametrize("degrees", [0.05, 0.2, 1.0])
def test_what_lands_almost_flat_does_as_a_box_does(lab: Lab, laws: Laws, degrees: float):
    lab.load(ground())
    numbers = [_drop(lab, name, (n, 0, 1.0), quat_from_rpy(math.radians(degrees), 0, 0.4))
               for n, name in enumerate(("box", "can", "square", "hexagon"))]
    lab.seconds(1.0)
    for number in numbers:
        laws.at_most("landing from 1 m, tilted by up to 1 degree: tilt 0.5 s later, degrees",
                     _tilt(lab, number), 1.0)


@pytest.mark.parametrize("name", ["can", "square"])
def test_a_landing_on_a_corner_gives_no_energy(lab: Lab, laws: Laws, name: str):
    lab.load(ground())
    dropped: List[int] = [_drop(lab, name, (n, 0, 0.3 + 0.1 * n),
                                quat_from_rpy(math.radians(4 * n), 0.02, 0.4)) for n in range(6)]

    def energy(number: int) -> float:
        pose, twist = lab.pose(number), lab.twist(number)
        inverse = (*(-value for value in pose.orientation[:3]), pose.orientation[3])
        own = rotate(inverse, twist.angular)
        moments = (INERTIAL.ixx, INERTIAL.iyy, INERTIAL.izz)
        return (INERTIAL.mass * (0.5 * dot(twist.linear, twist.linear) + G * pose.position[2])
                + 0.5 * sum(i * w * w for i, w in zip(moments, own)))

    least = {number: energy(number) for number in dropped}
    for _ in range(800):
        lab.steps(1)
        for number in dropped:
            now = energy(number)
            laws.at_most("tilted landings: energy gained, share of the drop's",
                         (now - least[number]) / (INERTIAL.mass * G * 0.3), 0.03)
            least[number] = min(least[number], now)


def test_a_can_bounces_as_high_as_its_restitution_says_and_stays_upright(lab: Lab, laws: Laws):
    surface = Surface(restitution=0.8, bounce_threshold=0.01)
    lab.load(ground(surface=surface))
    can = lab.load(Model("can", links=[link_of(Cylinder(RADIUS, 2 * HALF), INERTIAL, surface)]),
                   (0, 0, 0.5 + HALF))
    highest = 0.0
    for step in range(800):
        lab.steps(1)
        laws.at_most("a can that bounces: tilt, degrees", _tilt(lab, can), 0.5)
        if step > 330:
            highest = max(highest, lab.pose(can).position[2] - HALF)
    laws.near("a can that bounces: height, m", highest, 0.5 * 0.8 ** 2, rel=0.02)


def test_five_cans_on_each_other_stand(lab: Lab, laws: Laws):
    lab.load(ground())
    cans = [_drop(lab, "can", (0, 0, 2 * HALF * n)) for n in range(5)]
    lab.seconds(10)
    for can in cans:
        x, y, _ = lab.pose(can).position
        laws.at_most("five cans on each other, 10 s: off their place, m", math.hypot(x, y), 1e-3)


def test_a_can_stands_on_a_disc_that_turns(lab: Lab, laws: Laws):
    lab.load(ground())
    disc = lab.load(Model("disc", links=[Link(
        "link", Pose((0, 0, 0.1)), inertial_of_box(5.0, 0.6, 0.6, 0.04),
        [Collision("c", Cylinder(0.3, 0.04))])], joints=[
            Joint("hinge", "revolute", "world", "link", axis=JointAxis())]))
    can = _drop(lab, "can", (0.15, 0, 0.12 + 0.05))
    lab.apply(SetMotors((JointMotor(lab.joint_rows[disc, "hinge"], 0.5, 5.0),)))
    for _ in range(300):
        lab.steps(10)
        laws.at_most("a can dropped on a disc that turns: tilt, degrees", _tilt(lab, can), 0.2)
    x, y, _ = lab.pose(can).position
    laws.near("the same: distance from the axis after 3 s, m", math.hypot(x, y), 0.15, abs=5e-4)
    laws.near("the same: rate, rad/s", lab.twist(can).angular[2], 0.5, abs=0.01)


@pytest.mark.parametrize("above", [-1e-4, 0.0])
def test_a_can_that_touches_the_floor_stays_there_without_gravity(lab: Lab, above: float):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    lab.load(ground())
    can = _drop(lab, "can", (0, 0, above))
    lab.seconds(1.0)
    assert abs(lab.pose(can).position[2] - HALF) < 2e-4
    lab.push(can, (0, 0, 0.5))
    lab.seconds(1.0)
    assert abs(lab.pose(can).position[2] - HALF - 0.5) < 1e-3


def test_landings_repeat_bit_for_bit_however_many_steps_are_made_in_one_go(lab: Lab):
    def fallen(burst: int) -> List[List[float]]:
        numbers = [_drop(lab, name, (0.05 * (n % 3), 0.06 * (n // 3), 0.05 + 0.25 * n),
                         quat_from_rpy(0.01 * n, 0, n)) for n, name in enumerate(sorted(SHAPES))]
        first = lab.step
        lab.step += -first % 64
        start = lab.step
        while lab.step < start + 1024:
            lab.steps(burst)
        rows = [lab.row(number) for number in numbers]
        for number in numbers:
            lab.remove(number)
        return rows

    lab.load(ground())
    fallen(1)  # numbers of bodies are given again from here on
    once = fallen(1)
    assert fallen(1) == once and fallen(64) == once


@pytest.mark.parametrize("step_size", [0.002, 0.005, 0.01])
@pytest.mark.parametrize("name", ["box", "can"])
def test_what_falls_fast_goes_hardly_deeper_with_larger_steps(lab: Lab, laws: Laws, name: str,
                                                              step_size: float):
    """Without help it would by what it moves in a step: 10 cm at 10 m/s and 10 ms."""
    lab.configure(step_size=step_size)
    lab.load(ground())
    dropped = [_drop(lab, name, (n, 0, height)) for n, height in enumerate(HEIGHTS)]
    for _ in range(round(1.2 / step_size)):
        lab.steps(1)
        for number in dropped:
            laws.at_most(f"dropped from up to 5 m with steps of {1e3 * step_size:g} ms: depth, m",
                         HALF - lab.pose(number).position[2], 6e-3)


def test_what_falls_on_what_fell_beside_it_lands_upright(lab: Lab, laws: Laws):
    lab.load(ground())
    cans = [_drop(lab, "can", (0, 0, 1.0 + 0.25 * n)) for n in range(2)]
    lab.seconds(1.5)
    for number in cans:
        laws.at_most("cans that fall above each other: tilt, degrees", _tilt(lab, number), 1.0)


@pytest.mark.parametrize("removed", [True, False])
@pytest.mark.parametrize("above", [0.01, 0.02, 0.03])
def test_a_can_lands_upright_though_what_is_below_changes_while_it_falls(
        lab: Lab, laws: Laws, above: float, removed: bool):
    """A table is removed, or put there, between two searches for what the can may reach."""
    lab.load(ground())
    table, at = slab("table", (0.3, 0.3, 0.1)), (0.0, 0.0, 0.05)
    can = _drop(lab, "can", (0, 0, 0.5))
    number = lab.load(table, at) if removed else 0
    while lab.pose(can).position[2] > 0.1 + HALF + above:
        lab.steps(1)
    if removed:
        lab.remove(number)
    else:
        lab.load(table, at)
    lab.seconds(0.5)
    height = lab.pose(can).position[2] - HALF
    laws.at_most("what is below a falling can changes: height, m",
                 abs(height - (0.0 if removed else 0.1)), 1e-3)
    laws.at_most("the same: tilt, degrees", _tilt(lab, can), 0.1)
