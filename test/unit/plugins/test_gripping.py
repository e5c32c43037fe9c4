"""Plugins that hold objects, in a world without physics."""
from __future__ import annotations

from dataclasses import replace

import pytest

from my_simulations.description.model import Link, Model
from my_simulations.engine.commands import Contact
from my_simulations.geometry import Pose
from my_simulations.plugins.context import PluginError
from my_simulations.plugins.gripping.grasp_fix import GraspFix
from my_simulations.plugins.gripping.link_attacher import LinkAttacher
from my_simulations.plugins.gripping.vacuum_gripper import VacuumGripper
from my_simulations.plugins.testing import FakeContext, Message

ARM = """<plugin><arm><arm_name>arm</arm_name><palm_link>palm</palm_link>
<gripper_link> left </gripper_link><gripper_link>right</gripper_link></arm>
<forces_angle_tolerance>100</forces_angle_tolerance><update_rate>10</update_rate>
<grip_count_threshold>3</grip_count_threshold><release_tolerance>0.002</release_tolerance>
</plugin>"""


def world(context):
    context.others = {"robot": Model("robot", links=[Link("palm")]),
                      "cube": Model("cube", links=[Link("link")]),
                      "table": Model("table", static=True, links=[Link("top")])}
    context.model_link("cube::link").pose = Pose((0.03, 0.0, 0.0))
    context.model_link("table::top").pose = Pose((0.01, 0.0, 0.0))


def test_a_vacuum_gripper_holds_what_is_near_while_it_is_on():
    context = FakeContext("<plugin><bodyName>palm</bodyName><topicName>grasping</topicName>"
                          "<robotNamespace>/r</robotNamespace></plugin>")
    world(context)
    VacuumGripper(context).load()
    context.advance(0.1)
    assert not context.attached and context.published["r/grasping"][-1].data is False
    context.services["r/on"](None, None)
    context.advance(0.1)
    assert list(context.attached.values()) == [("robot::palm", "cube::link")]
    assert context.published["r/grasping"][-1].data is True
    context.services["r/on"](None, None)
    assert context.log_messages == ["it is on already"]
    context.services["r/off"](None, None)
    context.advance(0.1)
    assert not context.attached and context.published["r/grasping"][-1].data is False


def test_a_vacuum_gripper_does_not_reach_further_than_5_cm():
    context = FakeContext("<plugin><bodyName>palm</bodyName><topicName>t</topicName></plugin>")
    world(context)
    context.model_link("cube::link").pose = Pose((0.051, 0.0, 0.0))
    VacuumGripper(context).load()
    context.services["on"](None, None)
    context.advance(0.1)
    assert not context.attached


def press(one, other, normal, force=5.0):
    return (one, other, Contact(0, 1, (0.0, 0.0, 0.0), normal, 0.0, force))


def squeezed(other="cube::link"):
    """The normal points from the second link to the first; one contact names the cube first."""
    return [press("robot::left", other, (0.0, 1.0, 0.0)),
            press(other, "robot::right", (0.0, 1.0, 0.0))]


@pytest.fixture
def gripper():
    context = FakeContext(ARM, links=("palm", "left", "right"))
    world(context)
    GraspFix(context).load()
    return context


def test_what_is_pressed_from_opposite_sides_is_fixed_to_the_palm(gripper):
    gripper.touching = squeezed()
    gripper.advance(0.3)
    assert not gripper.attached
    gripper.advance(0.1)
    assert gripper.attached == {"robot::arm::grasp": ("robot::palm", "cube::link")}


@pytest.mark.parametrize("touching", [
    [press("robot::left", "cube::link", (0.0, 1.0, 0.0))],
    [press("robot::left", "cube::link", (0.0, 1.0, 0.0)),
     press("robot::right", "cube::link", (1.0, 0.5, 0.0))],
    [press("robot::left", "cube::link", (0.0, 1.0, 0.0)),
     press("cube::link", "robot::right", (0.0, 1.0, 0.0), 0.01)],
    [press("robot::left", "cube::link", (0.0, 1.0, 0.0)),
     press("cube::link", "robot::palm", (0.0, 1.0, 0.0))],
    squeezed("table::top"), squeezed("robot::other")])
def test_one_side_or_what_cannot_move_is_not_held(gripper, touching):
    gripper.touching = touching
    gripper.advance(2.0)
    assert not gripper.attached


@pytest.mark.parametrize("said, looks", [
    ("", 6), ("<max_grip_count>4</max_grip_count>", 3),
    ("<grip_count_threshold>12</grip_count_threshold>", 13)])
def test_more_than_half_of_the_most_counts_hold(said, looks):
    context = FakeContext(ARM.replace("<grip_count_threshold>3</grip_count_threshold>", said),
                          links=("palm", "left", "right"))
    world(context)
    GraspFix(context).load()
    context.touching = squeezed()
    for look in range(1, looks + 1):
        assert not context.attached, look
        context.advance(0.1)
    assert context.attached


def test_a_short_loss_of_contact_costs_a_count(gripper):
    gripper.touching = squeezed()
    gripper.advance(0.3)
    gripper.touching = []
    gripper.advance(0.1)
    gripper.touching = squeezed()
    gripper.advance(0.1)
    assert not gripper.attached
    gripper.advance(0.1)
    assert gripper.attached


def test_a_grip_whose_contacts_flicker_holds(gripper):
    """Fingers in turn, none of them at the moment of a look, as OnContact of the original."""
    one, other = squeezed()
    gripper.touching = squeezed()
    gripper.advance(0.1)
    for _ in range(3):
        for touching in ([one], [other], [], []):
            gripper.touching = touching
            gripper.advance(0.025)
    assert gripper.attached


def test_an_object_that_was_deleted_and_spawned_again_is_held_again(gripper):
    """The joint ended with the first object, and no update found its model missing."""
    gripper.touching = squeezed()
    gripper.advance(0.4)
    gripper.attached.clear()
    gripper.advance(0.4)
    assert gripper.attached


def test_an_object_that_is_held_again_after_a_restore_is_released(gripper):
    """The joint is a part of a saved state; what the plugin knows is not."""
    gripper.attached["robot::arm::grasp"] = ("robot::palm", "cube::link")
    gripper.touching = squeezed()
    gripper.advance(0.2)
    gripper.touching = []
    gripper.advance(0.2)
    assert gripper.attached
    gripper.links["left"].pose = Pose((0.0, 0.003, 0.0))
    gripper.advance(0.1)
    assert not gripper.attached


def test_an_object_that_is_deleted_in_the_moment_of_the_grasp_is_not_held(gripper):
    def refuse(name, parent, child):
        raise PluginError(f"there is no link '{child}'")

    gripper.touching, attach = squeezed(), gripper.attach
    gripper.attach = refuse
    gripper.advance(0.4)
    assert "cannot hold cube::link" in gripper.log_messages[-1]
    gripper.attach = attach
    gripper.advance(0.1)
    assert gripper.attached


def test_what_is_deleted_between_two_looks_is_not_held(gripper):
    gripper.touching = squeezed()
    gripper.advance(0.35)
    gripper.touching = []
    del gripper.others["cube"]
    gripper.advance(0.1)
    assert not gripper.attached


def test_forces_are_those_of_the_mean_of_a_look(gripper):
    """A finger that just touched in the step of the look pressed before."""
    one, other = squeezed()
    weak = (*other[:2], replace(other[2], force=0.01))
    for _ in range(5):
        gripper.touching = [one, other]
        gripper.advance(0.095)
        gripper.touching = [one, weak]
        gripper.advance(0.005)
    assert gripper.attached


def test_contacts_are_read_at_looks_alone_while_nothing_is_touched(gripper):
    read = []
    gripper.contacts = lambda: read.append(gripper.step) or gripper.touching
    gripper.advance(1.0)
    assert read == list(range(100, 1001, 100))
    gripper.touching = squeezed()
    gripper.advance(0.4)
    assert gripper.attached
    del read[:]
    gripper.advance(1.0)
    assert read == []


def test_collisions_that_a_gripper_cannot_switch_off_are_told():
    context = FakeContext(ARM.replace("<arm>", "<disable_collisions_on_attach>true"
                                      "</disable_collisions_on_attach><arm>"),
                          links=("palm", "left", "right"))
    GraspFix(context).load()
    assert "disable_collisions_on_attach" in context.log_messages[-1]


def test_an_opened_finger_lets_go_and_a_closing_one_does_not(gripper):
    gripper.touching = squeezed()
    gripper.advance(0.4)
    gripper.touching = []
    gripper.links["left"].pose = Pose((0.0, -0.01, 0.0))  # it presses along -y
    gripper.advance(0.1)
    assert gripper.attached
    gripper.links["left"].pose = Pose((0.0, 0.003, 0.0))
    gripper.advance(0.1)
    assert not gripper.attached and "lets go" in gripper.log_messages[-1]


def test_a_gripper_without_an_arm_is_the_users_fault():
    with pytest.raises(PluginError, match="no <arm>"):
        GraspFix(FakeContext("<plugin/>")).load()
    context = FakeContext(ARM.replace("palm<", "nowhere<"), links=("palm",))
    with pytest.raises(PluginError, match="none of its <arm>s"):
        GraspFix(context).load()
    assert "no link 'nowhere'" in context.log_messages[-1]


@pytest.mark.parametrize("bad", [
    "<arm><arm_name>b</arm_name><palm_link>none</palm_link><gripper_link>left</gripper_link></arm>",
    "<arm><arm_name>b</arm_name><palm_link>palm</palm_link><gripper_link>none</gripper_link></arm>",
    "<arm><arm_name>b</arm_name></arm>"])
def test_an_arm_or_a_finger_that_is_not_there_leaves_the_others_holding(bad):
    """The original logs an error and continues."""
    finger = ARM.replace("</arm>", "<gripper_link>gone</gripper_link></arm>")
    context = FakeContext(finger.replace("<arm>", bad + "<arm>", 1),
                          links=("palm", "left", "right"))
    world(context)
    GraspFix(context).load()
    assert len(context.log_messages) >= 2
    context.touching = squeezed()
    context.advance(0.4)
    assert list(context.attached) == ["robot::arm::grasp"]


def test_a_second_arm_of_a_name_is_left_out():
    """It would take away what the first one holds."""
    arm = ARM[ARM.index("<arm>"):ARM.index("</arm>") + 6]
    context = FakeContext(ARM.replace(arm, arm + arm), links=("palm", "left", "right"))
    world(context)
    GraspFix(context).load()
    assert "there is an arm 'arm' already" in context.log_messages[-1]


def test_the_link_attacher_attaches_and_detaches_by_the_same_names():
    context = FakeContext()
    LinkAttacher(context).load()
    attach, detach = (context.services[f"/link_attacher_node/{name}"]
                      for name in ("attach", "detach"))
    request = Message(model_name_1="a", link_name_1="b", model_name_2="c", link_name_2="d")
    response = Message()
    attach(request, response)
    assert response.ok and list(context.attached.values()) == [("a::b", "c::d")]
    detach(request, response)
    assert response.ok and not context.attached
    detach(request, response)
    assert not response.ok and "not attached" in context.log_messages[-1]


def test_the_link_attacher_holds_a_link_in_the_world():
    context = FakeContext()
    LinkAttacher(context).load()
    set_static = context.services["/link_attacher_node/setstatic"]
    response = Message()
    set_static(Message(model_name="a", link_name="b", set_static=True), response)
    assert response.ok and list(context.attached.values()) == [("world", "a::b")]
    set_static(Message(model_name="a", link_name="b", set_static=False), response)
    assert response.ok and not context.attached


def test_a_gripper_in_a_nested_model_holds():
    """Contacts have the names that links have in the world."""
    gripper = FakeContext(ARM, links=("palm", "left", "right"))
    gripper.scoped = lambda link: f"robot::hand::{link}"
    world(gripper)
    GraspFix(gripper).load()
    gripper.touching = [(one.replace("robot::", "robot::hand::"),
                         other.replace("robot::", "robot::hand::"), contact)
                        for one, other, contact in squeezed()]
    gripper.advance(0.4)
    assert gripper.attached == {"robot::hand::arm::grasp": ("robot::hand::palm", "cube::link")}
