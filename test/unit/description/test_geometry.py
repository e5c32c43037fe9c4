"""Poses, rotations, twists."""
import math
import random

import pytest

from my_simulations import geometry as g


def some_pose(rng):
    return g.pose_from_xyzrpy(*(rng.uniform(-3, 3) for _ in range(6)))


def near(pose, other):
    same = [a * b for a, b in zip(pose.orientation, other.orientation)]
    return (pose.position == pytest.approx(other.position)
            and abs(sum(same)) == pytest.approx(1.0))


@pytest.mark.parametrize("axis, turned", [
    ((math.pi / 2, 0, 0), (0, 0, 1)), ((0, 0, math.pi / 2), (-1, 0, 0)),
])
def test_roll_and_yaw_turn_y(axis, turned):
    assert g.rotate(g.quat_from_rpy(*axis), (0, 1, 0)) == pytest.approx(turned)


def test_roll_comes_first_and_yaw_last():
    q = g.quat_from_rpy(math.pi / 2, 0, math.pi / 2)
    # y rolls to z, which yaw leaves alone; rolled after the yaw it would be -x.
    assert g.rotate(q, (0, 1, 0)) == pytest.approx((0, 0, 1))


@pytest.mark.parametrize("seed", range(20))
def test_angles_survive_the_way_through_a_quaternion(seed):
    rng = random.Random(seed)
    rpy = (rng.uniform(-3, 3), rng.uniform(-1.5, 1.5), rng.uniform(-3, 3))
    assert g.rpy_from_quat(g.quat_from_rpy(*rpy)) == pytest.approx(rpy)


@pytest.mark.parametrize("pitch", [math.pi / 2, -math.pi / 2])
def test_the_turn_is_kept_where_roll_and_yaw_are_one(pitch):
    q = g.quat_from_rpy(0.3, pitch, 0.7)
    again = g.quat_from_rpy(*g.rpy_from_quat(q))
    for vector in ((1, 0, 0), (0, 1, 0), (0, 0, 1)):
        assert g.rotate(again, vector) == pytest.approx(g.rotate(q, vector), abs=1e-6)


@pytest.mark.parametrize("seed", range(10))
def test_poses_form_a_group(seed):
    rng = random.Random(seed)
    a, b, c = (some_pose(rng) for _ in range(3))
    assert near(g.compose(a, g.inverse(a)), g.IDENTITY)
    assert near(g.compose(g.compose(a, b), c), g.compose(a, g.compose(b, c)))
    point = (0.1, -2.0, 3.0)
    assert g.transform(g.compose(a, b), point) == pytest.approx(
        g.transform(a, g.transform(b, point)))


def test_a_quaternion_of_zeros_is_no_turn():
    assert g.normalised((0, 0, 0, 0)) == g.IDENTITY_QUAT
    assert g.normalised((0, 0, 0, 2)) == (0, 0, 0, 1)


def test_a_turning_body_moves_at_its_lever():
    twist = g.Twist((1, 0, 0), (0, 0, 2))
    assert g.twist_at(twist, (0, 3, 0)) == g.Twist((-5, 0, 0), (0, 0, 2))


def test_finite_is_told_from_not():
    assert g.pose_is_finite(g.IDENTITY)
    assert not g.pose_is_finite(g.Pose((0, math.inf, 0)))
    assert not g.pose_is_finite(g.Pose(orientation=(0, 0, math.nan, 1)))
