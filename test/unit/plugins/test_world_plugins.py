"""Plugins of what surrounds a model: their forces against closed forms."""
from __future__ import annotations

import math

import pytest

from my_simulations.description.model import Inertial, Link, Model
from my_simulations.description.plugin import PluginSpec
from my_simulations.description.shapes import Box, Collision, Cylinder, Mesh, Sphere
from my_simulations.geometry import Pose, Twist, cross, quat_from_rpy
from my_simulations.plugins.context import PluginError
from my_simulations.plugins.testing import FakeContext
from my_simulations.plugins.world.actor_poses import ActorPoses
from my_simulations.plugins.world.buoyancy import Buoyancy
from my_simulations.plugins.world.dipole_magnet import DipoleMagnet, field_of, force_between
from my_simulations.plugins.world.lift_drag import LiftDrag

WING = """<plugin><link_name>wing</link_name><cla>4.75</cla><cda>0.6</cda>
<alpha_stall>0.34</alpha_stall>
<cla_stall>-3.85</cla_stall><cda_stall>-0.9</cda_stall><area>0.5</area>
<air_density>1.2</air_density>
<cp>-0.05 0 0</cp></plugin>"""


def wing(speed, alpha, xml=WING, **options):
    context = FakeContext(xml, links=("wing",), **options)
    link = context.links["wing"]
    link.pose = Pose((0.0, 0.0, 5.0), quat_from_rpy(0.0, -alpha, 0.0))  # the nose up
    link.twist = Twist((speed, 0.0, 0.0), (0.0, 0.0, 0.0))
    LiftDrag(context).load()
    context.advance(0.001)
    return context.wrenches["wing"]


@pytest.mark.parametrize("alpha", [-0.3, -0.1, 0.0, 0.2, 0.33])
def test_lift_and_drag_of_a_wing_that_is_not_stalled(alpha):
    force, torque = wing(20.0, alpha)
    pressure = 0.5 * 1.2 * 20.0 ** 2 * 0.5
    assert force == pytest.approx((-abs(0.6 * alpha) * pressure, 0.0, 4.75 * alpha * pressure))
    arm = (-0.05 * math.cos(alpha), 0.0, -0.05 * math.sin(alpha))
    assert torque == pytest.approx((0.0, arm[2] * force[0] - arm[0] * force[2], 0.0))


@pytest.mark.parametrize("sweep", [-0.6, 0.3, 1.0])
def test_a_wing_that_is_swept_lifts_and_drags_by_the_square_of_the_cosine(sweep):
    """Of the angle between the air and the plane of lift and drag, as in Gazebo."""
    context = FakeContext(WING, links=("wing",))
    ahead = 20.0 * math.cos(sweep)
    context.links["wing"].twist = Twist((ahead * math.cos(0.2), 20.0 * math.sin(sweep),
                                         -ahead * math.sin(0.2)), (0.0, 0.0, 0.0))
    LiftDrag(context).load()
    context.advance(0.001)
    force, _ = context.wrenches["wing"]
    pressure = 0.5 * 1.2 * ahead ** 2 * 0.5 * math.cos(sweep) ** 2
    lift, drag = 4.75 * 0.2 * pressure, 0.6 * 0.2 * pressure
    assert force == pytest.approx((lift * math.sin(0.2) - drag * math.cos(0.2), 0.0,
                                   lift * math.cos(0.2) + drag * math.sin(0.2)))


def test_lift_falls_past_the_stall_and_never_turns_its_sign():
    pressure = 0.5 * 1.2 * 20.0 ** 2 * 0.5
    assert wing(20.0, 0.5)[0][2] == pytest.approx((4.75 * 0.34 - 3.85 * 0.16) * pressure)
    assert wing(20.0, 1.2)[0][2] == pytest.approx(0.0, abs=1e-9)


def test_standing_air_lifts_nothing():
    assert wing(0.005, 0.2)[0] == (0.0, 0.0, 0.0)


def test_a_control_joint_adds_lift():
    xml = WING.replace("<cp>", "<control_joint_name>flap</control_joint_name><cp>")
    context = FakeContext(xml, links=("wing",), joints=("flap",))
    context.links["wing"].twist = Twist((10.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    context.joints["flap"].position = 0.1
    LiftDrag(context).load()
    context.advance(0.001)
    assert context.wrenches["wing"][0][2] == pytest.approx(4.0 * 0.1 * 0.5 * 1.2 * 100.0 * 0.5)


def test_a_wing_without_its_control_joint_flies():
    xml = WING.replace("<cp>", "<control_joint_name>none</control_joint_name><cp>")
    assert wing(20.0, 0.2, xml)[0] == wing(20.0, 0.2)[0]


def buoy(inside, *collisions, com=(0.0, 0.0, 0.0)):
    context = FakeContext(f"<plugin>{inside}</plugin>")
    inertial = Inertial(mass=2.0, pose=Pose(com))
    context.description.links.append(Link("hull", inertial=inertial, collisions=list(collisions)))
    context.link("hull").inertial = inertial
    Buoyancy(context).load()
    return context


@pytest.mark.parametrize("block", [
    '<link name="hull"><volume>0</volume><center_of_volume>0 0 1</center_of_volume></link>',
    '<link name="hull"><volume>-2</volume></link>', '<link name="none"><volume>1</volume></link>'])
def test_a_volume_that_cannot_be_is_told_and_that_of_the_collisions_counts(block):
    """As in Gazebo."""
    context = buoy(block, Collision("a", geometry=Box((1.0, 0.5, 0.2))))
    assert "volume" in context.log_messages[-1]
    force, torque = context.wrenches["hull"]
    assert force[2] == pytest.approx(999.1026 * 0.1 * 9.8)
    assert torque == pytest.approx((0.0, 0.0, 0.0))


def test_a_hull_is_lifted_by_the_weight_of_the_water_in_its_place():
    context = buoy("", Collision("a", geometry=Box((1.0, 0.5, 0.2))),
                   Collision("b", Sphere(0.1), Pose((1.0, 0.0, 0.0))))
    volume, ball = 0.1, 4 / 3 * math.pi * 0.1 ** 3
    force, torque = context.wrenches["hull"]
    lift = 999.1026 * (volume + ball) * 9.8
    assert force == pytest.approx((0.0, 0.0, lift))
    assert torque == pytest.approx((0.0, -lift * ball / (volume + ball), 0.0))


def test_a_given_volume_counts_and_turns_with_the_link():
    context = buoy('<fluid_density>1000</fluid_density><link name="hull"><center_of_volume>0 0 0.2'
                   "</center_of_volume><volume>0.01</volume></link>",
                   Collision("a", geometry=Cylinder(5.0, 1.0)))
    context.links["hull"].pose = Pose((0.0, 0.0, 0.0), quat_from_rpy(math.pi / 2, 0.0, 0.0))
    context.advance(0.001)
    force, torque = context.wrenches["hull"]
    assert force == pytest.approx((0.0, 0.0, 98.0))
    assert torque == pytest.approx((-0.2 * 98.0, 0.0, 0.0))


def test_a_mesh_without_a_volume_is_told():
    context = buoy("", Collision("a", geometry=Mesh("model://boat.dae")))
    assert not context.wrenches and "give its <volume>" in context.log_messages[0]


# -- magnets -------------------------------------------------------------------------------------

def magnet(moment, inside=""):
    return (f"<plugin><bodyName>bar</bodyName><dipole_moment>{moment}</dipole_moment>{inside}"
            "</plugin>")


def beside(moment, other, arm, **poses):
    """A magnet at `arm` from another one."""
    context = FakeContext(magnet(moment, "<shouldPublish>true</shouldPublish>"), model="one")
    context.link("bar").pose = Pose(arm, **poses)
    context.link("bar").inertial = Inertial(1.0)
    context.others = {"one": Model("one"), "two": Model("two", plugins=[
        PluginSpec("m", "libgazebo_dipole_magnet.so", magnet(other))])}
    DipoleMagnet(context).load()
    context.advance(0.001)
    return context


def test_magnets_in_a_row_attract():
    context = beside("0 0 2", "0 0 3", (0.0, 0.0, 0.1))
    force, torque = context.wrenches["bar"]
    # 6 mu0 m1 m2 / (4 pi r^4), and the field on the axis is mu0 2 m / (4 pi r^3)
    assert force == pytest.approx((0.0, 0.0, -6e-7 * 2.0 * 3.0 / 0.1 ** 4))
    assert torque == pytest.approx((0.0, 0.0, 0.0))
    assert context.published["bar/mfs"][-1].magnetic_field.z == pytest.approx(2e-7 * 3.0 / 1e-3)
    assert context.published["bar/wrench"][-1].wrench.force.z == pytest.approx(force[2])


def test_magnets_side_by_side_repel_and_a_crossed_one_turns():
    force, _ = beside("0 0 2", "0 0 3", (0.1, 0.0, 0.0)).wrenches["bar"]
    assert force == pytest.approx((3e-7 * 6.0 / 0.1 ** 4, 0.0, 0.0))
    _, torque = beside("0 0 2", "0 0 3", (0.0, 0.0, 0.1),
                       orientation=quat_from_rpy(math.pi / 2, 0.0, 0.0)).wrenches["bar"]
    # the moment is (0, -2, 0), the field (0, 0, 6e-4)
    assert torque == pytest.approx((-2.0 * 6e-4, 0.0, 0.0), abs=1e-12)


def test_forces_between_magnets_are_opposite():
    one, two, arm = (1.0, -2.0, 0.5), (0.3, 0.4, -2.0), (0.1, 0.2, -0.05)
    there = force_between(one, two, arm)
    back = force_between(two, one, tuple(-part for part in arm))
    assert there == pytest.approx(tuple(-part for part in back))
    # No torque about any point is left: m1 x B2 + m2 x B1 + arm x F = 0.
    around = [sum(parts) for parts in zip(
        cross(one, field_of(two, arm)),
        cross(two, field_of(one, tuple(-part for part in arm))), cross(arm, there))]
    assert around == pytest.approx([0.0] * 3, abs=1e-12)


def test_models_follow_the_agents_with_their_numbers():
    context = FakeContext(model="world")
    context.others = {"1": Model("1"), "car": Model("car")}
    ActorPoses(context).load()
    context.deliver("/pedsim_simulator/simulated_agents", agent_states=[
        {"id": number, "pose": {"position": {"x": 2.0, "y": float(number), "z": 0.1},
                                "orientation": {"z": 1.0}}} for number in (1, 2)])
    assert context.moved == {"1": Pose((2.0, 1.0, pytest.approx(0.85)), (0.0, 0.0, 1.0, 0.0))}


def test_a_refused_pose_of_an_agent_is_reported_once_and_an_absent_model_is_not():
    class Refusing(FakeContext):
        def move_model(self, name, pose, twist=None):
            raise PluginError("the orientation is not a rotation")

    context = Refusing(model="world")
    context.others = {"1": Model("1")}
    ActorPoses(context).load()
    for _ in range(2):
        context.deliver("/pedsim_simulator/simulated_agents",
                        agent_states=[{"id": 1}, {"id": 2}])
    (warning,) = context.log_messages
    assert "'1'" in warning and "the orientation is not a rotation" in warning
