"""Models changed while they are in the world: what stays, what the engine gets to know."""
from __future__ import annotations

import math
from dataclasses import replace

import pytest
from conftest import arm, ball, box, inertial_of_box, slab
from test_process import kill, start  # noqa: F401

from my_simulations.description.model import Inertial, JointAxis, Link
from my_simulations.description.shapes import Box, Collision
from my_simulations.engine.commands import FOREVER
from my_simulations.engine.timed_forces import TimedEffort, TimedWrench
from my_simulations.errors import CommandError
from my_simulations.geometry import STILL, Pose, Twist, quat_from_rpy

G = 9.8


def state(sim, name):
    return sim.states.model_state(name)


def test_an_edited_model_keeps_pose_and_twist(start):
    sim = start(box())
    sim.states.set_model_state("box", Pose((1, 2, 5), quat_from_rpy(0.3, 0.2, 0.1)),
                        Twist((1, 2, 3), (0.4, 0.5, 0.6)))
    sim.clock.advance(7)
    before = state(sim, "box")
    model = sim.models.get("box")
    sim.models.edit("box", replace(model, links=[replace(model.links[0], visuals=[])]))
    pose, twist = state(sim, "box")
    assert pose.position == before[0].position
    assert pose.orientation == pytest.approx(before[0].orientation, abs=1e-15)
    assert twist == before[1]


def test_an_edited_arm_keeps_joint_position_and_rate(start):
    sim = start(arm("revolute", JointAxis((0, 1, 0))))
    sim.clock.advance(200)
    before = sim.joints.states("hinge"), sim.states.link_state("arm::bob")
    sim.models.set_link_inertial("arm::bob", replace(sim.models.get("arm").links[0].inertial,
                                                     mass=3.0))
    assert sim.joints.states("hinge")[0] == pytest.approx(before[0][0], abs=1e-12)
    assert sim.states.link_state("bob")[0].position == pytest.approx(before[1][0].position,
                                                                     abs=1e-9)


def test_a_world_bound_arm_that_was_moved_stays_there_when_edited_and_after_a_crash(start):
    sim = start(arm("revolute", JointAxis((0, 1, 0))))
    sim.states.set_model_state("arm", Pose((2, 0, 1)), STILL)
    at = sim.states.link_state("arm::bob")[0].position
    assert at == pytest.approx((2, 0, 1), abs=1e-9)
    sim.models.set_link_inertial("arm::bob", replace(sim.models.get("arm").links[0].inertial,
                                                     mass=3.0))
    assert sim.states.link_state("arm::bob")[0].position == pytest.approx(at, abs=1e-9)
    kill(sim)
    assert sim.states.link_state("arm::bob")[0].position == pytest.approx(at, abs=1e-9)


def test_a_changed_mass_reaches_the_engine(start):
    sim = start(replace(box(gravity=False), pose=Pose((0, 0, 5))))
    sim.models.set_link_inertial("box::link", inertial_of_box(4.0, 1, 1, 1))
    row = sim.models.inventory()[1][-1].first_link_row
    sim.wrenches.add([TimedWrench(0, row, 0, FOREVER, force=(8.0, 0, 0))])
    sim.clock.advance(1000)
    assert state(sim, "box")[1].linear[0] == pytest.approx(2.0, rel=1e-6)


def test_a_changed_centre_of_mass_moves_the_point_about_which_a_body_turns(start):
    sim = start(replace(box(gravity=False), pose=Pose((0, 0, 5))))
    sim.models.set_link_inertial("box::link", inertial_of_box(1.0, 1, 1, 1, Pose((0.3, 0, 0))))
    # A torque turns a free body about its centre of mass, which stays.
    row = sim.models.inventory()[1][-1].first_link_row
    sim.wrenches.add([TimedWrench(0, row, 0, 1, torque=(0, 0, 100.0))])
    sim.clock.advance(500)
    pose, _ = state(sim, "box")
    yaw = 2 * math.atan2(pose.orientation[2], pose.orientation[3])
    com = (pose.position[0] + 0.3 * math.cos(yaw), pose.position[1] + 0.3 * math.sin(yaw))
    assert abs(yaw) > 0.1
    assert com == pytest.approx((0.3, 0.0), abs=1e-3)


def test_gravity_can_be_switched_off_and_on(start):
    sim = start(replace(box(), pose=Pose((0, 0, 5))))
    sim.models.set_link_inertial("box::link", inertial_of_box(1, 1, 1, 1), gravity=False)
    sim.clock.advance(100)
    assert state(sim, "box")[0].position[2] == pytest.approx(5.0, abs=1e-12)
    sim.models.set_link_inertial("box::link", inertial_of_box(1, 1, 1, 1), gravity=True)
    sim.clock.advance(100)
    assert state(sim, "box")[1].linear[2] == pytest.approx(-G * 0.1, rel=1e-9)


def test_timed_loads_go_on_over_an_edit(start):
    sim = start(replace(box(gravity=False), pose=Pose((0, 0, 5))))
    row = sim.models.inventory()[1][-1].first_link_row
    sim.wrenches.add([TimedWrench(0, row, 0, 200, force=(1.0, 0, 0))])
    sim.clock.advance(100)
    sim.models.edit("box", replace(sim.models.get("box"), name="crate"))
    sim.clock.advance(300)
    assert state(sim, "crate")[1].linear[0] == pytest.approx(0.2, rel=1e-9)


def test_a_sleeper_falls_when_its_support_is_made_smaller(start):
    support = slab("support", (4, 4, 1))
    sim = start(replace(support, pose=Pose((0, 0, 0.5))), replace(box(), pose=Pose((0, 0, 1.5))))
    sim.clock.advance(6000)
    assert state(sim, "box")[1] == STILL
    link = sim.models.get("support").links[0]
    small = replace(link, collisions=[Collision("c", Box((4, 4, 0.2)))])
    sim.models.edit("support", replace(sim.models.get("support"), links=[small]))
    sim.clock.advance(1000)
    assert state(sim, "box")[0].position[2] < 1.2


def test_a_sleeping_pair_wakes_when_the_lower_one_is_made_static_and_stays_up(start):
    lower, upper = box("lower"), box("upper")
    sim = start(replace(lower, pose=Pose((0, 0, 0.5))), replace(upper, pose=Pose((0, 0, 1.5))))
    sim.clock.advance(6000)
    sim.models.edit("lower", replace(sim.models.get("lower"), static=True))
    sim.states.set_model_state("lower", Pose((5, 0, 0.5)), STILL)
    sim.clock.advance(1000)
    assert state(sim, "upper")[0].position[2] == pytest.approx(0.5, abs=0.01)
    assert state(sim, "lower")[0].position == pytest.approx((5, 0, 0.5), abs=1e-9)


def test_a_static_model_made_dynamic_falls(start):
    sim = start(replace(slab("s", (1, 1, 1)), pose=Pose((0, 0, 5))))
    link = replace(sim.models.get("s").links[0], inertial=inertial_of_box(1, 1, 1, 1))
    sim.models.edit("s", replace(sim.models.get("s"), static=False, links=[link]))
    sim.clock.advance(100)
    assert state(sim, "s")[1].linear[2] == pytest.approx(-G * 0.1, rel=1e-9)


def test_a_link_moved_in_its_model_moves_in_the_world(start):
    model = box()
    model.links.append(Link("top", Pose((0, 0, 1)), Inertial(), [Collision("c", Box())]))
    sim = start(replace(model, static=True, pose=Pose((3, 0, 0.5), quat_from_rpy(0, 0, 1.0))))
    links = list(sim.models.get("box").links)
    links[1] = replace(links[1], pose=Pose((1, 0, 1)))
    sim.models.edit("box", replace(sim.models.get("box"), links=links))
    assert sim.states.link_state("box::top")[0].position == pytest.approx(
        (3 + math.cos(1.0), math.sin(1.0), 1.5), abs=1e-9)


def test_a_refused_edit_changes_nothing(start):
    sim = start(box(), box("other"))
    before = state(sim, "box"), sim.models.get("box"), sim.models.revision
    with pytest.raises(CommandError, match="already"):
        sim.models.edit("box", replace(sim.models.get("box"), name="other"))
    bad = replace(sim.models.get("box"), joints=[arm("revolute", JointAxis()).joints[0]])
    with pytest.raises(CommandError, match="bob"):
        sim.models.edit("box", bad)
    assert (state(sim, "box"), sim.models.get("box"), sim.models.revision) == before


# -- joints ----------------------------------------------------------------------------------------


def test_changed_limits_stop_the_joint_there(start):
    sim = start(arm("revolute", JointAxis((0, 1, 0))))
    owner, joint, _ = sim.joints.find("hinge")
    sim.joints.edit("hinge", replace(joint, axis=replace(joint.axis, lower=-2.0, upper=0.5)))
    sim.clock.advance(3000)
    assert owner == "arm"
    assert sim.joints.states("hinge")[0][0] <= 0.5 + 1e-3


def test_damping_can_be_raised_and_taken_away_again(start):
    sim = start(arm("revolute", JointAxis((0, 0, 1)), gravity=False))
    _, joint, _ = sim.joints.find("hinge")

    def slowed(damping):
        sim.joints.edit("hinge", replace(joint, axis=replace(joint.axis, damping=damping)))
        sim.joints.set_positions({"hinge": 0.0})
        sim.states.set_model_state("arm", Pose(), STILL)
        entity = sim.models.inventory()[1][-1]
        sim.wrenches.add([TimedEffort(0, entity.first_joint_row, 0, sim.clock.step + 10,
                                      effort=10.0)])
        sim.clock.advance(10)
        first = sim.joints.states("hinge")[0][1]
        sim.clock.advance(1000)
        return sim.joints.states("hinge")[0][1] / first

    inertia = 1.0 + 1e-3
    assert slowed(1.0) == pytest.approx(math.exp(-1.0 / inertia), rel=0.02)
    assert slowed(1e4) == pytest.approx(0.0, abs=1e-6)
    assert slowed(0.0) == pytest.approx(1.0, rel=1e-6)


def set_motor(sim, name, rate, max_effort):
    _, joint, _ = sim.joints.find(name)
    axis = replace(joint.axis, motor_rate=rate, friction=max_effort)
    sim.joints.edit(name, replace(joint, axis=axis))


def test_a_motor_drives_an_axis_at_its_rate_and_lets_go(start):
    sim = start(arm("revolute", JointAxis((0, 0, 1)), gravity=False))
    set_motor(sim, "hinge", 2.0, 100.0)
    sim.clock.advance(500)
    assert sim.joints.states("hinge")[0][1] == pytest.approx(2.0, rel=1e-3)
    kill(sim)
    sim.clock.advance(100)
    assert sim.joints.states("hinge")[0][1] == pytest.approx(2.0, rel=1e-3)
    set_motor(sim, "hinge", 0.0, 0.0)
    sim.clock.advance(500)
    assert sim.joints.states("hinge")[0][1] == pytest.approx(2.0, rel=1e-3)


def test_a_motor_takes_no_more_effort_than_it_may(start):
    sim = start(arm("revolute", JointAxis((0, 0, 1)), gravity=False))
    set_motor(sim, "hinge", 100.0, 0.5)
    sim.clock.advance(1000)
    assert sim.joints.states("hinge")[0][1] == pytest.approx(0.5 / (1.0 + 1e-3), rel=0.02)


# -- holding, contacts, time -----------------------------------------------------------------------


def test_a_held_body_stays_where_it_is_put_until_it_is_let_go(start):
    sim = start(replace(box(), pose=Pose((0, 0, 5))))
    sim.models.pin(["box"])
    sim.clock.advance(300)
    assert state(sim, "box")[0].position == pytest.approx((0, 0, 5), abs=1e-9)
    sim.states.set_model_state("box", Pose((1, 0, 6)), STILL)
    sim.clock.advance(300)
    assert state(sim, "box")[0].position == pytest.approx((1, 0, 6), abs=1e-9)
    kill(sim)
    sim.clock.advance(100)
    assert state(sim, "box")[0].position == pytest.approx((1, 0, 6), abs=1e-9)
    sim.models.pin([])
    sim.clock.advance(100)
    assert state(sim, "box")[1].linear[2] == pytest.approx(-G * 0.1, rel=1e-6)


def test_a_held_body_pushes_others_aside(start):
    sim = start(replace(box("hand"), pose=Pose((-2, 0, 0.5))),
                replace(ball(), pose=Pose((0, 0, 0.5))))
    sim.models.pin(["hand"])
    for n in range(100):
        sim.states.set_model_state("hand", Pose((-2 + 0.02 * n, 0, 0.5)), STILL)
        sim.clock.advance(40)
    assert state(sim, "ball")[0].position[0] > 0.5


def test_contacts_name_both_links_and_carry_the_weight(start):
    sim = start(replace(box(), pose=Pose((0, 0, 0.5))))
    sim.clock.advance(500)
    found = sim.states.contacts()
    assert {frozenset((a, b)) for a, b, _ in found} == {frozenset(("box::link", "ground::link"))}
    assert sum(contact.force for _, _, contact in found) == pytest.approx(G, rel=0.01)
    for a, _, contact in found:
        assert contact.normal[2] == pytest.approx(1.0 if a == "box::link" else -1.0, abs=1e-6)


def test_time_can_be_reset_alone(start):
    sim = start(replace(box(gravity=False), pose=Pose((0, 0, 5))))
    row = sim.models.inventory()[1][-1].first_link_row
    sim.wrenches.add([TimedWrench(0, row, 0, 300, force=(1.0, 0, 0))])
    sim.clock.advance(100)
    before = state(sim, "box")
    sim.resets.reset_time()
    assert (sim.clock.step, sim.clock.sim_ns, state(sim, "box")) == (0, 0, before)
    sim.clock.advance(1000)
    assert state(sim, "box")[1].linear[0] == pytest.approx(0.3, rel=1e-9)
