"""Robots in Python programs: joints, limits, Jacobians, inverse kinematics, rays, contacts."""
from __future__ import annotations

import math

import numpy as np
import pytest

import my_simulations
from my_simulations.errors import CommandError

ARM = """<robot name="arm"><link name="world"/>
<joint name="base" type="fixed"><parent link="world"/><child link="foot"/>
<origin xyz="0.1 0.2 0.3" rpy="0 0 0.4"/></joint>
<link name="foot"><inertial><mass value="1"/><inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0"
 iyz="0"/></inertial></link>
<joint name="turn" type="continuous"><parent link="foot"/><child link="upper"/><axis xyz="0 0 1"/>
<origin xyz="0 0 0.2"/><limit effort="50" velocity="1.5"/></joint>
<link name="upper"><inertial><origin xyz="0 0 0.2"/><mass value="1"/><inertia ixx=".1" iyy=".1"
 izz=".1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="lift" type="revolute"><parent link="upper"/><child link="fore"/><axis xyz="0 1 0"/>
<origin xyz="0 0 0.4" rpy="0.1 0 0"/><limit lower="-1.5" upper="1.5" effort="60" velocity="0.8"/>
</joint>
<link name="fore"><inertial><origin xyz="0 0 0.2"/><mass value="0.5"/><inertia ixx=".05" iyy=".05"
 izz=".05" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="slide" type="prismatic"><parent link="fore"/><child link="hand"/><axis xyz="0 0 1"/>
<origin xyz="0 0 0.3"/><limit lower="0" upper="0.3" effort="80" velocity="0.2"/></joint>
<link name="hand"><inertial><mass value="0.2"/><inertia ixx=".01" iyy=".01" izz=".01" ixy="0"
 ixz="0" iyz="0"/></inertial></link>
<joint name="wrist" type="revolute"><parent link="hand"/><child link="tool"/><axis xyz="1 0 0"/>
<origin xyz="0 0 0.1"/><limit lower="-2" upper="2"/></joint>
<link name="tool"><inertial><mass value="0.1"/><inertia ixx=".01" iyy=".01" izz=".01" ixy="0"
 ixz="0" iyz="0"/></inertial></link></robot>"""
POSE = {"turn": 0.5, "lift": -0.7, "slide": 0.1, "wrist": 0.9}
BOX = """<sdf version="1.7"><model name="box"><link name="link"><inertial><mass>2</mass>
<inertia><ixx>0.0133</ixx><iyy>0.0133</iyy><izz>0.0133</izz></inertia></inertial>
<collision name="c"><geometry><box><size>0.2 0.2 0.2</size></box></geometry></collision>
</link></model></sdf>"""


@pytest.fixture
def world():
    with my_simulations.open_world() as opened:
        yield opened


@pytest.fixture
def arm(world):
    world.spawn(ARM, pose=[1.0, 0.0, 0.0])
    return world.robot("arm")


def test_joints_are_put_and_read(world, arm):
    assert arm.joints == ("turn", "lift", "slide", "wrist")
    arm.set_positions(POSE, rates={"wrist": 0.5})
    assert dict(arm.positions) == pytest.approx(POSE)
    assert dict(arm.rates) == pytest.approx({"turn": 0, "lift": 0, "slide": 0, "wrist": 0.5})
    assert arm.limits("lift") == (-1.5, 1.5, 0.8, 60.0)
    assert arm.limits("turn")[:2] == (-math.inf, math.inf)
    with pytest.raises(CommandError, match="needs a position"):
        arm.set_positions({"turn": 0.1}, rates={"lift": 1.0})
    with pytest.raises(CommandError):
        arm.set_positions({"lost": 0.1})
    with pytest.raises(CommandError):
        world.robot("lost")


def test_motors_keep_the_limits_of_the_file(world, arm):
    arm.move({"turn": 1.0, "lift": 0.6})
    fastest = {"turn": 0.0, "lift": 0.0}
    for _ in range(300):
        world.step(10)
        for name in fastest:
            fastest[name] = max(fastest[name], abs(arm.rates[name]))
    assert fastest["turn"] == pytest.approx(1.5, rel=0.05)
    assert fastest["lift"] == pytest.approx(0.8, rel=0.05)
    assert arm.positions["turn"] == pytest.approx(1.0, abs=0.01)
    assert arm.positions["lift"] == pytest.approx(0.6, abs=0.01)
    with pytest.raises(CommandError, match="no limit of effort"):
        arm.move({"wrist": 0.5})
    with pytest.raises(CommandError, match="no limit of effort"):
        arm.drive({"wrist": 0.5})
    arm.move({"wrist": 0.5}, effort=20.0)
    world.step(2000)
    assert arm.positions["wrist"] == pytest.approx(0.5, abs=0.01)
    world.move_joint("arm::lift", 0.5)
    world.step(1000)
    assert arm.positions["lift"] == pytest.approx(0.5, abs=0.01)


def test_the_effort_of_a_motor_carries_the_weight(world, arm):
    arm.move({"turn": 0.0, "lift": 1.0, "slide": 0.2, "wrist": 0.0}, effort=200.0)
    world.step(4000)
    # The torque of gravity about the axis, by virtual work: the sum of m g dz/dq.
    masses = {"fore": (0.5, 0.2), "hand": (0.2, 0.0), "tool": (0.1, 0.0)}
    torque = sum(mass * 9.8 * arm.jacobian(link, [0.0, 0.0, height])[2, 1]
                 for link, (mass, height) in masses.items())
    assert arm.efforts["lift"] == pytest.approx(torque, rel=0.02)


def test_a_drive_and_its_release(world, arm):
    arm.drive({"turn": 0.7})
    world.step(500)
    assert arm.rates["turn"] == pytest.approx(0.7, rel=0.01)
    arm.release()
    arm.apply_efforts({"turn": 2.0}, duration=0.2)
    world.step(400)
    assert arm.rates["turn"] > 0.75


def test_applied_efforts_are_read_and_end(world, arm):
    assert not arm.applied_efforts.array.any()
    arm.apply_efforts({"turn": 2.0}, duration=0.1)
    arm.apply_efforts({"turn": 0.5, "wrist": -1.0})
    assert dict(arm.applied_efforts) == {"turn": 2.5, "lift": 0.0, "slide": 0.0, "wrist": -1.0}
    world.step(round(0.1 / world.step_size))
    assert (arm.applied_efforts["turn"], arm.applied_efforts["wrist"]) == (0.5, -1.0)
    arm.clear_efforts(["turn"])
    assert (arm.applied_efforts["turn"], arm.applied_efforts["wrist"]) == (0.0, -1.0)
    arm.clear_efforts()
    assert not arm.applied_efforts.array.any()


def test_a_jacobian_is_the_derivative_of_the_pose(world, arm):
    arm.set_positions(POSE)
    point = np.array([0.05, 0.02, 0.1])
    jacobian = arm.jacobian("tool", point)
    assert jacobian.shape == (6, 4)
    for column, name in enumerate(arm.joints):
        ends = []
        for change in (-1e-5, 1e-5):
            arm.set_positions({name: POSE[name] + change})
            ends.append(world.links().pose["arm::tool"].copy())
        arm.set_positions({name: POSE[name]})
        moved = [end[:3] + turned(end[3:], point) for end in ends]
        assert jacobian[:3, column] == pytest.approx((moved[1] - moved[0]) / 2e-5, abs=1e-5)
        spin = 2.0 * (vector_part(ends[1][3:], ends[0][3:])) / 2e-5
        assert jacobian[3:, column] == pytest.approx(spin, abs=1e-5)


def turned(quaternion, vector):
    x, y, z, w = quaternion
    axis = np.array([x, y, z])
    return vector + 2.0 * np.cross(axis, np.cross(axis, vector) + w * vector)


def vector_part(one, other):
    """Of one times the inverse of the other."""
    return (-one[3] * other[:3] + other[3] * one[:3] - np.cross(one[:3], other[:3]))


def test_inverse_kinematics_reach_a_pose_within_the_limits(world, arm):
    arm.set_positions(POSE)
    target = world.links().pose["arm::tool"].copy()
    arm.set_positions({"turn": -0.4, "lift": 0.2, "slide": 0.25, "wrist": 0.0})
    found = arm.inverse_kinematics("tool", target)
    arm.set_positions(found)
    reached = world.links().pose["arm::tool"]
    assert reached[:3] == pytest.approx(target[:3], abs=2e-4)
    assert abs(float(reached[3:] @ target[3:])) == pytest.approx(1.0, abs=1e-6)
    assert found == arm.inverse_kinematics("tool", target)
    for name, value in found.items():
        lower, upper, _, _ = arm.limits(name)
        assert lower <= value <= upper
    near = arm.inverse_kinematics("tool", target[:3] + [0.05, 0.0, -0.05], joints=["turn", "lift",
                                                                                  "slide"])
    assert set(near) == {"turn", "lift", "slide"}
    with pytest.raises(CommandError, match="not reached"):
        arm.inverse_kinematics("tool", [5.0, 0.0, 0.0])
    with pytest.raises(CommandError, match="no link 'lost'"):
        arm.inverse_kinematics("lost", [0.0, 0.0, 0.0])


def test_rays_give_distances_and_links(world):
    world.spawn(BOX, "one", [2.0, 0.0, 0.5])
    world.spawn(BOX, "two", [0.0, 3.0, 0.5])
    found = world.cast_rays([0.0, 0.0, 0.5], [[1, 0, 0], [0, 2, 0], [-1, 0, 0], [0, 0, -1]])
    assert found.ranges == pytest.approx([1.9, 2.9, np.inf, 0.5], abs=1e-6)
    assert found.links == ("one::link", "two::link", "", "ground_plane::link")
    below = world.cast_rays([[0, 0, -0.2], [0, 0, 0.2]], [0, 0, -1], frame="one", far=0.35)
    assert below.ranges == pytest.approx([0.3, 0.1], abs=1e-6)
    assert below.links == ("ground_plane::link", "one::link")
    beyond = world.cast_rays([0.0, 0.0, 0.5], [0, 0, -1], far=0.4)
    assert beyond.ranges.tolist() == [math.inf] and beyond.links == ("",)
    for origins, directions in (([0, 0], [1, 0, 0]), ([0, 0, 0], [0, 0, 0]),
                                ([[0, 0, 0]] * 2, [[1, 0, 0]] * 3)):
        with pytest.raises(CommandError):
            world.cast_rays(origins, directions)


def test_forces_are_summed_for_each_pair(world):
    world.spawn(BOX, "lower", [0.0, 0.0, 0.1])
    world.spawn(BOX, "upper", [0.0, 0.0, 0.3])
    world.step(1500)
    forces = world.contact_forces()
    assert len(forces) == 2
    on = {name: np.zeros(3) for name in ("lower::link", "upper::link", "ground_plane::link")}
    for (first, second), force in forces.items():
        on[first] += force
        on[second] -= force
    assert on["upper::link"] == pytest.approx([0, 0, 2 * 9.8], abs=0.2)
    assert on["lower::link"] == pytest.approx([0, 0, 2 * 9.8], abs=0.2)
    assert on["ground_plane::link"] == pytest.approx([0, 0, -4 * 9.8], abs=0.4)


def test_links_are_attached_and_detached(world):
    world.spawn(BOX, "one", [0.0, 0.0, 2.0])
    world.attach("hook", "world", "one::link")
    world.step(200)
    assert world.states().pose["one"][2] == pytest.approx(2.0, abs=1e-3)
    world.detach("hook")
    world.step(200)
    assert world.states().pose["one"][2] < 1.9
    with pytest.raises(CommandError, match="hook"):
        world.detach("hook")
