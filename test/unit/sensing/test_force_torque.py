"""In which axes, and which way round, a force-torque sensor measures."""
from __future__ import annotations

import math

import pytest

from my_simulations.engine.commands import JointWrench
from my_simulations.geometry import Pose, quat_from_rpy
from my_simulations.sensing.sensor_models import measure_wrench

QUARTER = quat_from_rpy(0, 0, math.pi / 2)
WRENCH = JointWrench((1, 2, 3), (4, 5, 6), QUARTER)


@pytest.mark.parametrize("frame, force, torque", [
    ("child", (1, 2, 3), (4, 5, 6)), ("parent", (-2, 1, 3), (-5, 4, 6)),
    ("sensor", (2, 3, 1), (5, 6, 4)), ("nonsense", (1, 2, 3), (4, 5, 6))])
@pytest.mark.parametrize("direction, sign", [
    ("child_to_parent", -1), ("parent_to_child", 1), ("nonsense", -1)])
def test_a_wrench_in_the_axes_that_were_asked_for(frame, force, torque, direction, sign):
    # x of the sensor is y of the child, y is z, z is x: a quarter about z, then one about x.
    sample = measure_wrench(WRENCH, frame, direction, Pose(orientation=QUARTER),
                            Pose(orientation=quat_from_rpy(math.pi / 2, 0, 0)))
    assert sample.force == pytest.approx([sign * each for each in force])
    assert sample.torque == pytest.approx([sign * each for each in torque])
