"""A world that restarts without being loaded again."""
from __future__ import annotations

import os
from dataclasses import replace
from typing import Dict

import pybullet
import pytest
from conftest import Lab, arm, ball, box, ground, inertial_of_box
from test_contact import _cube_mesh

from my_simulations.description.model import Joint, JointAxis, Link, Model
from my_simulations.description.shapes import Box, Collision, Cylinder, Mesh, Sphere, mesh_key
from my_simulations.engine.api import CommandRefusedError, EngineBrokenError
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
    for times in (1, 1, 3):
        for _ in range(times):
            lab.apply(Restart(starts))
        assert _run(lab) == expected


def test_a_heap_that_is_restarted_falls_as_it_fell_first(lab):
    shapes = [Box((1.0, 1.0, 1.0)), Cylinder(0.3, 0.6), Sphere(0.3), Box((1.0, 1.0, 1.0))]
    tilt = (0.0, 0.3826834, 0.0, 0.9238795)
    starts = [(lab.load(ground()), Pose())]
    for n, shape in enumerate(shapes):
        pose = Pose((0.4 * (n % 3), 0.37 * (n % 2), 0.6 + 0.7 * n), tilt)
        link = Link("link", inertial=inertial_of_box(1, 1, 1, 1),
                    collisions=[Collision("c", shape)])
        starts.append((lab.load(Model(f"m{n}", links=[link]), pose.position, tilt), pose))
    expected = _run(lab)
    for _ in range(2):
        lab.apply(Restart(tuple(starts)))
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
    with pytest.raises(CommandRefusedError, match="no longer exists"):
        lab.remove(gone)
    assert pybullet.getNumBodies() == 1


def test_a_world_known_to_begin_so_is_shown_at_once_and_built_when_it_is_used(lab, monkeypatch):
    number = lab.load(arm("revolute", JointAxis((0, 1, 0))), (0, 0, 4))
    falls = lab.load(box(), (0, 0, 9))
    restart = Restart(((number, Pose((0, 0, 4))), (falls, Pose((0, 0, 9)))))
    lab.apply(restart)
    lab.backend.read()
    begun = [bytes(table) for table in lab.backend.tables()]
    made = []
    new_world = pybullet.resetSimulation
    monkeypatch.setattr(pybullet, "resetSimulation", lambda: made.append(1) or new_world())
    uses = [lambda: lab.steps(1), lambda: lab.push(falls, (1, 0, 0)),
            lambda: lab.configure(gravity=(0, 0, -1)), lambda: lab.load(box("other"), (5, 0, 0))]
    for n, use in enumerate(uses, 1):
        lab.steps(50)
        for _ in range(3):
            lab.apply(restart)
            assert lab.backend.read() and lab.backend.read_poses()
            assert [bytes(table) for table in lab.backend.tables()] == begun
            assert len(made) == n - 1
        use()
        assert len(made) == n
    assert lab.pose(falls).position == (0, 0, 9)


def test_a_world_begins_where_the_restart_says_though_it_has_begun_elsewhere_before(lab):
    number = lab.load(box(), (0, 0, 9))
    for z in (9.0, 9.0, 7.0, 7.0, 9.0):
        lab.apply(Restart(((number, Pose((0, 0, z))),)))
        lab.backend.read()
        assert lab.pose(number).position == (0, 0, z)
        lab.steps(1)
        assert z - 1e-4 < lab.pose(number).position[2] < z


def test_a_restart_takes_out_what_it_does_not_name_also_when_it_was_made_before(lab):
    kept, gone = lab.load(box("kept")), lab.load(box("gone"), (5, 0, 0))
    both = Restart(((kept, Pose()), (gone, Pose((5, 0, 0)))))
    lab.apply(both)
    lab.apply(both)
    lab.apply(Restart(((kept, Pose()),)))
    lab.steps(1)
    assert pybullet.getNumBodies() == 1


def test_an_emptied_world_is_not_filled_again(lab):
    number = lab.load(box())
    restart = Restart(((number, Pose()),))
    lab.apply(restart)
    lab.apply(restart)
    lab.apply(Clear())
    lab.steps(1)
    assert pybullet.getNumBodies() == 0


def test_an_engine_that_cannot_build_a_world_again_ends(lab):
    _filled(lab)
    for path in lab.backend._shapes._files._paths.values():
        os.remove(path)
    with pytest.raises(EngineBrokenError, match="built again"):
        lab.apply(Restart(tuple((number, Pose()) for number in lab.backend._models)))


def test_a_restart_with_a_model_that_is_not_there_changes_nothing(lab):
    number = lab.load(box(), (0, 0, 7))
    with pytest.raises(CommandRefusedError, match="no longer exists"):
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
