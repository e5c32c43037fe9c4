"""Harness, elevator, wind, net force, joint control, feet: in a world without physics."""
from __future__ import annotations

import math

import pytest

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.sensor import Sensor
from my_simulations.engine.commands import Contact
from my_simulations.engine.servo_law import ServoLaw
from my_simulations.geometry import Pose, Twist, quat_from_rpy
from my_simulations.plugins.context import PluginError
from my_simulations.plugins.gripping.harness import Harness
from my_simulations.plugins.sensors.bumper import FootContact
from my_simulations.plugins.state.f3d import F3d
from my_simulations.plugins.state.joint_control import JointControl
from my_simulations.plugins.testing import FakeContext
from my_simulations.plugins.world.elevator import Elevator
from my_simulations.plugins.world.wind import Wind, catches_wind

UP = ('<joint name="strap" type="prismatic"><parent>world</parent><child>link</child><axis>'
      "<xyz>0 0 1</xyz><limit><lower>-2</lower><upper>0</upper></limit></axis></joint>"
      "<winch><joint>strap</joint><pos_pid><p>400</p></pos_pid>"
      "<vel_pid><p>100</p></vel_pid></winch><detach>strap</detach>")


def hanging(inside=UP, mass=2.0):
    context = FakeContext(f"<plugin>{inside}</plugin>", model="box", links=["link"])
    context.description = Model("box", links=[Link("link", inertial=Inertial(mass))])
    context.links["link"].inertial = Inertial(mass)
    context.load(Harness)
    return context


def test_a_harness_pulls_back_to_where_the_model_hung():
    context = hanging()
    link = context.links["link"]
    link.pose = Pose((0.01, 0.0, -0.1), quat_from_rpy(0.0, 0.02, 0.0))
    context.advance(0.001)
    (force, torque) = context.wrenches["link"]
    stiff = (2.0 * math.pi * 10.0) ** 2
    assert force == pytest.approx((-2.0 * stiff * 0.01, 0.0, 400.0 * 0.1))
    assert torque == pytest.approx((0.0, -stiff * 0.02, 0.0), rel=1e-3)


@pytest.mark.parametrize("limits, most", [
    ("", 0.0), ("<i_max>3</i_max><i_min>-3</i_min>", 3.0)])
def test_the_integral_term_of_a_winch_stays_within_its_limits(limits, most):
    """Without limits they are 0, and so is the term, as in Gazebo."""
    context = hanging(UP.replace("<pos_pid><p>400</p>", f"<pos_pid><i>1000</i>{limits}"))
    context.links["link"].pose = Pose((0.0, 0.0, -0.1))
    context.advance(0.5)
    assert context.wrenches["link"][0][2] == pytest.approx(most)


def test_the_winch_pulls_up_to_its_rate_and_holds_where_it_stops():
    context = hanging()
    link = context.links["link"]
    context.deliver("/box/harness/velocity", data=-0.5)
    link.twist = Twist((0.0, 0.0, -0.8), (0.0, 0.0, 0.0))
    context.advance(0.001)
    assert context.wrenches["link"][0][2] == pytest.approx(100.0 * 0.3)
    link.twist = Twist((0.0, 0.0, -0.2), (0.0, 0.0, 0.0))
    context.advance(0.001)
    assert context.wrenches["link"][0][2] == pytest.approx(0.0)   # it does not push down
    link.pose, link.twist = Pose((0.0, 0.0, -1.0)), Twist()
    context.deliver("/box/harness/velocity", data=0.0)
    context.advance(0.001)
    assert context.wrenches["link"][0][2] == pytest.approx(0.0)   # it holds here from now on


def test_a_model_that_is_let_go_falls_and_hangs_again_after_a_reset():
    context = hanging()
    context.links["link"].pose = Pose((0.0, 0.0, -0.1))
    context.advance(0.001)
    context.deliver("/box/harness/detach", data=False)
    context.advance(0.001)
    assert context.wrenches["link"][0][2] > 0.0
    context.deliver("/box/harness/detach", data=True)
    context.advance(0.001)
    assert context.wrenches["link"] == ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


@pytest.mark.parametrize("pose, way", [("0 0 0 0 1.5707963 0", (40.0, 0.0, 0.0)),
                                       ("a", (0.0, 0.0, 40.0)), ("1 2 3", (0.0, 0.0, 40.0))])
def test_a_harness_pulls_along_its_joints_axis_also_where_the_pose_is_no_pose(pose, way):
    context = hanging(UP.replace("<parent>", f"<pose>{pose}</pose><parent>"))
    context.links["link"].pose = Pose(tuple(-part / 400.0 for part in way))
    context.advance(0.001)
    assert context.wrenches["link"][0] == pytest.approx(way, abs=1e-4)
    assert any("<pose>" in text for text in context.log_messages) == (len(pose.split()) != 6)


def test_a_harness_without_a_joint_is_told():
    with pytest.raises(PluginError, match="<joint>"):
        hanging("<winch/>")


def lift(inside=""):
    context = FakeContext("<plugin><lift_joint>elevator::lift</lift_joint>"
                          "<door_joint>elevator::door</door_joint><floor_height>2</floor_height>"
                          f"<door_wait_time>1</door_wait_time>{inside}</plugin>",
                          model="elevator", joints=["lift", "door"])
    for joint in context.joints.values():
        joint.spec = Joint(joint.name, "prismatic", "world", joint.name, axis=JointAxis())
    return context, context.load(Elevator)


def targets(context):
    return tuple(context.joints[name].servo.target for name in ("lift", "door"))


def arrive(context):
    """Joints are where they are to be."""
    for joint in context.joints.values():
        joint.set_servo(joint.servo)
        joint.position, joint.velocity = joint.servo.target, 0.0
    context.advance(0.01)


def test_a_lift_closes_moves_opens_waits_and_closes():
    context, _ = lift()
    for joint in context.joints.values():
        joint.stuck = True
    assert targets(context) == (0.0, 0.0)
    context.deliver("elevator", data="1")
    arrive(context)                       # the door was closed
    context.deliver("elevator", data="0")    # busy: left out
    context.advance(0.02)
    assert targets(context) == (2.0, 0.0)
    arrive(context)
    context.advance(0.02)
    assert targets(context) == (2.0, 1.0)
    arrive(context)
    context.advance(0.9)
    assert targets(context) == (2.0, 1.0)
    context.advance(0.2)
    assert targets(context) == (2.0, 0.0)
    arrive(context)
    context.deliver("elevator", data="0")
    context.advance(0.05)
    assert targets(context) == (0.0, 0.0)


def test_a_lift_stops_the_engine_only_while_it_serves_a_call():
    context, _ = lift()
    assert context.stops == 0
    context.deliver("elevator", data="1")
    assert context.stops == 1
    for _ in range(5):   # stages
        arrive(context)
        context.advance(1.1)
    assert context.stops == 0 and targets(context) == (2.0, 0.0)


def test_a_harness_stops_the_engine_until_it_lets_go():
    context = hanging()
    assert context.stops == 1
    context.deliver("/box/harness/detach", data=True)
    assert context.stops == 0


def test_a_lift_that_waits_while_the_clock_is_set_back_goes_on():
    context, plugin = lift()
    context.advance(60.0)
    for joint in context.joints.values():
        joint.stuck = True
    context.deliver("elevator", data="1")
    for _ in range(2):
        arrive(context)
        context.advance(0.02)
    assert targets(context) == (2.0, 1.0)
    arrive(context)
    context.advance(0.02)   # it waits
    context.step = 0
    plugin.clock_set()
    context.advance(0.9)
    assert targets(context) == (2.0, 1.0)
    context.advance(0.2)
    assert targets(context) == (2.0, 0.0)


@pytest.mark.parametrize("floor", ["roof", "9" * 400])
def test_what_is_no_floor_is_told(floor):
    context, _ = lift()
    context.deliver("elevator", data=floor)
    assert floor in context.log_messages[-1]
    context.advance(0.05)
    assert targets(context) == (0.0, 0.0)


FACTOR = "<force_approximation_scaling_factor>2</force_approximation_scaling_factor>"


def windy(inside="", velocity=(3.0, 4.0, 0.0)):
    context = FakeContext(f"<plugin>{FACTOR}{inside}</plugin>", model="world")
    context.wind = velocity
    sail = Link("sail", inertial=Inertial(0.5))
    heavy = Link("keel", extra=["<enable_wind>false</enable_wind>"])
    context.others = {"boat": Model("boat", links=[sail, heavy], enable_wind=True),
                      "rock": Model("rock", links=[Link("stone")]),
                      "mast": Model("mast", links=[Link("pole")], enable_wind=True, static=True)}
    return context, context.load(Wind)


CALM = ("<horizontal><magnitude><time_for_rise>0</time_for_rise>{}</magnitude>"
        "<direction><time_for_rise>0</time_for_rise></direction></horizontal>")


def test_wind_pushes_by_mass_and_by_how_much_faster_it_is():
    context, _ = windy(CALM.format(""))
    context.model_link("boat::sail").twist = Twist((1.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    context.advance(0.01)
    assert set(context.wrenches) == {"boat::sail"}
    assert context.wrenches["boat::sail"][0] == pytest.approx((2.0, 4.0, 0.0))


def test_wind_rises_with_its_lag():
    context, plugin = windy("<horizontal><magnitude><time_for_rise>2</time_for_rise></magnitude>"
                            "<direction><time_for_rise>0</time_for_rise></direction></horizontal>")
    context.advance(2.0)
    x, y, _ = plugin.velocity()
    assert math.hypot(x, y) == pytest.approx(5.0 * (1.0 - math.exp(-1.0)), rel=1e-6)
    assert math.atan2(y, x) == pytest.approx(math.atan2(4.0, 3.0))


def test_wind_blows_on_when_the_clock_is_set_back():
    context, plugin = windy("<horizontal><magnitude><time_for_rise>2</time_for_rise></magnitude>"
                            "<direction><time_for_rise>0</time_for_rise></direction></horizontal>")
    context.advance(60.0)
    context.step = 0
    plugin.clock_set()
    context.advance(0.01)
    assert math.hypot(*plugin.velocity()[:2]) == pytest.approx(5.0)


def test_wind_swings_and_another_one_can_be_given():
    swing = "<sin><amplitude_percent>0.2</amplitude_percent><period>4</period></sin>"
    context, plugin = windy(CALM.format(swing))
    context.deliver("/gazebo/wind", x=10.0, y=0.0, z=0.0)
    context.advance(1.0)
    assert plugin.velocity()[0] == pytest.approx(12.0)
    context.advance(2.0)
    assert plugin.velocity()[0] == pytest.approx(8.0)


def test_what_leaves_the_wind_is_pushed_no_more():
    context, _ = windy(CALM.format(""))
    context.advance(0.01)
    context.others["boat"] = Model("boat", links=[Link("sail")])
    context.advance(0.01)
    assert context.wrenches["boat::sail"][0] == (0.0, 0.0, 0.0)
    del context.others["boat"]
    context.wrenches.clear()
    context.advance(0.05)
    assert context.wrenches == {}


def test_a_link_decides_for_itself_whether_wind_acts_on_it():
    model = Model("m", enable_wind=False)
    assert catches_wind(model, Link("a", extra=["<enable_wind>1</enable_wind>"]))
    assert not catches_wind(model, Link("b"))


def test_a_wind_without_a_factor_is_told():
    with pytest.raises(PluginError, match="scaling_factor"):
        Wind(FakeContext("<plugin/>", model="world")).load()


def test_the_net_force_is_mass_times_acceleration():
    context = FakeContext("<plugin><bodyName>link</bodyName><topicName>net</topicName></plugin>",
                          links=["link"])
    link = context.links["link"]
    link.inertial = Inertial(2.0, ixx=0.1, iyy=0.2, izz=0.3)
    F3d(context).load()
    context.advance(0.001)
    link.twist = Twist((0.0, 0.0, -0.0098), (0.0, 0.0, 0.002))
    context.advance(0.001)
    wrench = context.published["net"][-1].wrench
    assert (wrench.force.z, wrench.torque.z) == pytest.approx((-19.6, 0.6))
    assert context.published["net"][-1].header.frame_id == "world"


def test_joints_are_held_as_their_controllers_say():
    context = FakeContext(
        '<plugin><controller type="position"><joint>arm_.*</joint><target>0.5</target>'
        '<pid_gains>10 1 2</pid_gains></controller><controller type="force"><joint>wheel</joint>'
        "<target>3</target></controller><controller type='velocity'><joint>none</joint>"
        "</controller></plugin>", joints=["arm_1", "arm_2", "wheel"])
    context.description.joints += [joint.spec for joint in context.joints.values()]
    JointControl(context).load()
    for name in ("arm_1", "arm_2"):
        servo = context.joints[name].servo
        assert (servo.target, servo.gains.p, servo.gains.d, servo.of_rate) == (0.5, 10.0, 2.0,
                                                                               False)
    assert context.joints["wheel"].servo.target == 3.0
    assert "none" in context.log_messages[-1]


def test_a_held_joint_that_is_blocked_winds_up_no_more_than_in_gazebo():
    """The integral term ends at 1 and unwinds at once; the effort ends at 1000."""
    context = FakeContext(
        '<plugin><controller type="position"><joint>blocked</joint><target>1</target>'
        '<pid_gains>0 10 0</pid_gains></controller><controller type="velocity">'
        "<joint>fast</joint><target>1</target><pid_gains>1e9 0 0</pid_gains></controller></plugin>",
        joints=["blocked", "fast"])
    context.description.joints += [joint.spec for joint in context.joints.values()]
    JointControl(context).load()
    law = ServoLaw(context.joints["blocked"].servo, 0.001)
    assert [law.advance(0.0, 0.0, step) for step in range(1000)][-1] == pytest.approx(1.0)
    assert law.advance(2.0, 0.0, 1000) < 1.0
    assert ServoLaw(context.joints["fast"].servo, 0.001).advance(0.0, 0.0, 0) == 1000.0


def test_a_controller_without_a_target_drives_nothing():
    context = FakeContext('<plugin><controller type="position"><joint>arm</joint></controller>'
                          "</plugin>", joints=["arm"])
    context.description.joints.append(context.joints["arm"].spec)
    JointControl(context).load()
    assert context.joints["arm"].servo is None


def test_a_controller_of_no_type_is_told():
    context = FakeContext('<plugin><controller type="magic"/></plugin>')
    with pytest.raises(PluginError, match="magic"):
        JointControl(context).load()


def test_the_force_on_a_foot_is_that_of_its_contacts_in_its_own_axes():
    context = FakeContext("<plugin/>", model="dog", links=["calf"],
                          sensor=Sensor("foot", "contact", update_rate=100.0), sensor_link="calf")
    context.links["calf"].pose = Pose(orientation=quat_from_rpy(math.pi / 2.0, 0.0, 0.0))
    FootContact(context).load()
    context.touching = [("dog::calf", "ground::link",
                         Contact(1, 2, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 0.0, 30.0,
                                 (0.0, 0.0, 0.0)))]
    context.advance(0.02)
    force = context.published["/visual/foot/the_force"][-1].wrench.force
    assert (force.x, force.y, force.z) == pytest.approx((0.0, 30.0, 0.0), abs=1e-9)
