"""Articulated bodies against closed forms."""
from __future__ import annotations

import math

import pytest
from closed_forms import pendulum
from conftest import Lab, arm, box, inertial_of_box

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Mimic, Model
from my_simulations.engine.api import CommandRefusedError
from my_simulations.engine.commands import (
    FOREVER,
    LinkState,
    ModelState,
    SetJoints,
    SetLinkState,
    SetModelState,
)
from my_simulations.engine.timed_forces import AddTimedForces, TimedEffort, TimedWrench
from my_simulations.geometry import (
    IDENTITY,
    Pose,
    Twist,
    compose,
    quat_from_rpy,
    transform,
)

Y = (0.0, 1.0, 0.0)


def test_the_link_follows_the_joint(lab: Lab):
    model = lab.load(arm("revolute", JointAxis(Y)), (1, 2, 3), quat_from_rpy(0, 0, 0.5))
    lab.apply(SetJoints(((lab.joint_rows[model, "hinge"], 0.3, 0.0),)))
    lab.backend.read()
    expected = compose(Pose((1, 2, 3), quat_from_rpy(0, 0, 0.5)),
                       Pose((0, 0, 0), quat_from_rpy(0, 0.3, 0)))
    assert lab.pose(model, "bob").position == pytest.approx(expected.position, abs=1e-12)
    assert lab.pose(model, "bob").orientation == pytest.approx(expected.orientation, abs=1e-12)


@pytest.mark.parametrize("damping", [0.05, 5.0, 2000.0, 1e5])
def test_joint_damping_decays_exponentially_and_never_diverges(lab: Lab, damping: float):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    model = lab.load(arm("revolute", JointAxis(Y, damping=damping), mass=1.0, moment=0.0 + 1e-6))
    lab.apply(SetJoints(((lab.joint_rows[model, "hinge"], 0.0, 1.0),)))
    lab.steps(100)
    assert lab.joint(model)[1] == pytest.approx(math.exp(-0.1 * damping), rel=0.02, abs=1e-6)


def test_a_spring_swings_with_its_own_period(lab: Lab):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    model = lab.load(arm("prismatic", JointAxis((1, 0, 0), spring_stiffness=40.0), mass=10.0))
    lab.apply(SetJoints(((lab.joint_rows[model, "hinge"], 0.1, 0.0),)))
    lab.steps(round(1000 * math.pi))  # half a period: 2 pi sqrt(10 / 40) / 2 = pi / 2 twice
    assert lab.joint(model)[0] == pytest.approx(0.1, abs=2e-3)


def test_joint_rates_are_not_clamped(lab: Lab):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    model = lab.load(arm("revolute", JointAxis((0, 0, 1))))
    lab.apply(SetJoints(((lab.joint_rows[model, "hinge"], 0.0, 250.0),)))
    lab.steps(100)
    assert lab.joint(model)[1] == pytest.approx(250.0, rel=1e-3)


def test_joint_friction_holds_up_to_its_torque(lab: Lab):
    holding = lab.load(arm("revolute", JointAxis(Y, friction=12.0)))   # weight 9.8 N m
    slipping = lab.load(arm("revolute", JointAxis(Y, friction=8.0)), (0, 5, 0))
    lab.seconds(0.5)
    assert lab.joint(holding)[0] == pytest.approx(0.0, abs=1e-6)
    assert lab.joint(slipping)[0] > 0.1


def test_a_joint_effort_accelerates_by_torque_over_inertia_for_its_steps(lab: Lab):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    model = lab.load(arm("revolute", JointAxis((0, 0, 1)), mass=2.0, moment=0.5))
    row = lab.joint_rows[model, "hinge"]
    lab.apply(AddTimedForces((TimedEffort(1, row, 100, 200, effort=3.0), TimedEffort(2, row, 150,
                                                                                     200,
                                                                                     effort=2.0))))
    lab.steps(100)
    assert lab.joint(model)[1] == 0.0
    lab.steps(500)
    assert lab.joint(model)[1] == pytest.approx((3.0 * 0.1 + 2.0 * 0.05) / 2.5, rel=1e-6)


def test_wrenches_add_up_and_act_exactly_in_their_steps(lab: Lab):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    model = lab.load(box(mass=2.0))
    row = lab.rows[model, "link"]
    lab.apply(AddTimedForces((TimedWrench(1, row, 10, 20, force=(4, 0, 0)),
                        TimedWrench(2, row, 15, 20, force=(4, 0, 0)),
                        TimedWrench(3, row, 10, 11, torque=(0, 0, 1)))))
    lab.steps(10)
    assert lab.twist(model) == Twist()
    lab.steps(50)
    assert lab.twist(model).linear == pytest.approx((15 * 4 * 1e-3 / 2, 0, 0), abs=1e-12)
    assert lab.twist(model).angular == pytest.approx((0, 0, 1e-3 / (2 / 6)), abs=1e-9)


@pytest.mark.parametrize("jointed", [False, True])
def test_wrenches_are_in_world_axes_or_in_link_axes_as_asked(lab: Lab, jointed: bool):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    turned = quat_from_rpy(0, 0, math.pi / 2)
    inertial = inertial_of_box(1.0, 1, 1, 1, Pose((0, 0, 0), quat_from_rpy(0.3, 0, 0)))
    model = Model("m", links=[Link("link", inertial=inertial)])
    if jointed:
        model.links.append(Link("tip", Pose((0, 0, 3)), inertial_of_box(1e-6, .1, .1, .1)))
        model.joints.append(Joint("hinge", "revolute", "link", "tip", axis=JointAxis()))
    for in_link_axes, expected in ((False, (1, 0, 0)), (True, (0, 1, 0))):
        one = lab.load(model, (20.0 * in_link_axes, 0, 0), turned)
        lab.apply(AddTimedForces((TimedWrench(one, lab.rows[one, "link"], lab.step, lab.step + 1,
                                 force=(1000, 0, 0), torque=(100, 0, 0),
                                 in_link_axes=in_link_axes),)))
        lab.steps(1)
        assert lab.twist(one).linear == pytest.approx(expected, abs=1e-3)
        assert lab.twist(one).angular == pytest.approx([0.6 * v for v in expected], abs=1e-3)


def test_a_force_off_the_centre_turns_the_body(lab: Lab):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    model = lab.load(box())
    lab.apply(AddTimedForces((TimedWrench(1, lab.rows[model, "link"], 0, 1, force=(0, 10, 0),
                             point=(0.5, 0, 0)),)))
    lab.steps(1)
    assert lab.twist(model).angular == pytest.approx((0, 0, 5e-3 * 6), abs=1e-9)


def test_a_torque_right_after_a_turn_meets_the_inertia_of_the_new_attitude(lab: Lab):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    rod = Model("rod", links=[Link("link", inertial=Inertial(1, Pose(), 1.0, 0, 0, 2.0, 0, 4.0))])
    model = lab.load(rod)
    lab.steps(5)
    lab.apply(SetModelState(model, Pose((0, 0, 0), quat_from_rpy(math.pi / 2, 0, 0)), Twist()))
    lab.apply(
        AddTimedForces((TimedWrench(1, lab.rows[model, "link"], 5, 6, torque=(0, 0, 100.0)),))
    )
    lab.steps(1)
    assert lab.twist(model).angular == pytest.approx((0, 0, 0.1 / 2.0), abs=1e-9)


def _chain(count: int) -> Model:
    inertial = inertial_of_box(0.1, 0.1, 0.1, 0.1)
    return Model("chain", links=[Link(f"l{n}", Pose((0.2 * n, 0, 0)), inertial)
                                 for n in range(count)],
                 joints=[Joint(f"j{n}", "revolute", f"l{n}", f"l{n + 1}",
                               axis=JointAxis((0, 0, 1))) for n in range(count - 1)])


def test_a_chain_of_128_links_keeps_them_all(lab: Lab):
    model = lab.load(_chain(128))
    lab.steps(10)
    assert lab.pose(model, "l127").position[0] == pytest.approx(0.2 * 127, abs=1e-6)


def test_a_longer_chain_is_refused_and_leaves_nothing_behind(lab: Lab):
    import pybullet
    before = pybullet.getNumBodies()
    with pytest.raises(CommandRefusedError, match="129"):
        lab.load(_chain(129))
    assert pybullet.getNumBodies() == before


def test_joint_frames_and_reversed_joints_keep_the_initial_poses(lab: Lab):
    inertial = inertial_of_box(1.0, 0.3, 0.2, 0.1, Pose((0.05, 0, 0), quat_from_rpy(0.1, 0, 0)))
    links = [Link("a", Pose((0, 0, 1), quat_from_rpy(0.2, 0, 0)), inertial),
             Link("b", Pose((1, 0, 1), quat_from_rpy(0, 0.3, 0)), inertial),
             Link("c", Pose((1, 1, 1), quat_from_rpy(0, 0, 0.4)), inertial)]
    joints = [Joint("ab", "revolute", "a", "b", Pose((-0.2, 0.1, 0), quat_from_rpy(0, 0.5, 0)),
                    JointAxis((0, 0, 1))),
              Joint("cb", "prismatic", "c", "b", Pose((0, 0.3, 0)), JointAxis((1, 0, 0)))]
    lab.configure(gravity=(0.0, 0.0, 0.0))
    model = lab.load(Model("m", links=links, joints=joints), (5, 0, 0))
    for link in links:
        expected = compose(Pose((5, 0, 0)), link.pose)
        assert lab.pose(model, link.name).position == pytest.approx(expected.position, abs=1e-9)
        assert lab.pose(model, link.name).orientation == pytest.approx(expected.orientation,
                                                                       abs=1e-9)
    before = compose(Pose((5, 0, 0)), links[2].pose)
    lab.apply(SetJoints(((lab.joint_rows[model, "cb"], 0.25, 0.0),)))
    lab.backend.read()
    # b moves by +0.25 along its joint axis as seen from c; with a as root, c moves the other way.
    axis_end = transform(compose(Pose((5, 0, 0)), links[1].pose), (0.25, 0.3, 0))
    axis_start = transform(compose(Pose((5, 0, 0)), links[1].pose), (0, 0.3, 0))
    moved = [b - (e - s) for b, e, s in zip(before.position, axis_end, axis_start)]
    assert lab.pose(model, "c").position == pytest.approx(moved, abs=1e-9)


def hinged_pair(lab: Lab):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    inertial = inertial_of_box(1.0, 0.2, 0.2, 0.2)
    return lab.load(Model("m", links=[Link("a", inertial=inertial),
                                      Link("b", Pose((1, 0, 0)), inertial)],
                          joints=[Joint("hinge", "revolute", "a", "b", axis=JointAxis())]))


def test_a_model_moves_rigidly_and_joints_keep_their_positions(lab: Lab):
    model = hinged_pair(lab)
    lab.apply(SetJoints(((lab.joint_rows[model, "hinge"], 0.7, 2.0),)))
    lab.apply(SetModelState(model, Pose((0, 5, 0), quat_from_rpy(0, 0, 1)),
                            Twist((1, 0, 0), (0, 0, 2))))
    lab.backend.read()
    assert lab.joint(model) == pytest.approx((0.7, 0.0), abs=1e-12)
    tip = compose(Pose((0, 5, 0), quat_from_rpy(0, 0, 1)), Pose((1, 0, 0), quat_from_rpy(0, 0, .7)))
    assert lab.pose(model, "b").position == pytest.approx(tip.position, abs=1e-9)
    lever = (tip.position[0], tip.position[1] - 5)
    assert lab.twist(model, "b").linear == pytest.approx((1 - 2 * lever[1], 2 * lever[0], 0),
                                                         abs=1e-9)


def test_setting_a_link_takes_its_articulated_body_along(lab: Lab):
    model = hinged_pair(lab)
    lab.apply(SetLinkState(lab.rows[model, "b"], Pose((3, 0, 0)), Twist((0, 1, 0))))
    lab.backend.read()
    assert lab.pose(model, "b").position == pytest.approx((3, 0, 0), abs=1e-9)
    assert lab.pose(model, "a").position == pytest.approx((2, 0, 0), abs=1e-9)
    assert lab.twist(model, "a").linear == pytest.approx((0, 1, 0), abs=1e-9)


def test_a_link_joined_to_the_world_cannot_be_set(lab: Lab):
    model = lab.load(arm("revolute", JointAxis(Y)))
    with pytest.raises(CommandRefusedError, match="joined to the world"):
        lab.apply(SetLinkState(lab.rows[model, "bob"], IDENTITY))


def test_a_state_is_restored_whole(lab: Lab):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    inertial = inertial_of_box(1.0, 0.2, 0.2, 0.2, Pose((0.1, 0, 0)))
    model = Model("m", links=[Link("a", inertial=inertial), Link("b", Pose((1, 0, 0)), inertial)],
                  joints=[Joint("hinge", "revolute", "a", "b", axis=JointAxis())])
    first = lab.load(model)
    lab.apply(SetModelState(first, Pose((1, 2, 3), quat_from_rpy(.1, .2, .3)),
                            Twist((1, 0, 0), (.1, .2, .3))))
    lab.apply(SetJoints(((lab.joint_rows[first, "hinge"], 0.7, 2.0),)))
    lab.steps(37)
    state = ModelState(tuple(LinkState(lab.pose(first, n), lab.twist(first, n)) for n in "ab"),
                       (lab.joint(first),))
    lab.remove(first)
    second = lab.load(model, state=state)
    for n, link in enumerate("ab"):
        assert lab.pose(second, link).position == pytest.approx(state.links[n].pose.position,
                                                                abs=1e-9)
        assert lab.twist(second, link).linear == pytest.approx(state.links[n].twist.linear,
                                                               abs=1e-9)
    assert lab.joint(second) == pytest.approx(state.joints[0], abs=1e-12)


def test_loads_end_with_their_model(lab: Lab):
    model = lab.load(box())
    lab.apply(
        AddTimedForces((TimedWrench(1, lab.rows[model, "link"], 0, FOREVER, force=(1, 0, 0)),))
    )
    lab.remove(model)
    assert not lab.backend._helpers.forces._timed
    lab.steps(5)


def _pair(kind: str, second: Pose, **changes: object) -> Model:
    """`base` joined to the world by nothing that moves, `tip` hanging on a joint of a kind."""
    inertial = inertial_of_box(1.0, 0.2, 0.2, 0.2)
    return Model("pair", links=[Link("base", inertial=inertial), Link("tip", second, inertial)],
                 joints=[Joint("fix", "fixed", "world", "base"),
                         Joint("hinge", kind, "base", "tip", **changes)])


def test_a_ball_joint_swings_as_a_pendulum_in_any_direction(lab: Lab):
    inertial = Inertial(1.0, Pose((1, 0, 0)), 1e-3, 0, 0, 1e-3, 0, 1e-3)
    model = lab.load(Model("m", links=[Link("bob", inertial=inertial)],
                           joints=[Joint("socket", "ball", "world", "bob")]),
                     (0, 0, 0), quat_from_rpy(0, 0, 0.7))
    lab.seconds(1)
    angle, _ = pendulum(0.0, 0.0, 1.001, 9.8, 0.0, 1.0)
    x, y, z = transform(lab.pose(model, "bob"), (1, 0, 0))
    flat = math.cos(angle)
    assert (x, y, z) == pytest.approx(
        (flat * math.cos(0.7), flat * math.sin(0.7), -math.sin(angle)), abs=5e-3)


@pytest.mark.parametrize("kind", ["universal", "revolute2"])
def test_two_axes_turn_about_the_parents_and_the_childs_axis(lab: Lab, kind: str):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    model = lab.load(_pair(kind, Pose((1, 0, 0)), axis=JointAxis((0, 0, 1)), axis2=JointAxis(Y)))
    lab.apply(SetJoints(((lab.joint_rows[model, "hinge"], 0.4, 0.0),
                         (lab.joint_rows[model, "hinge::1"], 0.3, 0.0))))
    lab.steps(1)
    turned = compose(Pose((1, 0, 0), quat_from_rpy(0, 0, 0.4)),
                     Pose((0, 0, 0), quat_from_rpy(0, 0.3, 0)))
    assert lab.pose(model, "tip").position == pytest.approx((1, 0, 0), abs=1e-6)
    assert lab.pose(model, "tip").orientation == pytest.approx(turned.orientation, abs=1e-6)
    assert lab.joint(model, "hinge::1")[0] == pytest.approx(0.3, abs=1e-6)


def test_a_screw_turns_thread_pitch_radians_a_metre_left_handed(lab: Lab):
    model = lab.load(_pair("screw", Pose((0, 0, 1)), axis=JointAxis((0, 0, 1)), thread_pitch=20.0))
    lab.seconds(1)
    z = lab.pose(model, "tip").position[2] - 1.0
    assert z < -0.1
    assert lab.joint(model)[0] == pytest.approx(-20.0 * z, rel=1e-2)
    # All of the weight's work turns the nut: m g z = (m + I p^2) v^2 / 2.
    inertia = 1.0 + (0.08 / 12) * 400
    assert abs(z) == pytest.approx(0.5 * 9.8 / inertia, rel=0.03)


def _drive_coupled(lab: Lab, kind: str, effort: float, axis: JointAxis, *more: Joint) -> int:
    """Drive joint `ja` for 0.5 of 1 s; joint `jb` beside it has the axis `axis`."""
    lab.configure(gravity=(0.0, 0.0, 0.0))
    inertial = inertial_of_box(1.0, 0.2, 0.2, 0.2)
    links = [Link(name, Pose((n, 0, 0)), inertial) for n, name in enumerate(("frame", "a", "b"))]
    joints = [Joint("fix", "fixed", "world", "frame"),
              Joint("ja", kind, "frame", "a", axis=JointAxis()),
              Joint("jb", kind, "frame", "b", axis=axis), *more]
    model = lab.load(Model("coupled", links=links, joints=joints))
    lab.apply(AddTimedForces((TimedEffort(1, lab.joint_rows[model, "ja"], 0, 500, effort=effort),)))
    lab.seconds(1)
    return model


def test_a_gearbox_turns_the_other_wheel_the_other_way_by_its_ratio(lab: Lab):
    model = _drive_coupled(lab, "revolute", 0.05, JointAxis(),
                           Joint("box", "gearbox", "a", "b", gearbox_ratio=3.0,
                                 gearbox_reference="frame", axis=JointAxis(), axis2=JointAxis()))
    assert lab.joint(model, "ja")[0] > 0.1
    assert lab.joint(model, "jb")[0] == pytest.approx(-3.0 * lab.joint(model, "ja")[0], rel=1e-2)


def test_a_mimic_axis_follows_with_multiplier_and_offset(lab: Lab):
    model = _drive_coupled(lab, "prismatic", 2.0, JointAxis(mimic=Mimic("ja", -2.0, 0.1)))
    leader = lab.joint(model, "ja")[0]
    assert leader > 0.05
    assert lab.joint(model, "jb")[0] == pytest.approx(-2.0 * leader + 0.1, abs=5e-3)


def test_a_four_bar_loop_stays_closed(lab: Lab):
    bar = inertial_of_box(1.0, 1.0, 0.1, 0.1, Pose((0.5, 0, 0)))
    links = [Link("left", Pose((0, 0, 0), quat_from_rpy(0, -math.pi / 2, 0)), bar),
             Link("top", Pose((0, 0, 1)), bar),
             Link("right", Pose((1, 0, 0), quat_from_rpy(0, -math.pi / 2, 0)), bar)]
    joints = [Joint("a", "revolute", "world", "left", axis=JointAxis(Y)),
              Joint("b", "revolute", "left", "top", axis=JointAxis(Y)),
              Joint("c", "revolute", "world", "right", axis=JointAxis(Y)),
              Joint("d", "revolute", "right", "top", Pose((1, 0, 0)), axis=JointAxis(Y))]
    model = lab.load(Model("bars", links=links, joints=joints), (0, 0, 2))
    lab.apply(SetJoints(((lab.joint_rows[model, "a"], 0.0, 1.0),)))
    for _ in range(60):
        lab.steps(50)
        end_of_top = transform(lab.pose(model, "top"), (1, 0, 0))
        end_of_right = transform(lab.pose(model, "right"), (1, 0, 0))
        assert end_of_top == pytest.approx(end_of_right, abs=5e-3)
    assert lab.pose(model, "top").position[2] < 2.9   # it has fallen over


def test_a_ball_joint_is_restored_with_its_turn_and_spin(lab: Lab):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    inertial = inertial_of_box(1.0, 0.4, 0.3, 0.2, Pose((0.2, 0, 0), quat_from_rpy(0.2, 0.1, 0)))
    model = Model("m", links=[Link("a", Pose((0, 0, 0), quat_from_rpy(0, 0, 0.6)), inertial),
                              Link("b", Pose((1, 0, 0)), inertial)],
                  joints=[Joint("socket", "ball", "a", "b",
                                Pose((-0.3, 0, 0), quat_from_rpy(0.3, 0, 0)))])
    first = lab.load(model, (0, 0, 3))
    lab.apply(
        AddTimedForces((TimedWrench(1, lab.rows[first, "b"], 0, 100, torque=(0.3, 0.2, 0.5)),))
    )
    lab.steps(300)
    state = ModelState(tuple(LinkState(lab.pose(first, n), lab.twist(first, n)) for n in "ab"))
    assert max(map(abs, state.links[1].twist.angular)) > 0.3
    lab.remove(first)
    second = lab.load(model, (0, 0, 3), state=state)
    for n, link in enumerate("ab"):
        for was, now in ((state.links[n].pose.position, lab.pose(second, link).position),
                         (state.links[n].pose.orientation, lab.pose(second, link).orientation),
                         (state.links[n].twist.linear, lab.twist(second, link).linear),
                         (state.links[n].twist.angular, lab.twist(second, link).angular)):
            sign = -1 if len(was) == 4 and was[3] * now[3] < 0 else 1   # q and -q turn alike
            assert [sign * v for v in now] == pytest.approx(was, abs=1e-6)


def test_efforts_stay_within_the_limits_of_their_axis(lab: Lab):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    weak = lab.load(arm("revolute", JointAxis((0, 0, 1), effort=1.0)))
    slow = lab.load(arm("revolute", JointAxis((0, 0, 1), velocity=0.5)), (5, 0, 0))
    lab.apply(AddTimedForces(tuple(TimedEffort(n, lab.joint_rows[model, "hinge"], 0, FOREVER,
                                               effort=10.0) for n, model in enumerate((weak,
                                                                                       slow)))))
    lab.steps(200)
    assert lab.joint(weak)[1] == pytest.approx(0.2 / 1.001, rel=1e-3)
    assert 0.5 < lab.joint(slow)[1] < 0.52


@pytest.mark.parametrize("dt", [0.001, 0.004])
def test_velocity_decay_of_an_articulated_link_takes_its_share_off_in_every_step(lab: Lab,
                                                                                dt: float):
    lab.configure(gravity=(0.0, 0.0, 0.0), step_size=dt)
    model = arm("revolute", JointAxis((0, 0, 1)), mass=2.0, moment=0.5)
    model.links[0].linear_decay, model.links[0].angular_decay = 0.01, 0.005
    swinging = lab.load(model)
    lab.apply(SetJoints(((lab.joint_rows[swinging, "hinge"], 0.0, 1.0),)))
    lab.steps(100)
    # Of I = m l^2 + I_c = 2.5 each share slows its part.
    share = (0.01 * 2.0 + 0.005 * 0.5) / 2.5
    assert lab.joint(swinging)[1] == pytest.approx((1 - share) ** 100, rel=1e-4)


def test_velocity_decay_slows_a_free_articulated_body_as_a_rigid_one(lab: Lab):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    inertial = Inertial(1.0, Pose((0.2, 0, 0), quat_from_rpy(0.3, 0.2, 0.1)),
                        0.1, 0, 0, 0.1, 0, 0.1)
    links = [Link(name, inertial=inertial, linear_decay=0.01, angular_decay=0.005)
             for name in ("link", "tip")]
    jointed = lab.load(Model("m", links=links, joints=[Joint("j", "fixed", "link", "tip")]))
    lab.push(jointed, (3, -2, 1))
    lab.steps(100)
    assert lab.twist(jointed).linear == pytest.approx([v * 0.99 ** 100 for v in (3, -2, 1)],
                                                      rel=1e-4)
    lab.remove(jointed)
    assert not lab.backend._helpers._decay._links


@pytest.mark.filterwarnings("ignore:overflow")
def test_a_spring_works_again_after_an_effort_beyond_all_numbers(lab: Lab):
    axis = JointAxis((0, 0, 1), spring_stiffness=0.05, damping=0.02)
    model = lab.load(arm("prismatic", axis, mass=1e-3, moment=1e-6))
    row = lab.joint_rows[model, "hinge"]
    lab.apply(AddTimedForces((TimedEffort(1, row, 10, 20, effort=1e308),)))
    lab.steps(30)
    assert abs(lab.joint(model)[0]) > 1e3
    lab.apply(SetJoints(((row, 0.0, 0.0),)))
    lab.seconds(5)
    assert lab.joint(model)[0] == pytest.approx(-9.8e-3 / 0.05, rel=0.02)
