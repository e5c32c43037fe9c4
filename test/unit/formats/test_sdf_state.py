"""Saved states: read, and applied to the world."""
import math

import pytest
from reading import INERTIAL, errors, warnings, world_of

from my_simulations.description.shapes import Box, Sphere
from my_simulations.formats.sdf.state_applied import apply_state
from my_simulations.geometry import Pose, Twist, quat_from_rpy

BOX = '<collision name="c"><geometry><box><size>1 2 3</size></box></geometry></collision>'
WORLD = (
    f'<model name="box"><pose>1 0 0 0 0 0</pose><link name="l">{INERTIAL}{BOX}</link>'
    f'<link name="k"><pose>0 1 0 0 0 0</pose>{INERTIAL}</link></model>'
    f'<model name="door"><link name="frame">{INERTIAL}</link><link name="leaf">'
    f"<pose>0.5 0 0 0 0 0</pose>{INERTIAL}</link>"
    '<joint name="hinge" type="revolute"><parent>frame</parent><child>leaf</child>'
    "<pose>-0.5 0 0 0 0 0</pose><axis><xyz>0 0 1</xyz></axis></joint></model>"
    f'<model name="gone"><link name="l">{INERTIAL}</link></model>'
    '<light name="lamp"><pose>0 0 1 0 0 0</pose></light>'
)


def world_with(state):
    return world_of(WORLD + f'<state world_name="w">{state}</state>')


def applied(state):
    world, issues = world_with(state)
    assert errors(issues) == []
    return apply_state(world), issues


def model_named(world, name):
    return next(model for model in world.models if model.name == name)


def test_a_state_is_read():
    world, issues = world_with(
        "<sim_time>12 964000000</sim_time><real_time>13 5</real_time><iterations>12964</iterations>"
        '<model name="box"><pose frame="">1 2 3 0 0 0</pose><scale>2 2 2</scale><link name="l">'
        "<pose>1 2 3 0 0 0</pose><velocity>1 0 0 0 0 2</velocity><acceleration>0 0 0 0 0 0"
        "</acceleration></link></model>")
    state = world.state
    assert issues == [] and state.world_name == "w"
    assert (state.sim_time_ns, state.real_time_ns, state.iterations) == (
        12964000000, 13000000005, 12964)
    model = state.models[0]
    assert (model.pose.position, model.scale) == ((1, 2, 3), (2, 2, 2))
    assert model.links[0].twist == Twist((1, 0, 0), (0, 0, 2))


def test_a_state_moves_the_links_of_a_model_without_joints():
    world, _ = applied(
        '<sim_time>3 500</sim_time><model name="box"><pose>4 0 0 0 0 0</pose><link name="l"><pose>'
        '4 0 1 0 0 0</pose><velocity>0 0 1 0 0 0</velocity></link><link name="k"><pose>4 5 0 0 0 0'
        "</pose></link></model>")
    box = model_named(world, "box")
    assert box.pose.position == (4, 0, 0)
    assert [link.pose.position for link in box.links] == [(0, 0, 1), (0, 5, 0)]
    assert world.initial_ns == 3000000500
    assert world.initial["box"].twists == {"l": Twist((0, 0, 1), (0, 0, 0))}
    assert world.state is None and not any("<state" in xml for xml in world.extra)


def test_a_world_without_state_stays_the_same():
    world, _ = world_of(WORLD)
    assert apply_state(world) is world


def test_a_state_gives_joints_the_positions_of_their_links():
    turn = math.radians(100)
    world, _ = applied(
        '<model name="door"><pose>2 0 0 0 0 0</pose><link name="frame"><pose>2 0 0 0 0 0</pose>'
        f'</link><link name="leaf"><pose>{2 + 0.5 * math.cos(turn)} {0.5 * math.sin(turn)} 0 0 0'
        f" {turn}</pose></link></model>")
    door = model_named(world, "door")
    assert world.initial["door"].joints == {"hinge": pytest.approx(turn)}
    assert door.pose.position == pytest.approx((2, 0, 0))
    assert door.links[1].pose == Pose((0.5, 0, 0))  # the configuration at 0 stays


def test_a_model_with_joints_stands_where_its_first_link_does():
    world, _ = applied(
        '<model name="door"><pose>0 0 0 0 0 0</pose><link name="frame"><pose>0 3 0 0 0 1</pose>'
        "</link></model>")
    door = model_named(world, "door")
    assert door.pose.position == (0, 3, 0)
    assert door.pose.orientation == pytest.approx(quat_from_rpy(0, 0, 1))


def test_the_angle_of_a_joint_counts_where_links_are_not_given():
    world, _ = applied('<model name="door"><joint name="hinge"><angle axis="0">0.25</angle>'
                       "</joint></model>")
    assert world.initial["door"].joints == {"hinge": 0.25}


def test_a_scale_makes_the_shapes_larger():
    world, _ = applied('<model name="box"><scale>2 3 0.5</scale></model>')
    assert model_named(world, "box").links[0].collisions[0].geometry == Box((2, 6, 1.5))


def test_insertions_come_and_deletions_go():
    world, issues = applied(
        '<insertions><model name="ball"><link name="l"><collision name="c"><geometry><sphere/>'
        '</geometry></collision></link></model><light name="spot"/></insertions>'
        '<model name="ball"><pose>0 0 7 0 0 0</pose></model>'
        "<deletions><name>gone</name></deletions>"
        '<light name="lamp"><pose>0 0 9 0 0 0</pose></light>')
    assert [model.name for model in world.models] == ["box", "door", "ball"]
    ball = model_named(world, "ball")
    assert ball.pose.position == (0, 0, 7)
    assert ball.links[0].collisions[0].geometry == Sphere()
    assert {light.name: light.pose.position for light in world.lights} == {
        "lamp": (0, 0, 9), "spot": (0, 0, 0)}
    assert warnings(issues) == []


def test_names_that_the_world_does_not_have_are_a_warning():
    world, issues = applied('<model name="nobody"/><deletions><name>nothing</name></deletions>')
    assert warnings(issues) == ["state-unknown"] * 2
    assert len(world.models) == 3


def test_links_that_no_joint_connects_with_the_first_one_stand_where_they_stood():
    cart = (f'<model name="cart"><link name="base">{INERTIAL}</link><link name="loose">'
            f"<pose>0 3 0 0 0 0</pose>{INERTIAL}</link>"
            f'<link name="wheel"><pose>1 0 0 0 0 0</pose>{INERTIAL}</link>'
            f'<link name="stand"><pose>0 5 0 0 0 0</pose>{INERTIAL}</link>'
            f'<link name="flag"><pose>0 5 1 0 0 0</pose>{INERTIAL}</link>'
            '<joint name="axle" type="revolute"><parent>base</parent><child>wheel</child>'
            '<axis><xyz>0 1 0</xyz></axis></joint>'
            '<joint name="pole" type="revolute"><parent>stand</parent><child>flag</child>'
            '<axis><xyz>0 0 1</xyz></axis></joint></model>')
    world, issues = world_of(
        cart + '<state world_name="w"><model name="cart"><pose>2 0 0 0 0 0</pose>'
        '<link name="base"><pose>2 0 0 0 0 0</pose></link>'
        '<link name="loose"><pose>7 7 7 0 0 0</pose></link>'
        '<link name="stand"><pose>0 9 0 0 0 0</pose></link>'
        '<link name="flag"><pose>0 9 1 0 0 0.5</pose></link></model></state>')
    assert errors(issues) == []
    world = apply_state(world)
    model = model_named(world, "cart")
    assert model.pose.position == (2, 0, 0)
    assert {link.name: link.pose.position for link in model.links} == {
        "base": (0, 0, 0), "loose": (5, 7, 7), "wheel": (1, 0, 0), "stand": (-2, 9, 0),
        "flag": (-2, 9, 1)}
    assert world.initial["cart"].joints == pytest.approx({"pole": 0.5})
