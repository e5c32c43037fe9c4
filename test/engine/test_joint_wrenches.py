"""What joints transmit, against the closed forms of masses that hang, swing and are carried."""
from __future__ import annotations

import math
from dataclasses import replace
from typing import Optional, Sequence

import numpy as np
import pytest
from conftest import Lab, ball, box, ground, inertial_of_box, link_of

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.shapes import Box, Surface
from my_simulations.engine.commands import (
    FOREVER,
    ConnectModels,
    DisconnectModels,
    JointWrench,
    PinModels,
    ReadJointWrenches,
    Restart,
)
from my_simulations.engine.drive_commands import JointMotor, SetMotors
from my_simulations.engine.timed_forces import AddTimedForces, TimedEffort, TimedWrench
from my_simulations.geometry import Pose, conjugate, quat_from_rpy, rotate

G = 9.8
EXACT = 0.001  # 0.1 %


def _read(lab: Lab, number: int, *names: str) -> "list[Optional[JointWrench]]":
    return list(lab.apply(ReadJointWrenches(tuple((number, name) for name in names))))


def _one(lab: Lab, number: int, name: str = "hinge") -> JointWrench:
    wrench = _read(lab, number, name)[0]
    assert wrench is not None
    return wrench


def _near(laws, law: str, measured: Sequence[float], expected: Sequence[float],
          scale: float = 0.0, bar: float = EXACT) -> None:
    """Compare vectors by the length of what is expected, or `scale`."""
    off = float(np.linalg.norm(np.array(measured) - np.array(expected)))
    laws.at_most(law, off / (scale or float(np.linalg.norm(expected))), bar)


def _hanging(kind: str, turn=(0.3, -0.4, 0.5), anchor: Pose = Pose(), reverse: bool = False,
             gravity: bool = True) -> Model:
    """A mass of 2 kg, half a metre along x of a link that hangs on the world."""
    link = Link("bob", Pose((0, 0, 2), quat_from_rpy(*turn)),
                inertial_of_box(2, 0.1, 0.2, 0.3, Pose((0.5, 0, 0), quat_from_rpy(0.5, 0.2, 1))),
                gravity=gravity)
    ends = ("bob", "world") if reverse else ("world", "bob")
    return Model("hanging", links=[link], joints=[Joint(
        "hinge", kind, *ends, anchor, axis=JointAxis((0, 1, 0)) if kind == "revolute" else None)])


def test_a_mass_that_hangs_on_a_fixed_joint(lab: Lab, laws) -> None:
    for turn in ((0, 0, 0), (0.3, -0.4, 0.5), (3, 1, -2)):
        number = lab.load(_hanging("fixed", turn, Pose((0.1, 0.2, 0.3), quat_from_rpy(1, 2, 3))))
        assert _read(lab, number, "hinge") == [None]  # not requested before
        lab.steps(3)
        wrench = _one(lab, number)
        up = rotate(conjugate(quat_from_rpy(*turn)), (0, 0, 2 * G))
        _near(laws, "wrench of a fixed joint, a mass at rest", wrench.force, up)
        _near(laws, "wrench of a fixed joint, a mass at rest", wrench.torque,
              np.cross((0.4, -0.2, -0.3), up))
        assert wrench.parent_from_child == (0, 0, 0, 1)


def test_a_pendulum_pulls_at_its_hinge(lab: Lab, laws) -> None:
    number = lab.load(_hanging("revolute", (0, 0, 0)))
    _read(lab, number, "hinge")
    for _ in range(60):
        angle, rate = lab.joint(number)
        lab.steps(1)
        wrench = _one(lab, number)
        gain = (lab.joint(number)[1] - rate) / 0.001
        # In the link: x away from the hinge, z down where it began level.
        along = -2 * (G * math.sin(angle) + rate ** 2 * 0.5)
        across = 2 * (G * math.cos(angle) - gain * 0.5)
        _near(laws, "force of a hinge, a mass that swings", wrench.force, (along, 0, across))
        _near(laws, "torque about a free hinge", (wrench.torque[1],), (0,), 2 * G * 0.5)
        lab.seconds(0.05)


def _chain() -> Model:
    """Three links with inclined hinges that end nowhere in particular."""
    links, joints, above = [], [], "world"
    at = 2.0
    for n, axis in enumerate(((0, 1, 0), (0.6, 0, 0.8), (1, 0, 0))):
        links.append(Link(f"l{n}", Pose((0.3 * n, 0.1 * n, at)), inertial_of_box(
            1.0 + n, 0.1, 0.2, 0.3, Pose((0.2, 0.1, -0.1), quat_from_rpy(n, 1, 2)))))
        joints.append(Joint(f"j{n}", "revolute", above, f"l{n}", axis=JointAxis(
            axis, damping=0.01)))
        above = f"l{n}"
    return Model("chain", links=links, joints=joints)


def test_what_passes_about_an_axis_is_its_effort_and_its_damping(lab: Lab, laws) -> None:
    number = lab.load(_chain())
    efforts = (3.0, -1.0, 0.5)
    rows = [lab.joint_rows[number, f"j{n}"] for n in range(3)]
    lab.apply(AddTimedForces(tuple(TimedEffort(n, row, 0, FOREVER, effort)
                                   for n, (row, effort) in enumerate(zip(rows, efforts)))))
    names = ("j0", "j1", "j2")
    _read(lab, number, *names)
    for _ in range(60):
        before = [lab.joint(number, name)[1] for name in names]
        lab.steps(1)
        for name, rate, effort, axis in zip(names, before, efforts, (
                (0, 1, 0), (0.6, 0, 0.8), (1, 0, 0))):
            wrench = _one(lab, number, name)
            _near(laws, "torque about a driven, damped axis of a chain",
                  (float(np.dot(wrench.torque, axis)),), (effort - 0.01 * rate,),
                  float(np.linalg.norm(wrench.torque)) + 1.0)
        lab.seconds(0.02)


@pytest.mark.parametrize("first", ["arm", "box"])
def test_a_tray_carries_what_lies_on_it(lab: Lab, laws, first: str) -> None:
    tray = Model("tray", links=[
        link_of(Box((0.6, 0.6, 0.02)), inertial_of_box(1, 0.6, 0.6, 0.02), Surface(mu=1.0),
                "tray", Pose((0, 0, 1), quat_from_rpy(0.0, 0.2, 0.0)))],
        joints=[Joint("wrist", "fixed", "world", "tray")])
    load = box("load", 0.2, 3.0, Surface(mu=1.0))
    at = ((0.1 + 0.11 * math.sin(0.2), 0, 1.0 - 0.1 * math.tan(0.2) + 0.109),
          quat_from_rpy(0.0, 0.2, 0.0))
    if first == "box":
        lab.load(load, *at)
    number = lab.load(tray)
    if first == "arm":
        lab.load(load, *at)
    _read(lab, number, "wrist")
    lab.seconds(3.0)
    wrench = _one(lab, number, "wrist")
    _near(laws, "force of a joint under a tray with a load on it",
          rotate(quat_from_rpy(0.0, 0.2, 0.0), wrench.force), (0, 0, 4 * G))


def test_the_parent_may_be_the_outer_link(lab: Lab, laws) -> None:
    """A joint whose child is the world, or the root of the tree: signs and axes stay."""
    number = lab.load(_hanging("fixed", reverse=True))
    _read(lab, number, "hinge")
    lab.steps(3)
    wrench = _one(lab, number)
    # The child is the world: the mass pulls it down, in the world's axes.
    _near(laws, "force on the world as the child of a joint", wrench.force, (0, 0, -2 * G))
    expected = conjugate(quat_from_rpy(0.3, -0.4, 0.5))
    assert np.allclose(wrench.parent_from_child, expected)


def test_both_wheels_of_a_universal_joint(lab: Lab, laws) -> None:
    link = Link("bob", Pose((0, 0, 2)), Inertial(2, Pose((0, 0, -0.5)), .1, 0, 0, .1, 0, .1))
    number = lab.load(Model("m", links=[link], joints=[Joint(
        "cross", "universal", "world", "bob", axis=JointAxis((1, 0, 0)),
        axis2=JointAxis((0, 1, 0)))]))
    _read(lab, number, "cross")
    lab.steps(3)
    _near(laws, "force of a universal joint, a mass at rest", _one(lab, number, "cross").force,
          (0, 0, 2 * G))


def test_a_lift_that_speeds_up(lab: Lab, laws) -> None:
    lift = Model("lift", links=[Link("cabin", inertial=Inertial(5, Pose(), 1, 0, 0, 1, 0, 1))],
                 joints=[Joint("rail", "prismatic", "world", "cabin", axis=JointAxis())])
    number = lab.load(lift)
    lab.apply(SetMotors((JointMotor(lab.joint_rows[number, "rail"], 100.0, 60.0),)))
    _read(lab, number, "rail")
    lab.steps(20)
    _near(laws, "force of a sliding joint, by its motor", _one(lab, number, "rail").force,
          (0, 0, 60))


def test_a_wrench_from_outside_passes_through(lab: Lab, laws) -> None:
    number = lab.load(_hanging("fixed", gravity=False))
    lab.apply(AddTimedForces((TimedWrench(1, lab.rows[number, "bob"], 0, FOREVER, (1, 2, 3),
                                          (4, 5, 6), in_link_axes=True),)))
    _read(lab, number, "hinge")
    lab.steps(5)
    wrench = _one(lab, number)
    _near(laws, "wrench of a fixed joint, a wrench from outside", wrench.force, (-1, -2, -3))
    _near(laws, "wrench of a fixed joint, a wrench from outside", wrench.torque,
          -np.array((4, 5, 6)) - np.cross((0.5, 0, 0), (1, 2, 3)))


@pytest.mark.parametrize("articulated", [False, True])
def test_what_a_hand_was_tied_to_hangs_on_its_wrist(lab: Lab, laws, articulated: bool) -> None:
    turn = (0.7, -0.4, 0.3)
    hand = lab.load(_hanging("fixed", turn))
    at = np.array((0, 0, 2)) + rotate(quat_from_rpy(*turn), (1, 0, 0))
    held = lab.load(ball("held", 0.1, 3.0), at, articulated=articulated)
    lab.apply(ConnectModels(Joint("grip", "fixed", "hand", "held"), lab.rows[hand, "bob"],
                            Pose((1.0, 0, 0)), lab.rows[held, "link"], Pose()))
    _read(lab, hand, "hinge")
    lab.seconds(2.0)
    wrench = _one(lab, hand)
    up = np.array(rotate(conjugate(quat_from_rpy(*turn)), (0, 0, G)))
    law = "wrench of a wrist, with something tied to the hand"
    _near(laws, law, wrench.force, 5 * up)
    _near(laws, law, wrench.torque, np.cross((2 * 0.5 + 3 * 1.0, 0, 0), up))


def test_a_robot_that_is_held_carries_its_arm(lab: Lab, laws) -> None:
    """A pinned base; and a robot on a floor, whose wheels carry all of it."""
    lab.load(ground())
    base = link_of(Box((0.4, 0.4, 0.2)), inertial_of_box(4, 0.4, 0.4, 0.2), name="base",
                   pose=Pose((0, 0, 0.1)))
    arm = Link("arm", Pose((0, 0, 0.3)), Inertial(1, Pose((0.3, 0, 0)), .01, 0, 0, .01, 0, .01))
    model = Model("robot", links=[base, arm], joints=[Joint("mount", "fixed", "base", "arm")])
    standing, pinned = lab.load(model), lab.load(model, (3, 0, 5))
    lab.apply(PinModels((pinned,)))
    for number in (standing, pinned):
        _read(lab, number, "mount")
    lab.seconds(1.0)
    for number in (standing, pinned):
        wrench = _one(lab, number, "mount")
        _near(laws, "wrench of a mount on a base that stands or is held", wrench.force, (0, 0, G))
        _near(laws, "wrench of a mount on a base that stands or is held", wrench.torque,
              (0, -0.3 * G, 0))


def _tie_and_untie(lab: Lab) -> None:
    """Tie two rigid balls, and for a moment a third with a joint: the ties get other numbers."""
    one, two, three = (lab.load(ball(f"b{n}", 0.1), (9, 0, n), articulated=n == 2)
                       for n in range(3))
    for name, other in (("stays", two), ("goes", three)):
        lab.apply(ConnectModels(Joint(name, "fixed", "b0", "b"), lab.rows[one, "link"], Pose(),
                                lab.rows[other, "link"], Pose((0, 0, -1))))
    lab.apply(DisconnectModels(("goes",)))


@pytest.mark.parametrize("reverse", [False, True])
@pytest.mark.parametrize("tied", [False, True])
def test_two_hinges_share_a_beam(lab: Lab, laws, reverse: bool, tied: bool) -> None:
    """One of them closes a loop, and is made of constraints."""
    if tied:
        _tie_and_untie(lab)
    beam = Link("beam", inertial=inertial_of_box(4, 1.0, 0.1, 0.1))
    ends = ("beam", "world") if reverse else ("world", "beam")
    number = lab.load(Model("m", links=[beam], joints=[
        Joint("near", "revolute", "world", "beam", Pose((-0.5, 0, 0)), axis=JointAxis((0, 1, 0))),
        Joint("far", "revolute", *ends, Pose((0.5, 0, 0)), axis=JointAxis((0, 1, 0)))]), (0, 0, 2))
    _read(lab, number, "near", "far")
    lab.seconds(2.0)
    law, up = "two hinges that share a beam: force, torque, by its weight", (0, 0, 2 * G)
    _near(laws, law, _one(lab, number, "near").force[2:], up[2:])
    far = _one(lab, number, "far")
    _near(laws, law, far.force[2:], (-2 * G if reverse else 2 * G,))
    _near(laws, law, (far.torque[1],), (0,), 2 * G)


def test_a_body_in_free_fall_transmits_nothing(lab: Lab) -> None:
    model = _chain()
    model.joints[0].parent = "l0"
    number = lab.load(Model("m", links=model.links, joints=model.joints[1:]))
    lab.push(number, (1, 2, 3), at=Pose())
    _read(lab, number, "j1")
    lab.steps(10)
    assert np.linalg.norm(_one(lab, number, "j1").force) < 1e-6


def test_who_reads_changes_nothing(lab: Lab) -> None:
    number = lab.load(_chain())

    def run(reading: bool) -> bytes:
        for _ in range(30):
            if reading:
                _read(lab, number, "j0", "j2")
            lab.steps(7)
        return b"".join(bytes(table) for table in lab.backend.tables())

    def restart() -> None:
        lab.apply(Restart(((number, Pose()),)))
        lab.step = 0

    restart()
    alone = run(False)
    restart()
    assert run(True) == alone
    restart()
    assert _read(lab, number, "j0") == [None]
    lab.steps(1)
    assert _read(lab, number, "j0") != [None]


def test_joints_of_static_models_carry_nothing(lab: Lab) -> None:
    number = lab.load(replace(_hanging("fixed"), static=True))
    assert _read(lab, number, "hinge") == [JointWrench()]
    assert _read(lab, number, "nowhere") == [None]


def test_joints_that_are_gone_are_not_measured(lab: Lab) -> None:
    number = lab.load(_hanging("fixed"))
    _read(lab, number, "hinge", "nowhere")
    lab.steps(1)
    assert _read(lab, number, "nowhere") == [None]
    lab.remove(number)
    lab.steps(1)
    assert _read(lab, number, "hinge") == [None]
    lab.steps(1)
    assert lab.backend._helpers.wrenches.idle
