from types import SimpleNamespace as Fields

import pytest

from my_simulations.errors import CommandError
from my_simulations.ros.message_conversion import (
    check_finite,
    pose_from_message,
    twist_from_message,
)


def pose_message(position=(1.0, 2.0, 3.0), orientation=(0.0, 0.0, 0.0, 1.0)):
    return Fields(position=Fields(**dict(zip("xyz", position))),
                  orientation=Fields(**dict(zip("xyzw", orientation))))


def test_the_all_zero_quaternion_is_identity():
    assert pose_from_message(pose_message(orientation=(0, 0, 0, 0))).orientation == (0, 0, 0, 1)


def test_quaternions_are_normalised():
    found = pose_from_message(pose_message(orientation=(0.0, 0.0, 3.0, 4.0)))
    assert found.orientation == pytest.approx((0.0, 0.0, 0.6, 0.8))


@pytest.mark.parametrize("bad", [float("nan"), float("inf"), float("-inf")])
def test_numbers_that_are_not_finite_are_refused_by_name(bad):
    with pytest.raises(CommandError, match="initial_pose.position"):
        pose_from_message(pose_message(position=(0.0, bad, 0.0)), "initial_pose")
    with pytest.raises(CommandError, match="orientation"):
        pose_from_message(pose_message(orientation=(0.0, 0.0, bad, 1.0)))
    twist = Fields(linear=Fields(x=0.0, y=0.0, z=0.0), angular=Fields(x=bad, y=0.0, z=0.0))
    with pytest.raises(CommandError, match="twist.angular"):
        twist_from_message(twist)
    with pytest.raises(CommandError, match="time_step"):
        check_finite(bad, "time_step")
