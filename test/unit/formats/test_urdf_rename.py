"""Names after lumping, SDF joints in a robot, joints that follow others."""
import math

import pytest
from reading import URDF_INERTIAL, codes, errors, robot_joint, robot_link, robot_of, tolerated

from my_simulations.description.model import Mimic
from my_simulations.formats.sdf.writer.entities import write_entity

BOX = '<collision><geometry><box size="1 1 1"/></geometry></collision>'
ARM = (robot_link("base", URDF_INERTIAL + BOX) + robot_link("hand", URDF_INERTIAL + BOX + BOX)
       + robot_joint("grip", "base", "hand", xyz="1 2 3", rpy="0 0 1.5707963267948966"))


def kept(inside, reference=""):
    model, issues = robot_of(ARM + f"<gazebo{reference}>{inside}</gazebo>")
    assert errors(issues) == []
    return model


def test_a_plugin_of_a_lumped_link_names_what_stands_for_it_and_grows_its_offset():
    model = kept('<plugin name="p" filename="f"><bodyName>hand</bodyName>'
                 "<xyzOffset>1 0 0</xyzOffset><rpyOffset>0 0 0</rpyOffset><other>hand</other>"
                 "</plugin>")
    from lxml import etree

    plugin = etree.fromstring(model.plugins[0].xml)
    assert plugin.findtext("bodyName") == "base" and plugin.findtext("other") == "hand"
    assert [float(x) for x in plugin.findtext("xyzOffset").split()] == pytest.approx([1, 3, 3])
    assert [float(x) for x in plugin.findtext("rpyOffset").split()] == pytest.approx(
        [0, 0, math.pi / 2])


def test_a_plugin_of_a_sensor_keeps_its_frame_where_the_sensor_still_is():
    model = kept('<sensor name="s" type="ray"><pose>0 0 0 0 0 0</pose><plugin name="p" '
                 'filename="f"><frameName>hand</frameName></plugin></sensor>', ' reference="hand"')
    (sensor,) = model.links[0].sensors
    assert "<frameName>hand</frameName>" in sensor.plugins[0].xml
    assert sensor.pose.position == pytest.approx((1, 2, 3))


def test_a_contact_sensor_names_the_collisions_by_their_new_names():
    model = kept('<sensor name="s" type="contact"><contact><collision>hand_collision_1</collision>'
                 "</contact></sensor>", ' reference="hand"')
    names = [collision.name for collision in model.links[0].collisions]
    sensor = next(xml for xml in model.links[0].extra if xml.startswith("<sensor"))
    assert names[2].endswith("hand_collision_2") and f"<collision>{names[2]}<" in sensor


def test_a_gripper_names_the_link_that_stands_for_its_palm():
    model = kept("<gripper name='g'><palm_link>hand</palm_link></gripper>")
    assert any("<palm_link>base<" in plugin.xml for plugin in model.plugins)


def test_a_robot_without_lumped_links_keeps_its_texts():
    xml = '<plugin name="p" filename="f"><bodyName>a</bodyName></plugin>'
    model, _ = robot_of(robot_link("a") + f"<gazebo>{xml}</gazebo>")
    assert model.plugins[0].xml == xml


def test_a_joint_of_sdf_connects_what_stands_for_its_links():
    model, issues = robot_of(
        ARM + robot_link("rod") + robot_joint("turn", "base", "rod", "continuous", xyz="0 0 5")
        + '<gazebo><joint name="loop" type="revolute"><parent>rod</parent><child>hand</child>'
        "<axis><xyz>1 0 0</xyz></axis></joint></gazebo>")
    assert errors(issues) == []
    loop = next(joint for joint in model.joints if joint.name == "loop")
    assert (loop.parent, loop.child) == ("rod", "base")
    assert loop.pose.position == pytest.approx((1, 2, 3)) and loop.axis.xyz == (1, 0, 0)


def test_a_joint_of_sdf_to_no_link_is_left_out():
    model, issues = robot_of(ARM + '<gazebo><joint name="loop" type="fixed"><parent>rod</parent>'
                         "<child>hand</child></joint></gazebo>")
    assert "joint-link-unknown" in tolerated(issues) and errors(issues) == []
    assert "loop" not in [joint.name for joint in model.joints]


def test_a_joint_of_sdf_may_name_links_with_the_robot_before_them():
    loop = ('<gazebo><joint name="loop" type="fixed"><parent>r::base</parent>'
            "<child>world</child></joint></gazebo>")
    model, issues = robot_of(ARM + loop)
    assert tolerated(issues) == [] and errors(issues) == []
    assert [(one.parent, one.child) for one in model.joints] == [("world", "base")]


LOOP = ('<gazebo><plugin name="p" filename="libpegasus_gazebo_closed_loop_plugin.so">{}</plugin>'
        "</gazebo>")


def test_a_plugin_that_closes_a_loop_is_a_joint():
    model, issues = robot_of(
        ARM + robot_link("rod") + robot_joint("turn", "base", "rod", "continuous", xyz="0 0 5")
        + LOOP.format("<joint>loop</joint><parent>hand</parent><child>rod</child>"
                      "<position>1 0 0</position><rotation>0 0 0</rotation>"))
    assert errors(issues) == [] and model.plugins == []
    loop = next(joint for joint in model.joints if joint.name == "loop")
    assert (loop.type, loop.parent, loop.child) == ("revolute", "base", "rod")
    assert loop.pose.position == pytest.approx((1, 0, 0)) and loop.axis.xyz == (0, 1, 0)


def test_a_plugin_that_closes_a_loop_to_no_link_is_reported():
    model, issues = robot_of(ARM + LOOP.format("<joint>loop</joint><parent>rod</parent>"
                                               "<child>hand</child>"))
    assert "joint-link-unknown" in tolerated(issues)
    model, issues = robot_of(ARM + LOOP.format("<joint>loop</joint><child>hand</child>"))
    assert issues != [] and "loop" not in [joint.name for joint in model.joints]


def test_mimic_is_read_and_kept_with_its_numbers():
    model, issues = robot_of(
        robot_link("a") + robot_link("b") + robot_link("c") + robot_joint(
            "j", "a", "b", "continuous", '<mimic joint="k" multiplier="-2" offset="0.5"/>')
        + robot_joint("k", "a", "c", "continuous"))
    assert model.joints[0].axis.mimic == Mimic("k", -2.0, 0.5)
    assert codes(issues) == []
    text = write_entity(model).decode()
    assert text.count("<axis>") == 2 and text.count("<mimic") == 1
