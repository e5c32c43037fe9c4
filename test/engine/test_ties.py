"""Joints between links of different models."""
from __future__ import annotations

import math
import os
import signal
import time
from dataclasses import replace
from functools import partial

import pytest
from closed_forms import pendulum
from conftest import Lab, arm, box, ground, slab
from plugin_case import kept
from running_simulator import running, started

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.world import World
from my_simulations.engine.api import CommandRefusedError
from my_simulations.engine.commands import Clear, ConnectModels
from my_simulations.engine.process_engine import ProcessEngine
from my_simulations.geometry import Pose, Twist, compose, inverse, quat_from_rpy, transform
from my_simulations.simulator.history import History
from my_simulations.simulator.operations import RemoveModel
from my_simulations.simulator.simulator import Simulator

Y = (0.0, 1.0, 0.0)


def _tie(lab: Lab, joint: Joint, parent: int, child: int, parent_link: str = "link") -> None:
    """Joint the links `parent_link` and `link` of two models, where they are; -1: the world."""
    at = compose(lab.pose(child), joint.pose)
    parent_row, above = -1, at
    if parent >= 0:
        parent_row = lab.rows[parent, parent_link]
        above = compose(inverse(lab.pose(parent, parent_link)), at)
    lab.apply(ConnectModels(joint, parent_row, above, lab.rows[child, "link"], joint.pose))


def _bob(name: str = "bob") -> Model:
    """1 kg, its centre of mass 1 m along x from the link's origin, its inertia axes turned."""
    com = Pose((1, 0, 0), quat_from_rpy(0.3, 0.2, 0.1))
    return Model(name, links=[Link("link", inertial=Inertial(1.0, com, 1e-3, 0, 0, 1e-3, 0, 1e-3))])


def _swing(kind: str) -> Joint:
    return Joint("tie", kind, "", "", axis=JointAxis(Y))


def _parents(lab: Lab, kind: str, articulated: bool = False):
    """An immovable parent of each kind at the origin, and the link to tie to."""
    if kind == "world":
        return -1, "link"
    if kind == "static":
        return lab.load(slab("wall", (0.2, 0.2, 0.2)), articulated=articulated), "link"
    fixed = Model("post", links=[Link("post")], joints=[Joint("foot", "fixed", "world", "post")])
    return lab.load(fixed), "post"


@pytest.mark.parametrize("parent", ["world", "static", "articulated"])
@pytest.mark.parametrize("kind", ["revolute", "ball"])
def test_a_body_swings_on_a_joint_to_another_model_as_a_pendulum(lab: Lab, parent: str, kind: str):
    post, link = _parents(lab, parent)
    bob = lab.load(_bob())
    lab.steps(1)
    _tie(lab, _swing(kind), post, bob, link)
    lab.seconds(1)
    angle, _ = pendulum(0.0, 0.0, 1.001, 9.8, 0.0, 1.0)
    tip = transform(lab.pose(bob), (1, 0, 0))
    assert tip == pytest.approx((math.cos(angle), 0.0, -math.sin(angle)), abs=0.02)
    assert lab.pose(bob).position == pytest.approx((0, 0, 0), abs=2e-3)


@pytest.mark.parametrize("parent", ["world", "static", "articulated"])
def test_a_fixed_joint_to_another_model_holds_a_body_out(lab: Lab, parent: str):
    post, link = _parents(lab, parent)
    bob = lab.load(_bob(), (0, 0, 0), quat_from_rpy(0.1, 0.2, 0.3))
    start = lab.pose(bob)
    _tie(lab, Joint("tie", "fixed", "", "", Pose((0.1, 0, 0), quat_from_rpy(0, 1, 0))), post, bob,
         link)
    lab.seconds(2)
    assert lab.pose(bob).position == pytest.approx(start.position, abs=5e-3)
    assert lab.pose(bob).orientation == pytest.approx(start.orientation, abs=5e-3)


@pytest.mark.parametrize("parent", ["world", "static", "articulated"])
def test_a_sliding_joint_lets_a_body_fall_along_its_axis_only(lab: Lab, parent: str):
    post, link = _parents(lab, parent, articulated=True)
    bob = lab.load(_bob(), (0, 0, 0), quat_from_rpy(0, 0, 0.5), articulated=True)
    lab.steps(1)
    start = lab.pose(bob)
    slope = quat_from_rpy(0, math.radians(30), 0)
    _tie(lab, Joint("rail", "prismatic", "", "", Pose((0, 0, 0), slope),
                    axis=JointAxis((1, 0, 0))), post, bob, link)
    lab.seconds(1)
    along = 0.5 * 9.8 * math.sin(math.radians(30))
    expected = compose(start, Pose((0, 0, 0), slope))
    assert lab.pose(bob).position == pytest.approx(transform(expected, (along, 0, 0)), abs=0.05)
    assert lab.pose(bob).orientation == pytest.approx(start.orientation, abs=5e-3)


def test_two_models_of_one_link_each_hang_together_and_turn_on_their_hinge(lab: Lab):
    lab.load(ground())
    left, right = lab.load(box("a"), (0, 0, 5)), lab.load(box("b"), (1.0, 0, 5))
    hinge = Joint("hinge", "revolute", "", "", Pose((-0.5, 0, 0.5)), axis=JointAxis(Y))
    _tie(lab, hinge, left, right)
    lab.push(right, angular=(0, 2, 0), at=lab.pose(right))
    for _ in range(80):
        lab.steps(10)
        assert transform(lab.pose(left), (0.5, 0, 0.5)) == pytest.approx(
            transform(lab.pose(right), (-0.5, 0, 0.5)), abs=5e-3)
    assert lab.twist(right).angular[1] - lab.twist(left).angular[1] != pytest.approx(0, abs=0.1)


def test_the_tie_goes_with_either_model_and_the_other_may_sleep_again(lab: Lab):
    lab.load(ground())
    post = lab.load(slab("post", (0.2, 0.2, 0.2)), (0, 0, 2))
    hung = lab.load(box(), (0, 0, 1))
    _tie(lab, Joint("tie", "fixed", "", "", Pose((0, 0, 1))), post, hung)
    lab.seconds(4)
    assert lab.pose(hung).position[2] == pytest.approx(1.0, abs=1e-3)
    lab.remove(post)
    lab.seconds(4)
    assert lab.pose(hung).position[2] == pytest.approx(0.5, abs=1e-3)
    assert lab.twist(hung) == Twist()
    lab.remove(hung)
    lab.steps(10)


def test_a_tied_body_hangs_still_without_being_taken_for_resting(lab: Lab):
    post = lab.load(slab("post", (0.2, 0.2, 0.2)))
    far = lab.load(box("far"), (0, 0, -3))
    _tie(lab, Joint("tie", "ball", "", "", Pose((0, 0, 3))), post, far)
    lab.seconds(4)
    lab.push(far, (1, 0, 0))
    lab.seconds(1)
    assert lab.pose(far).position[0] > 0.3


def test_tied_links_do_not_collide(lab: Lab):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    one, other = lab.load(box("a")), lab.load(box("b"), (0.7, 0, 0))
    _tie(lab, Joint("tie", "fixed", "", ""), one, other)
    lab.steps(500)
    assert lab.pose(other).position == pytest.approx((0.7, 0, 0), abs=1e-6)


def test_what_no_constraint_can_stand_for_is_refused(lab: Lab):
    one, other = lab.load(box("a")), lab.load(box("b"), (2, 0, 0))
    with pytest.raises(CommandRefusedError, match="screw"):
        _tie(lab, _swing("screw"), one, other)
    with pytest.raises(CommandRefusedError, match="slides"):
        _tie(lab, _swing("prismatic"), one, other)
    lab.remove(one)
    with pytest.raises(CommandRefusedError, match="no longer exists"):
        lab.apply(
            ConnectModels(
                _swing("ball"), lab.rows[one, "link"], Pose(), lab.rows[other, "link"], Pose()
            )
        )


def test_ties_are_gone_after_everything_was_taken_out(lab: Lab):
    bob = lab.load(_bob())
    _tie(lab, _swing("ball"), -1, bob)
    lab.apply(Clear())
    again = lab.load(_bob("again"))
    _tie(lab, _swing("ball"), -1, again)
    lab.seconds(0.5)
    assert lab.pose(again).position == pytest.approx((0, 0, 0), abs=2e-3)


def test_links_of_two_articulated_models_hold_together(lab: Lab):
    first = lab.load(arm("revolute", JointAxis(Y), gravity=True))
    second = lab.load(arm("revolute", JointAxis(Y)), (2.0, 0, 0))
    at = (1.0, 0.0, 0.0)
    joint = Joint("tie", "ball", "", "", Pose((-1.0, 0, 0)))
    lab.apply(ConnectModels(joint, lab.rows[first, "bob"], Pose(at), lab.rows[second, "bob"],
                      Pose((-1.0, 0, 0))))
    lab.seconds(1)
    assert transform(lab.pose(first, "bob"), at) == pytest.approx(
        transform(lab.pose(second, "bob"), (-1.0, 0, 0)), abs=5e-3)


def _world() -> World:
    """A door on a post: two models, a hinge between them that the world keeps."""
    post = Model("post", static=True, links=[Link("l")])
    inertial = Inertial(2.0, Pose((0.5, 0, 0)), 0.1, 0, 0, 0.1, 0, 0.1)
    door = Model("door", pose=Pose((0, 0, 2)), links=[Link("l", inertial=inertial)])
    joint = Joint("door::hinge", "revolute", "post::l", "door::l", axis=JointAxis(Y))
    return World(models=[post, door], joints=[joint])


@pytest.fixture
def start():
    yield from kept(partial(started, engine=ProcessEngine))


def _hangs(sim: Simulator, name: str = "door") -> bool:
    """Whether the door's hinge is where it was, and it swings."""
    pose, twist = sim.states.model_state(name)
    return pose.position == pytest.approx((0, 0, 2), abs=5e-3) and abs(twist.angular[1]) > 0.01


def test_a_joint_of_the_world_survives_resets_edits_and_a_crash(start):
    sim = start(_world())
    sim.clock.advance(300)
    assert _hangs(sim)
    sim.resets.reset_simulation()
    sim.clock.advance(300)
    assert _hangs(sim)
    sim.models.edit("door", replace(sim.models.get("door"), name="gate"))
    sim.clock.advance(100)
    assert _hangs(sim, "gate")
    assert [joint.child for joint in sim.models.inter_model_joints] == ["gate::l"]
    pid = sim.engine_pid
    os.kill(pid, signal.SIGKILL)
    deadline = time.monotonic() + 60
    while sim.engine_pid == pid:
        assert time.monotonic() < deadline
        time.sleep(0.005)
    sim.clock.advance(100)
    assert _hangs(sim, "gate")
    sim.models.delete("post")
    assert sim.models.inter_model_joints == []
    sim.clock.advance(500)
    assert sim.states.model_state("gate")[0].position[2] < 1.5


@pytest.mark.parametrize("gone", [["post"], ["door"], ["post", "door"], ["door", "post"]])
def test_a_joint_of_the_world_comes_back_with_its_models(start, gone):
    sim = start(_world())
    joints, names = sim.models.inter_model_joints, sim.models.names()
    history = History(sim)
    for name in gone:
        history.do("delete", RemoveModel(name))
    assert sim.models.inter_model_joints == []
    for _ in gone:
        history.undo()
    assert (sim.models.inter_model_joints, sim.models.names()) == (joints, names)
    sim.clock.advance(300)
    assert _hangs(sim)
    history.redo()
    assert sim.models.inter_model_joints == []


def test_an_edit_that_takes_the_link_away_ends_the_joint(start):
    sim = start(_world())
    sim.models.edit("post", replace(sim.models.get("post"), links=[Link("other")]))
    assert sim.models.inter_model_joints == []
    sim.clock.advance(500)
    assert sim.states.model_state("door")[0].position[2] < 1.5


def test_a_sliding_joint_of_the_world_makes_its_models_articulated(start):
    world = _world()
    world.joints[0].type = "prismatic"
    world.joints[0].axis = JointAxis((1, 0, 0))
    sim = start(world)
    sim.states.set_model_state("door", sim.states.model_state("door")[0], Twist((1, 0, 0)))
    sim.clock.advance(1000)
    assert sim.states.model_state("door")[0].position == pytest.approx((1, 0, 2), abs=5e-3)


def test_a_joint_between_models_of_a_type_that_cannot_hold_is_told():
    world, issues = _world(), []
    world.joints[0].type = "screw"
    with running(world, engine=ProcessEngine, log=issues.append) as sim:
        assert [issue.code for issue in issues] == ["joint-not-held"]
        assert sim.models.inter_model_joints == []
