"""Plugins that set the state of a robot, in a world without physics."""
from __future__ import annotations

import math

import pytest

from my_simulations.description.model import Inertial
from my_simulations.geometry import Pose, Twist, quat_from_rpy
from my_simulations.plugins.context import PluginError
from my_simulations.plugins.state.gimbal import Gimbal
from my_simulations.plugins.state.hand_of_god import HandOfGod
from my_simulations.plugins.state.joint_pose_trajectory import JointPoseTrajectory
from my_simulations.plugins.state.joint_springs import Differential, MimicJoint, WarthogSuspension
from my_simulations.plugins.state.random_velocity import InitialVelocity, RandomVelocity
from my_simulations.plugins.state.world_odometry import (
    PalWorldOdometry,
    RobotnikGroundTruthOdometry,
)
from my_simulations.plugins.testing import FakeContext, Message
from my_simulations.plugins.transforms import Transforms

STILL_FRAME = {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}


def stamp(seconds):
    return {"secs": int(seconds), "nsecs": round((seconds - int(seconds)) * 1e9)}


def point(seconds, *positions):
    return Message(positions=list(positions), time_from_start=stamp(seconds))


def play(context, *points, frame="world", names=("a", "b"), at=0.0):
    context.deliver("set_joint_trajectory", header=Message(frame_id=frame, stamp=stamp(at)),
                 joint_names=list(names), points=list(points))


@pytest.fixture
def arm():
    context = FakeContext(joints=("a", "b"))
    JointPoseTrajectory(context).load()
    return context


def positions(context):
    return [context.joints[name].position for name in "ab"]


def test_points_are_set_at_their_times_from_the_start(arm):
    play(arm, point(0.0, 0.1, 0.2), point(0.5, 0.3, 0.4), point(0.7, 0.5, 0.6), at=1.0)
    arm.advance(0.999)
    assert positions(arm) == [0.0, 0.0]
    arm.advance(0.001)
    assert positions(arm) == [0.1, 0.2] and arm.held
    arm.advance(0.499)
    assert positions(arm) == [0.1, 0.2]
    arm.advance(0.001)
    assert positions(arm) == [0.3, 0.4]
    arm.advance(0.2)
    assert positions(arm) == [0.5, 0.6] and not arm.held
    assert arm.joints["a"].motor == (0.0, 0.0)


def test_another_trajectory_replaces_the_rest_of_the_first(arm):
    play(arm, point(0.0, 0.1, 0.1), point(0.5, 0.9, 0.9))
    arm.advance(0.2)
    play(arm, point(0.1, 0.2, 0.2))
    arm.advance(1.0)
    assert positions(arm) == [0.2, 0.2]


def test_joints_that_are_not_there_are_told_and_skipped(arm):
    play(arm, point(0.0, 7.0, 0.2), names=("c", "b"))
    assert positions(arm) == [0.0, 0.2]
    assert "no joint 'c'" in arm.log_messages[0]


def test_a_point_of_another_length_is_refused_whole(arm):
    play(arm, point(0.0, 0.1, 0.1), point(0.1, 0.1))
    assert positions(arm) == [0.0, 0.0] and "point 1 of the trajectory has 1" in arm.log_messages[0]


def test_the_service_answers_and_sets_the_pose(arm):
    response = Message()
    request = Message(model_name="robot", set_model_pose=True, disable_physics_updates=False,
                      model_pose={"position": {"x": 1.0, "y": 2.0, "z": 3.0},
                                  "orientation": STILL_FRAME},
                      joint_trajectory=Message(
                          header=Message(frame_id="map", stamp=stamp(0.0)),
                          joint_names=["a"], points=[point(0.0, 0.4)]))
    arm.services["set_joint_trajectory"](request, response)
    assert response.success and arm.pose.position == (1.0, 2.0, 3.0)
    assert arm.joints["a"].position == 0.4 and not arm.held
    request.model_name = "other"
    arm.services["set_joint_trajectory"](request, response)
    assert not response.success and "this is model 'robot'" in response.status_message


def test_the_link_of_the_frame_stays_where_it_is():
    context = FakeContext(joints=("a", "b"), links=("tip",))
    JointPoseTrajectory(context).load()
    tip = context.links["tip"]

    def turned(values, before=context.set_joint_positions):
        before(values)
        tip.pose = Pose((0.0, 0.0, 0.5), quat_from_rpy(0, 0, math.pi / 2))

    context.set_joint_positions = turned
    tip.pose = Pose((1.0, 0.0, 0.5))
    play(context, point(0.0, 0.1, 0.2), frame="tip")
    assert context.pose.position == pytest.approx((1.0, 0.0, 0.0))
    assert context.pose.orientation == pytest.approx(quat_from_rpy(0, 0, -math.pi / 2))


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_a_trajectory_with_what_is_no_number_is_refused_and_the_next_is_played(arm, value):
    play(arm, point(0.0, 0.1, 0.2), point(0.5, value, 0.4))
    assert arm.log_messages == ["a position of point 1 of the trajectory is not finite"]
    request = Message(model_name="robot", set_model_pose=True, disable_physics_updates=True,
                      model_pose={"position": {"x": value, "y": 0.0, "z": 0.0},
                                  "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}})
    response = Message()
    arm.services["set_joint_trajectory"](request, response)
    assert not response.success and "pose of the model" in response.status_message
    play(arm, point(0.0, 0.3, 0.4))
    assert positions(arm) == [0.3, 0.4]


def test_points_without_times_are_played_one_a_step(arm):
    """As many as there are; the original looks at one in each update."""
    play(arm, *(point(0.0, 0.001 * n, 0.0) for n in range(3000)))
    assert positions(arm)[0] == 0.0
    arm.advance(1.5)
    assert positions(arm)[0] == pytest.approx(1.5) and arm.held
    arm.advance(1.5)
    assert positions(arm)[0] == pytest.approx(2.999) and not arm.held


def test_a_reset_ends_it(arm):
    plugin = arm.load(JointPoseTrajectory)
    play(arm, point(0.0, 0.1, 0.1), point(0.5, 0.9, 0.9))
    plugin.reset()
    arm.advance(1.0)
    assert positions(arm) == [0.1, 0.1] and not arm.held


def transform(parent, child, x=0.0, yaw=0.0):
    qx, qy, qz, qw = quat_from_rpy(0.0, 0.0, yaw)
    return Message(header=Message(frame_id=parent), child_frame_id=child, transform={
        "translation": {"x": x, "y": 0.0, "z": 0.0},
        "rotation": {"x": qx, "y": qy, "z": qz, "w": qw}})


@pytest.mark.parametrize("spoilt", [
    transform("world", "hand", math.nan), transform("hand", "hand", 2.0),
    Message(header=Message(frame_id="world"), child_frame_id="hand", transform={
        "translation": {"x": 3.0, "y": 0.0, "z": 0.0},
        "rotation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 0.0}})])
def test_transforms_that_tf2_ignores_change_nothing(spoilt):
    context = FakeContext()
    heard = Transforms(context)
    for one in (transform("world", "hand", 1.0), spoilt):
        context.deliver("/tf", transforms=[one])
    assert heard.look_up("world", "hand").position == (1.0, 0.0, 0.0)


def test_the_hand_of_god_pulls_like_a_critically_damped_spring():
    context = FakeContext("<plugin><linkName>hand</linkName><kl>50</kl><ka>8</ka></plugin>",
                          links=("hand",))
    hand = context.links["hand"]
    hand.inertial = Inertial(mass=2.0, ixx=0.5)
    hand.twist = Twist((0.1, 0.0, 0.0), (0.0, 0.0, 0.2))
    HandOfGod(context).load()
    context.advance(0.002)
    assert len(context.log_messages) == 1
    assert context.wrenches["hand"] == (pytest.approx((0.0, 0.0, 2 * 9.8)), (0.0, 0.0, 0.0))
    context.deliver("/tf", transforms=[transform("base", "hog_desired", 0.5, 0.4),
                                    transform("/world", "base", 1.0)])
    context.advance(0.001)
    force, torque = context.wrenches["hand"]
    assert force == pytest.approx((50 * 1.5 - 2 * math.sqrt(100.0) * 0.1, 0.0, 2 * 9.8))
    assert torque == pytest.approx((0.0, 0.0, 8 * 0.2 - 2 * math.sqrt(4.0) * 0.2))
    assert context.transforms[-1][:2] == ("world", "hog_actual")
    context.gravity = (0.0, 0.0, -1.6)
    context.change_world()
    assert context.wrenches["hand"][0][2] == pytest.approx(2 * 1.6)
    assert context.stops == 0   # the engine computes the springs


def test_a_mimic_joint_is_coupled_with_the_defaults_of_the_original():
    context = FakeContext("<plugin><joint>a</joint><mimicJoint>b</mimicJoint><hasPID/></plugin>",
                          joints=("a", "b"))
    MimicJoint(context).load()
    assert context.followers == {"b": ("a", 1.0, 0.0)}
    with pytest.raises(PluginError, match="mimicJoint"):
        MimicJoint(FakeContext("<plugin><joint>a</joint></plugin>", joints=("a",))).load()


def test_an_initial_velocity_comes_back_with_a_reset():
    context = FakeContext("<plugin><linear>1 2 3</linear><angular>0 0 1</angular></plugin>")
    plugin = context.load(InitialVelocity)
    context.twist = Twist((0.0,) * 3, (0.0,) * 3)
    plugin.reset()
    assert context.twist == Twist((1.0, 2.0, 3.0), (0.0, 0.0, 1.0))


def wander(xml, seed=0):
    context = FakeContext(f"<plugin><link>l</link>{xml}</plugin>", links=("l",))
    context.seed = seed
    return context, context.load(RandomVelocity)


def test_a_random_velocity_begins_with_the_initial_one_and_changes_after_each_period():
    context, plugin = wander("<initial_velocity>0 0.5 0</initial_velocity>"
                             "<velocity_factor>2</velocity_factor><update_period>1</update_period>")
    context.twist = Twist((9.0, 9.0, 9.0), (0.0, 0.0, 3.0))
    context.advance(1.0)
    assert context.twist == Twist((0.0, 0.5, 0.0), (0.0, 0.0, 3.0))
    context.advance(0.5)
    first = context.twist.linear
    assert math.dist(first, (0.0, 0.0, 0.0)) == pytest.approx(2.0)
    context.advance(1.0)
    second = context.twist.linear
    assert math.dist(second, (0.0, 0.0, 0.0)) == pytest.approx(2.0)
    assert math.dist(first, second) > 0.01
    plugin.reset()
    context.step = 0
    context.advance(0.5)
    assert context.twist.linear == (0.0, 0.5, 0.0)
    context.advance(1.0)
    assert context.twist.linear == first


def test_a_random_velocity_stays_within_limits_that_may_be_swapped():
    found = []
    for seed in range(20):
        context, _ = wander("<min_x>0.1</min_x><max_x>-0.1</max_x><min_z>0</min_z><max_z>0</max_z>"
                            "<update_period>0.01</update_period>", seed)
        context.advance(0.1)
        found.append(context.twist.linear)
    assert all(-0.1 <= x <= 0.1 and z == 0.0 for x, _, z in found)
    assert len({y for _, y, _ in found}) == 20


@pytest.mark.parametrize("xml", ["<plugin/>", "<plugin><link>other</link></plugin>"])
def test_a_random_velocity_needs_a_link_of_the_model(xml):
    with pytest.raises(PluginError, match="link"):
        RandomVelocity(FakeContext(xml, links=("l",))).load()


@pytest.mark.parametrize("xml, joint", [("<plugin/>", "tilt_joint"),
                                        ("<plugin><joint>drone::up</joint></plugin>", "up")])
def test_a_gimbal_is_held_at_a_right_angle_by_a_limited_effort(xml, joint):
    context = FakeContext(xml, joints=(joint,))
    Gimbal(context).load()
    held = context.joints[joint]
    context.advance(0.001)
    assert held.effort == pytest.approx(1.0)
    held.put(math.pi / 2.0 + 0.25)
    context.advance(0.001)
    assert held.effort == pytest.approx(-0.25)


def test_a_gimbal_without_its_joint_is_told():
    with pytest.raises(PluginError, match="tilt_joint"):
        Gimbal(FakeContext()).load()


# -- odometry of other packages ------------------------------------------------------------------

def test_pals_odometry_is_that_of_the_world():
    context = FakeContext("<plugin><bodyName>base</bodyName><topicName>truth</topicName><frameName>"
                          "map</frameName></plugin>")
    PalWorldOdometry(context).load()
    context.link("base").pose = Pose((1.0, 2.0, 3.0), quat_from_rpy(0.0, 0.0, math.pi / 2))
    context.link("base").twist = Twist((0.5, 0.0, 0.0), (0.2, 0.0, 0.3))
    context.advance(0.001)
    (told,) = context.published["truth"]
    assert (told.header.frame_id, told.child_frame_id) == ("map", "base")
    assert told.pose.pose.position.y == 2.0
    twist = told.twist.twist
    assert (twist.linear.x, twist.angular.y, twist.angular.z) == pytest.approx((0.5, -0.2, 0.3))


def test_noise_of_pals_odometry_adds_up():
    context = FakeContext("<plugin><bodyName>base</bodyName><topicName>truth</topicName>"
                          "<gaussianNoise>0.01</gaussianNoise></plugin>")
    plugin = context.load(PalWorldOdometry)
    context.advance(4.0)
    places = [one.pose.pose.position.x for one in context.published["truth"]]
    steps = [after - before for before, after in zip(places, places[1:])]
    assert math.sqrt(sum(step * step for step in steps) / len(steps)) == pytest.approx(
        0.01, rel=0.05)
    plugin.reset()
    context.advance(0.001)
    assert abs(context.published["truth"][-1].pose.pose.position.x) < 0.05


def test_robotniks_odometry_has_velocities_in_the_axes_of_the_link():
    context = FakeContext("<plugin><bodyName>base</bodyName><topicName>truth</topicName>"
                          "<frameName>base_truth</frameName><worldFrameName>odom</worldFrameName>"
                          "<broadcastTF>True</broadcastTF><xyzOffset>0 0 1</xyzOffset></plugin>")
    RobotnikGroundTruthOdometry(context).load()
    context.link("base").pose = Pose((1.0, 2.0, 3.0), quat_from_rpy(0.0, 0.0, math.pi / 2))
    context.link("base").twist = Twist((0.5, 0.0, 0.0), (0.0, 0.0, 0.3))
    context.advance(0.001)
    (told,) = context.published["truth"]
    assert (told.header.frame_id, told.child_frame_id) == ("odom", "base_truth")
    assert told.pose.pose.position.z == 4.0 and told.pose.covariance[0] == 0.1
    assert told.twist.twist.linear.y == pytest.approx(-0.5)
    assert context.transforms[-1][:2] == ("odom", "base_truth")
    with pytest.raises(PluginError, match="topicName"):
        RobotnikGroundTruthOdometry(FakeContext("<plugin><bodyName>base</bodyName></plugin>")).load()


# -- springs -------------------------------------------------------------------------------------

def test_a_bar_turns_two_rockers_against_each_other():
    context = FakeContext("<plugin><jointA>a</jointA><jointB>b</jointB><forceConstant>100"
                          "</forceConstant></plugin>", joints=("a", "b"))
    Differential(context).load()
    context.joints["a"].position, context.joints["b"].position = 0.2, -0.1
    context.advance(0.001)
    assert context.joints["a"].servo.target == pytest.approx(-30.0)
    assert context.joints["b"].servo.target == pytest.approx(30.0)
    with pytest.raises(PluginError, match="jointB"):
        Differential(FakeContext("<plugin><jointA>a</jointA></plugin>", joints=("a",))).load()


def test_a_suspension_is_a_spring_and_a_damper():
    names = ("left_diff_unit_joint", "right_diff_unit_joint")
    context = FakeContext("<plugin><suspension_k>400</suspension_k><suspension_b>40</suspension_b>"
                          "</plugin>", joints=names)
    WarthogSuspension(context).load()
    for name in names:
        context.joints[name].position = 0.1
    context.advance(0.05)
    # 1 kg m^2, critically damped with 20 rad/s: x = x0 (1 + w t) exp(-w t)
    for name in names:
        assert context.joints[name].position == pytest.approx(
            0.1 * (1.0 + 20.0 * 0.05) * math.exp(-20.0 * 0.05), rel=0.03)
