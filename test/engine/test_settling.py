"""Resting bodies stay at rest: initial overlaps, parked robots, bodies on slopes and shelves."""
from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Dict, List, Tuple

import numpy as np
import pytest
from conftest import Lab, box, ground, inertial_of_box, slab
from laws import Laws

import my_simulations
from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.shapes import (
    Box,
    Collision,
    Cylinder,
    Mesh,
    MeshData,
    MeshTable,
    Sphere,
    Surface,
    mesh_key,
)
from my_simulations.geometry import Pose, Quat, multiply, quat_from_rpy, rotate

ROBOT = Path(__file__).resolve().parents[2] / "urdf/robo.urdf"


def _turned(a: Quat, b: Quat) -> float:
    """The angle between two attitudes, degrees."""
    dot = abs(sum(x * y for x, y in zip(a, b)))
    return math.degrees(2.0 * math.acos(min(1.0, dot)))


def _robot(brake: float = 0.0) -> Model:
    """Two wheels and a slippery caster; `brake` N m of friction on the wheels' axles."""
    wheel = Inertial(0.25, Pose(), 1.75e-4, 0, 0, 3.125e-4, 0, 1.75e-4)
    lying = Pose((0, 0, 0), quat_from_rpy(math.pi / 2, 0, 0))
    links = [Link("body", Pose((0, 0, 0.05)),
                  inertial_of_box(3.0, 0.3, 0.2, 0.08, Pose((0, 0, 0.03))),
                  [Collision("c", Box((0.3, 0.2, 0.08)), Pose((0, 0, 0.03))),
                   Collision("ball", Sphere(0.025), Pose((-0.11, 0, -0.025)))])]
    links.append(Link("caster", Pose((-0.11, 0, 0.025)),
                      Inertial(0.1, Pose(), 2.5e-5, 0, 0, 2.5e-5, 0, 2.5e-5),
                      [Collision("c", Sphere(0.025), surface=Surface(mu=0.0))]))
    links[0].collisions.pop()
    joints = [Joint("mount", "fixed", "body", "caster")]
    for name, y in (("left", 0.12), ("right", -0.12)):
        links.append(Link(name, Pose((0.08, y, 0.05)), wheel,
                          [Collision("c", Cylinder(0.05, 0.03), lying)]))
        joints.append(Joint(f"{name}_joint", "revolute", "body", name,
                            axis=JointAxis((0, 1, 0), friction=brake, damping=0.01)))
    return Model("robot", links=links, joints=joints)


def _slope(lab: Lab, degrees: float, y: float = 0.0) -> Quat:
    """A ramp that falls along x; its top goes through the origin's axis at 0.1 m."""
    tilt = quat_from_rpy(0.0, math.radians(degrees), 0.0)
    lab.load(slab(f"slope{y}", (6, 3, 0.2)), (0, y, 0), tilt)
    return tilt


def _on(tilt: Quat, y: float, height: float) -> "tuple[float, float, float]":
    x, _, z = rotate(tilt, (0.0, 0.0, 0.1 + height))
    return (x, y, z)


def _stay(lab: Lab, laws: Laws, law: str, bodies: List[Tuple[int, str]], seconds: float,
          bar: float = 0.1) -> None:
    """After a second nothing goes further than `bar` mm, or turns further than `bar` degrees."""
    lab.seconds(1)
    starts = [lab.pose(*body) for body in bodies]
    lab.seconds(seconds)
    for body, start in zip(bodies, starts):
        now = lab.pose(*body)
        laws.at_most(f"{law}: way, mm", 1e3 * math.dist(now.position, start.position), bar)
        laws.at_most(f"{law}: turn, degrees", _turned(now.orientation, start.orientation), bar)


# Seconds, and what they allow of 0.1 mm and 0.1 degrees in ten minutes.
PARKED = [(20, 0.1 / 30), pytest.param(600, 0.1, marks=pytest.mark.long)]


@pytest.mark.parametrize("seconds, bar", PARKED)
@pytest.mark.parametrize("brake", [0.0, 5.0])
@pytest.mark.parametrize("floor", ["plane", "box"])
def test_a_parked_robot_stays_where_it_is(lab: Lab, laws: Laws, floor: str, brake: float,
                                          seconds: float, bar: float):
    lab.load(ground(1.0) if floor == "plane" else slab("floor", (20, 20, 1)),
             (0, 0, 0) if floor == "plane" else (0, 0, -0.5))
    robot = lab.load(_robot(brake), (0, 0, 0), quat_from_rpy(0, 0, 0.4))
    _stay(lab, laws, f"a parked robot on a {floor}, {seconds} s", [(robot, "body")], seconds, bar)


@pytest.mark.parametrize("seconds, bar", [(6, 0.01), PARKED[1]])
@pytest.mark.parametrize("degrees", [10, 20])
def test_a_robot_with_braked_wheels_stays_on_a_slope(lab: Lab, laws: Laws, degrees: float,
                                                     seconds: float, bar: float):
    tilt = _slope(lab, degrees)
    robots = [lab.load(replace(_robot(5.0), name=f"r{n}"), _on(tilt, n - 1.0, 0.0),
                       multiply(tilt, quat_from_rpy(0, 0, turn)))
              for n, turn in enumerate((0.0, 0.7))]
    _stay(lab, laws, f"a robot with braked wheels on a slope, {seconds} s",
          [(robot, "body") for robot in robots], seconds, bar)


@pytest.mark.parametrize("seconds, bar", PARKED)
def test_the_lab_robot_stays_where_it_is(laws: Laws, seconds: float, bar: float):
    with my_simulations.open_world() as world:
        world.spawn(ROBOT.read_text(encoding="utf-8"), "robot", [0, 0, 0, 0, 0, 0.4])
        world.step(1000)
        start = world.states().pose["robot"]
        world.step(round(1000 * seconds))
        now = world.states().pose["robot"]
        law = f"the lab robot, parked, {seconds} s"
        laws.at_most(f"{law}: way, mm", 1e3 * math.dist(now[:3], start[:3]), bar)
        laws.at_most(f"{law}: turn, degrees", _turned(now[3:], start[3:]), bar)


def _arm(base: str) -> Model:
    """Three links, stretched out, on a base of 30 kg; 200 N m of friction in each hinge."""
    links = [Link("body", Pose((0, 0, 0.1)), inertial_of_box(30.0, 0.4, 0.4, 0.2),
                  [Collision("c", Box((0.4, 0.4, 0.2)))])]
    joints = [Joint("foot", "fixed", "world", "body")] if base == "fixed" else []
    for n in range(3):
        links.append(Link(f"l{n}", Pose((0.3 * n, 0, 0.25)),
                          inertial_of_box(2.0, 0.3, 0.05, 0.05, Pose((0.15, 0, 0))),
                          [Collision("c", Box((0.28, 0.05, 0.05)), Pose((0.15, 0, 0)))]))
        joints.append(Joint(f"j{n}", "revolute", links[-2].name, f"l{n}",
                            axis=JointAxis((0, 1, 0), friction=200.0)))
    return Model("arm", links=links, joints=joints)


@pytest.mark.parametrize("seconds, bar", PARKED)
@pytest.mark.parametrize("base", ["fixed", "standing"])
def test_an_arm_with_brakes_stays_where_it_is(lab: Lab, laws: Laws, base: str, seconds: float,
                                              bar: float):
    lab.load(ground(1.0))
    arm = lab.load(_arm(base))
    _stay(lab, laws, f"an arm with brakes, {base}, {seconds} s", [(arm, "body"), (arm, "l2")],
          seconds, bar)


BENT = """<robot name="arm"><link name="world"/>
<link name="upper"><inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0"
ixz="0" iyz="0"/></inertial></link><joint name="elbow" type="revolute"><parent link="world"/>
<child link="upper"/><axis xyz="0 0 1"/><limit lower="0.8" upper="5" effort="9" velocity="9"/>
</joint></robot>"""


@pytest.mark.parametrize("steps", [0, 1, 7])
def test_a_joint_that_is_spawned_past_its_stop_goes_back_at_once(steps: int):
    """Into a world that runs, too: an arm that stood in the ground like that was flung about."""
    with my_simulations.open_world() as world:
        world.step(steps)
        world.spawn(BENT)
        world.step(1)
        assert world.joints().position["arm::elbow"] == pytest.approx(0.4, abs=1e-6)


@pytest.mark.parametrize("sleeps", [True, False])
def test_boxes_stay_on_a_ramp_of_20_degrees(lab: Lab, laws: Laws, sleeps: bool):
    tilt = _slope(lab, 20.0)
    carton, meshes = _mesh_model("carton", (0.07, 0.07, 0.17), 0.5)
    bodies = [lab.load(replace(box("b", 0.1, 0.5), allow_auto_disable=sleeps),
                       _on(tilt, 0.5, 0.05), tilt),
              lab.load(replace(carton, allow_auto_disable=sleeps), _on(tilt, -0.5, 0.0849), tilt,
                       meshes=meshes)]
    _stay(lab, laws, "boxes on a ramp of 20 degrees, 20 s", [(b, "link") for b in bodies], 20)


def _box_data(size: Tuple[float, float, float]) -> MeshData:
    corners = np.array([[x, y, z] for x in (-.5, .5) for y in (-.5, .5) for z in (-.5, .5)])
    faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7],
             [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
    return MeshData(corners * size, np.array(faces, dtype=np.int32))


def _joined(parts: List[MeshData]) -> MeshData:
    count, triangles = 0, []
    for part in parts:
        triangles.append(part.triangles + count)
        count += len(part.vertices)
    return MeshData(np.concatenate([part.vertices for part in parts]), np.concatenate(triangles),
                    parts)


def _mesh_model(name: str, size: Tuple[float, float, float],
                mass: float) -> Tuple[Model, MeshTable]:
    mesh, data = Mesh(name, f"/{name}"), _box_data(size)
    return (Model(name, links=[Link("link", inertial=inertial_of_box(mass, *size),
                                    collisions=[Collision("c", mesh)])]),
            {mesh_key(mesh): MeshData(data.vertices, data.triangles, [data])})


def _shelf() -> Tuple[Model, MeshTable]:
    """Three boards and two sides as one mesh; the boards' tops at 0.01, 0.41 and 0.81 m."""
    pieces = [((1, .4, .02), (0, 0, z)) for z in (0, .4, .8)]
    pieces += [((.02, .4, .9), (x, 0, .4)) for x in (-.5, .5)]
    parts = []
    for size, at in pieces:
        part = _box_data(size)
        parts.append(MeshData(part.vertices + at, part.triangles))
    mesh = Mesh("shelf", "/shelf")
    return (Model("shelf", static=True, links=[Link("link", collisions=[Collision("c", mesh)])]),
            {mesh_key(mesh): _joined(parts)})


def _mug() -> Tuple[Model, MeshTable]:
    """A ring of twelve blocks on a bottom, as a decomposition gives it; its origin at its foot."""
    parts = []
    for n in range(12):
        turn = 2.0 * math.pi * n / 12
        block = _box_data((0.006, 0.02, 0.1))
        c, s = math.cos(turn), math.sin(turn)
        around = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        parts.append(MeshData((block.vertices + (0.037, 0, 0.05)) @ around.T, block.triangles))
    bottom = _box_data((0.05, 0.05, 0.006))
    parts.append(MeshData(bottom.vertices + (0, 0, 0.003), bottom.triangles))
    mesh = Mesh("mug", "/mug")
    return (Model("mug", links=[Link("link", inertial=Inertial(
        0.3, Pose((0, 0, 0.045)), 5e-4, 0, 0, 5e-4, 0, 4e-4), collisions=[Collision("c", mesh)])]),
        {mesh_key(mesh): _joined(parts)})


@pytest.mark.parametrize("overlap", [0.0, 0.002, 0.005])
@pytest.mark.parametrize("sleeps", [True, False])
def test_mesh_objects_stay_on_the_boards_of_a_shelf(lab: Lab, laws: Laws, overlap: float,
                                                    sleeps: bool):
    shelf, meshes = _shelf()
    lab.load(shelf, meshes=meshes)
    bodies: Dict[int, float] = {}
    for n, top in enumerate((0.01, 0.41, 0.81)):
        book, meshes = _mesh_model(f"book{n}", (0.15, 0.2, 0.03), 0.4)
        at = top + 0.015
        bodies[lab.load(replace(book, allow_auto_disable=sleeps), (-0.3, 0, at - overlap),
                        quat_from_rpy(0, 0, 0.3 * n), meshes=meshes)] = at
        mug, meshes = _mug()
        bodies[lab.load(replace(mug, name=f"mug{n}", allow_auto_disable=sleeps),
                        (0.2, 0, top - min(overlap, 0.002)), quat_from_rpy(0, 0, 0.3 * n),
                        meshes=meshes)] = top
    for _ in range(100):
        lab.steps(10)
        for body, at in bodies.items():
            laws.at_most("mesh objects on shelves: how far overlaps make them jump, mm",
                         1e3 * (lab.pose(body).position[2] - at), 2.5)
    starts = {body: lab.pose(body) for body in bodies}
    lab.seconds(10)
    for body, start in starts.items():
        laws.at_most("mesh objects on shelves: creep in 10 s, mm", 1e3 * math.dist(
            lab.pose(body).position, start.position), 0.1)


def test_a_can_with_the_inertia_of_a_ship_does_not_roll_out_of_an_overlap(lab: Lab, laws: Laws):
    # Moments in g mm^2 taken for kg m^2: a frequent slip of exporters.
    lab.load(slab("floor", (2, 2, 1)), (0, 0, -0.5))
    can = Model("can", allow_auto_disable=False, links=[Link(
        "link", inertial=Inertial(0.15, Pose(), 2080, 0, 0, 2080, 0, 419),
        collisions=[Collision("c", Box((0.05, 0.05, 0.15)))])])
    body = lab.load(can, (0, 0, 0.070))
    lab.seconds(20)
    laws.at_most("a can with a huge inertia, 5 mm in the floor: way in 20 s, mm",
                 1e3 * math.hypot(*lab.pose(body).position[:2]), 10.0)
