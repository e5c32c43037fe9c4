"""The `<gripper>` of a model, in a world without physics."""
from __future__ import annotations

import pytest

from my_simulations.description.model import Link, Model
from my_simulations.engine.commands import Contact
from my_simulations.geometry import Pose
from my_simulations.plugins.context import PluginError
from my_simulations.plugins.gripping.sdf_gripper import SdfGripper
from my_simulations.plugins.testing import FakeContext

UPDATE = 0.75
JOINT = {"robot::hand::gripper": ("robot::palm", "cube::link")}


def element(steps="<attach_steps>2</attach_steps><detach_steps>3</detach_steps>",
            links=("left", "right"), palm="<palm_link>palm</palm_link>"):
    fingers = "".join(f"<gripper_link>{link}</gripper_link>" for link in links)
    return (f"<gripper name='hand'><grasp_check>{steps}</grasp_check>{fingers}{palm}"
            "</gripper>")


def touch(*fingers, other="cube::link", force=5.0):
    return [(f"robot::{finger}", other, Contact(0, 1, (0.0, 0.0, 0.0), (0.0, 1.0, 0.0), 0.0, force))
            for finger in fingers]


def context_of(xml):
    context = FakeContext(xml, links=("palm", "left", "right"))
    context.others = {"robot": Model("robot", links=[Link("palm")]),
                      "cube": Model("cube", links=[Link("link")]),
                      "table": Model("table", static=True, links=[Link("top")])}
    SdfGripper(context).load()
    return context


def updates(context, count):
    context.advance(count * UPDATE)


@pytest.fixture
def hand():
    return context_of(element())


def hold(context):
    context.touching = touch("left", "right")
    updates(context, 3)
    assert context.attached == JOINT


def test_the_third_update_with_contact_holds_and_the_fourth_without_releases(hand):
    hand.touching = touch("left", "right")
    updates(hand, 2)
    assert not hand.attached
    updates(hand, 1)
    assert hand.attached == JOINT and "holds cube::link" in hand.log_messages[-1]
    hand.touching = []
    updates(hand, 3)
    assert hand.attached
    updates(hand, 1)
    assert not hand.attached and "lets go of cube::link" in hand.log_messages[-1]


@pytest.mark.parametrize("steps, attach, detach", [
    ("", 21, 41), ("<attach_steps>0</attach_steps><detach_steps>0</detach_steps>", 2, 1)])
def test_the_steps_of_a_file_and_their_defaults(steps, attach, detach):
    context = context_of(element(steps))
    context.touching = touch("left", "right")
    updates(context, attach - 1)
    assert not context.attached
    updates(context, 1)
    assert context.attached
    context.touching = []
    updates(context, detach - 1)
    assert context.attached
    updates(context, 1)
    assert not context.attached


@pytest.mark.parametrize("touching", [
    touch("left"), touch("left", "palm"), touch("left", "right", other="table::top"),
    touch("left", "right", other="robot::arm"), touch("left", "right", force=0.0)])
def test_one_link_or_an_object_that_cannot_move_is_not_held(hand, touching):
    hand.touching = touching
    updates(hand, 8)
    assert not hand.attached


@pytest.mark.parametrize("least, links, touched", [
    (1, ("left", "right"), ("left",)), (2, ("left",), ("left",)),
    (20, ("left", "right", "palm"), ("left", "right"))])
def test_a_count_of_contacts_needs_two_links_at_most(least, links, touched):
    context = context_of(element("<attach_steps>1</attach_steps>"
                                 f"<min_contact_count>{least}</min_contact_count>", links))
    context.touching = touch(*touched)
    updates(context, 2)
    assert context.attached


def test_an_object_that_slides_in_the_hand_is_held_when_it_rests(hand):
    hand.touching = touch("left", "right")
    for step in range(6):
        hand.model_link("cube::link").pose = Pose((0.004 * step, 0.0, 0.0))
        updates(hand, 1)
    assert not hand.attached
    hand.link("palm").pose = Pose((0.0, 0.0, 1.0))   # the arm moves it
    hand.model_link("cube::link").pose = Pose((0.02, 0.0, 1.0))
    updates(hand, 1)
    assert hand.attached


def test_a_short_loss_of_contact_costs_a_count_and_does_not_release(hand):
    hand.touching = touch("left", "right")
    updates(hand, 2)
    hand.touching = []
    updates(hand, 1)
    hand.touching = touch("left", "right")
    updates(hand, 1)
    assert not hand.attached
    updates(hand, 1)
    assert hand.attached
    for _ in range(3):
        hand.touching = []
        updates(hand, 2)
        hand.touching = touch("left", "right")
        updates(hand, 1)
    assert hand.attached


def test_links_that_touch_in_turn_between_two_updates_hold(hand):
    hand.touching = touch("left", "right")
    updates(hand, 1)
    for _ in range(2):
        for touching, seconds in ((touch("left"), 0.3), (touch("right"), 0.45)):
            hand.touching = touching
            hand.advance(seconds)
    assert hand.attached


def test_a_held_object_that_is_deleted_and_spawned_again_is_held_again(hand):
    hold(hand)
    updates(hand, 1)
    hand.attached.clear()   # with the first object
    updates(hand, 2)
    assert not hand.attached
    updates(hand, 1)
    assert hand.attached


def test_an_object_that_is_held_again_after_a_restore_is_released(hand):
    hand.attached.update(JOINT)
    hand.touching = touch("left", "right")
    updates(hand, 5)
    assert hand.attached
    hand.touching = []
    updates(hand, 4)
    assert not hand.attached


def test_a_reset_begins_to_count_again():
    context = FakeContext(element(), links=("palm", "left", "right"))
    context.others = {"cube": Model("cube", links=[Link("link")])}
    plugin = SdfGripper(context)
    plugin.load()
    hold(context)
    context.attached.clear()
    plugin.reset()
    updates(context, 2)
    assert not context.attached
    updates(context, 1)
    assert context.attached


def test_contacts_are_read_once_an_update_while_nothing_is_touched(hand):
    read = []
    hand.contacts = lambda: read.append(hand.step) or hand.touching
    hand.advance(3.0)
    assert read == [750, 1500, 2250, 3000]


@pytest.mark.parametrize("xml, message", [
    (element(palm=""), "no <palm_link>"), (element(links=()), "no <gripper_link>"),
    (element(links=("left", "gone")), "no link 'gone'"),
    (element(palm="<palm_link>gone</palm_link>"), "no link 'gone'")])
def test_a_missing_link_is_the_users_fault(xml, message):
    with pytest.raises(PluginError, match=message):
        context_of(xml)


def test_steps_that_are_no_number_are_reported_and_the_default_acts():
    context = context_of(element("<attach_steps>few</attach_steps>"))
    assert "<attach_steps> must be a whole number" in context.log_messages[0]
