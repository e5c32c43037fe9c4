"""A world that begins anew without being loaded again."""
from __future__ import annotations

from dataclasses import replace
from typing import Dict

import pybullet
import pytest
from conftest import Lab, arm, ball, box, ground, inertial_of_box
from test_contact import _cube_mesh

from my_simulations.description.model import Joint, JointAxis, Link, Model
from my_simulations.description.shapes import Box, Collision, Mesh, mesh_key
from my_simulations.engine.api import Refused
from my_simulations.engine.commands import Clear, Restart, SetAxes, SetJoints
from my_simulations.geometry import Pose

CUBE = Mesh("cube", "/cube")


def _odd() -> Model:
    """Twenty shapes on one link, a ball joint, and a joint of two axes."""
    bits = [Collision(f"c{n}", Box((0.1, 0.1, 0.1)), Pose((0.1 * (n % 5), 0.1 * (n // 5), 0)))
            for n in range(20)]
    links = [Link(name, pose=Pose((0, 0, 0.5 * n)), inertial=inertial_of_box(1, 0.4, 0.4, 0.1),
                  collisions=bits if n == 0 else [])
             for n, name in enumerate(("link", "ball", "cross"))]
    axis = JointAxis((1, 0, 0), damping=0.1)
    return Model("odd", links=links, joints=[
        Joint("socket", "ball", "link", "ball"),
        Joint("both", "universal", "ball", "cross", axis=axis, axis2=JointAxis((0, 1, 0)))])


def _filled(lab: Lab) -> Dict[int, Pose]:
    """Models of every kind, and where they begin."""
    mesh = Model("mesh", links=[Link("link", inertial=inertial_of_box(1, 1, 1, 1),
                                     collisions=[Collision("c", CUBE)])])
    spring = arm("revolute", JointAxis((0, 1, 0), spring_stiffness=30.0, damping=2.0))
    at = [(ground(), Pose()), (box("b0"), Pose((0, 0, 0.6))), (box("b1"), Pose((0.1, 0, 1.7))),
          (ball(), Pose((0.2, 0.1, 3.0))), (spring, Pose((0, 6, 2))), (_odd(), Pose((3, 0, 1))),
          (mesh, Pose((-2, 0, 1), (0.6, 0.0, 0.0, 0.8)))]
    meshes = {mesh_key(CUBE): _cube_mesh()}
    return {lab.load(model, pose.position, pose.orientation, meshes): pose for model, pose in at}


def _run(lab: Lab) -> bytes:
    lab.step = 0
    found = b""
    for _ in range(60):
        lab.steps(25)
        found += b"".join(bytes(table) for table in lab.backend.tables())
    return found


def test_a_world_restarted_gives_the_same_bits(lab):
    starts = tuple(_filled(lab).items())
    expected = _run(lab)
    for _ in range(2):
        lab.apply(Restart(starts))
        assert _run(lab) == expected


def test_what_is_restarted_has_the_axes_it_was_given(lab):
    model = arm("revolute", JointAxis((0, 1, 0)))
    number = lab.load(model)
    hinge = replace(model.joints[0], axis=JointAxis((0, 1, 0), lower=-0.1, upper=0.1))
    lab.apply(SetAxes(number, (hinge,)))
    lab.apply(Restart(((number, Pose()),)))
    lab.apply(SetJoints(((lab.joint_rows[number, "hinge"], 0.0, 3.0),)))
    lab.seconds(1.0)
    assert abs(lab.joint(number)[0]) == pytest.approx(0.1, abs=0.02)


def test_models_come_back_where_the_restart_says_and_no_others(lab):
    kept, gone = lab.load(box("kept")), lab.load(box("gone"), (5, 0, 0))
    lab.apply(Restart(((kept, Pose((1, 2, 3))),)))
    lab.backend.read()
    assert lab.pose(kept).position == (1, 2, 3)
    with pytest.raises(Refused, match="not there"):
        lab.remove(gone)
    assert pybullet.getNumBodies() == 1


def test_a_restart_with_a_model_that_is_not_there_changes_nothing(lab):
    number = lab.load(box(), (0, 0, 7))
    with pytest.raises(Refused, match="not there"):
        lab.apply(Restart(((number, Pose()), (99, Pose()))))
    lab.backend.read()
    assert lab.pose(number).position == (0, 0, 7)


def test_no_body_carries_a_picture_of_its_shape(lab):
    for _ in range(2):
        _filled(lab)
        shown = [entry for body in range(pybullet.getNumBodies())
                 for entry in pybullet.getVisualShapeData(pybullet.getBodyUniqueId(body))]
        assert {entry[2] for entry in shown} == {pybullet.GEOM_MESH}   # the one triangle
        lab.apply(Clear())
