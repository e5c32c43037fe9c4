"""Kinematic links that have joints: held, whatever hangs on them (ODE, dBodySetKinematic)."""
from __future__ import annotations

import math
from dataclasses import replace
from typing import List

import numpy as np
import pytest
from closed_forms import pendulum
from conftest import Lab, ball, box, ground, inertial_of_box, link_of

from my_simulations.description.flatten import flatten_model
from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.shapes import Box, Collision, Mesh, MeshData, mesh_key
from my_simulations.engine.commands import SetLinkState, SetModelState
from my_simulations.geometry import Pose

START = Pose((0.0, 0.0, 3.0))
Y = JointAxis((0.0, 1.0, 0.0))


def still(name: str, pose: Pose = Pose()) -> Link:
    return replace(link_of(Box((0.2,) * 3), Inertial(), None, name, pose), kinematic=True)


def bob(name: str = "bob", x: float = 1.0, z: float = 0.0) -> Link:
    return Link(name, Pose((x, 0.0, z)), Inertial(1.0, Pose(), 1e-3, 0, 0, 1e-3, 0, 1e-3))


def hinge(name: str, parent: str, child: str, x: float = -1.0) -> Joint:
    return Joint(name, "revolute", parent, child, Pose((x, 0.0, 0.0)), Y)


def hung(*links: Link, joints: List[Joint]) -> Model:
    return Model("hung", pose=START, links=list(links), joints=joints)


def drop(lab: Lab, model: Model, seconds: float = 0.5) -> int:
    lab.configure(gravity=(0.0, 0.0, -9.8))
    number = lab.load(model, START.position)
    lab.seconds(seconds)
    return number


@pytest.mark.parametrize("joint", [hinge("hinge", "base", "bob"),
                                   hinge("hinge", "bob", "base", 0.0)], ids=["child", "parent"])
def test_an_arm_swings_about_the_kinematic_link_it_hangs_on(lab: Lab, joint: Joint):
    number = drop(lab, hung(still("base"), bob(), joints=[joint]))
    assert lab.pose(number, "base").position == pytest.approx(START.position, abs=1e-9)
    angle, _ = pendulum(0.0, 0.0, 1.0 + 1e-3, 9.8, 0.0, 0.5)
    x, _, z = lab.pose(number, "bob").position
    assert math.atan2(3.0 - z, x) == pytest.approx(angle, abs=0.02)


def test_a_door_hangs_on_the_static_frame_nested_in_its_model(lab: Lab):
    frame = Model("frame", static=True, links=[link_of(Box((0.1, 0.1, 2.0)), Inertial(), None,
                                                       "post", Pose((0.0, 0.0, 1.0)))])
    door = link_of(Box((0.8, 0.05, 1.8)), inertial_of_box(10.0, 0.8, 0.05, 1.8), None, "door",
                   Pose((0.45, 0.0, 1.0)))
    model = flatten_model(Model("entrance", links=[door], models=[frame], joints=[
        Joint("turn", "revolute", "frame::post", "door", Pose((-0.45, 0.0, 0.0)),
              JointAxis((0.0, 0.0, 1.0)))]))
    number = drop(lab, model, 1.0)
    assert lab.pose(number, "frame::post").position == pytest.approx((0.0, 0.0, 4.0), abs=1e-9)
    assert lab.pose(number, "door").position == pytest.approx((0.45, 0.0, 4.0), abs=1e-6)


def test_a_link_between_two_kinematic_ones_hangs_on_both(lab: Lab):
    number = drop(lab, hung(still("left"), still("right", Pose((2.0, 0.0, 0.0))), bob(), joints=[
        hinge("one", "left", "bob"), hinge("two", "right", "bob", 1.0)]))
    assert lab.pose(number, "bob").position == pytest.approx((1.0, 0.0, 3.0), abs=0.01)
    assert lab.pose(number, "right").position == pytest.approx((2.0, 0.0, 3.0), abs=1e-9)


def test_a_joint_between_links_that_nothing_moves_holds_nothing(lab: Lab):
    number = drop(lab, hung(still("left"), still("right", Pose((2.0, 0.0, 0.0))), joints=[
        hinge("one", "left", "right"), hinge("two", "world", "left", 0.0)]))
    for name, x in (("left", 0.0), ("right", 2.0)):
        assert lab.pose(number, name).position == pytest.approx((x, 0.0, 3.0), abs=1e-9)
    assert lab.joint(number, "one") == (0.0, 0.0)


def test_what_hangs_on_a_kinematic_link_goes_where_its_model_is_put(lab: Lab):
    number = drop(lab, hung(still("base"), bob(), joints=[hinge("hinge", "base", "bob")]))
    angle = lab.joint(number)[0]
    lab.apply(SetModelState(number, Pose((5.0, 0.0, 1.0))))
    lab.backend.read()
    assert lab.pose(number, "base").position == pytest.approx((5.0, 0.0, 1.0), abs=1e-9)
    x, _, z = lab.pose(number, "bob").position
    assert (x, z) == pytest.approx((5.0 + math.cos(angle), 1.0 - math.sin(angle)), abs=1e-6)


def test_things_rest_on_a_kinematic_link_that_has_joints(lab: Lab):
    lab.configure(gravity=(0.0, 0.0, -9.8))
    lab.load(ground())
    lab.load(hung(still("base"), bob(), joints=[hinge("hinge", "base", "bob")]), START.position)
    cube = lab.load(box(size=0.2), (0.0, 0.0, 3.25))
    lab.seconds(1.0)
    assert lab.pose(cube).position == pytest.approx((0.0, 0.0, 3.2), abs=0.002)


def test_a_mesh_of_a_kinematic_link_with_joints_keeps_its_hollows(lab: Lab):
    """A tray of five boards, as triangles: a ball lies within it, not on its hull."""
    boards = [((0.0, 0.0, -0.05), (1.0, 1.0, 0.1))] + [
        ((0.5 * x, 0.5 * y, 0.2), (0.1 + abs(y), 0.1 + abs(x), 0.6))
        for x, y in ((1, 0), (-1, 0), (0, 1), (0, -1))]
    vertices, triangles = [], []
    for centre, size in boards:
        first = len(vertices)
        vertices += [tuple(c + s * (0.5 if bit else -0.5) for c, s, bit in zip(
            centre, size, (n & 4, n & 2, n & 1))) for n in range(8)]
        for a, b, c, d in ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4),
                           (1, 5, 7, 3)):
            triangles += [(first + a, first + b, first + c), (first + a, first + c, first + d)]
    shape = Mesh("tray")
    tray = replace(still("base"), collisions=[Collision("c", shape)])
    model = hung(tray, bob(x=3.0), joints=[hinge("hinge", "base", "bob", -3.0)])
    lab.configure(gravity=(0.0, 0.0, -9.8))
    lab.load(model, START.position, meshes={
        mesh_key(shape): MeshData(np.array(vertices), np.array(triangles))})
    inside = lab.load(ball(radius=0.1), (0.0, 0.0, 3.3))
    lab.seconds(1.0)
    assert lab.pose(inside).position[2] == pytest.approx(3.1, abs=0.005)


def test_a_kinematic_link_can_be_put_elsewhere_with_what_hangs_on_it(lab):
    model = drop(lab, hung(still("post"), bob(), joints=[hinge("swing", "post", "bob")]))
    angle = lab.joint(model, "swing")[0]
    lab.apply(SetLinkState(lab.rows[model, "post"], Pose((5.0, 0.0, 4.0))))
    lab.steps(1)
    assert lab.pose(model, "post").position == pytest.approx((5.0, 0.0, 4.0), abs=1e-9)
    assert math.dist(lab.pose(model, "bob").position, (5.0, 0.0, 4.0)) == pytest.approx(1.0)
    assert lab.joint(model, "swing")[0] == pytest.approx(angle, abs=0.02)
