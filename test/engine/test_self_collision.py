"""Which links of one model rest on each other (SDF 1.7, link/self_collide; Gazebo's ODE)."""
from __future__ import annotations

from dataclasses import replace
from typing import Optional

import pytest
from conftest import Lab, ground, inertial_of_box, link_of

from my_simulations.description.flatten import flatten_model
from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.shapes import Box
from my_simulations.description.unflatten import unflatten_model
from my_simulations.geometry import Pose

SIDE = 0.2
RESTS = 0.3   # m, of the upper one's centre on the lower one
FALLS = 0.1   # m, on the ground


def cube(name: str, height: float, own: Optional[bool] = None) -> Link:
    link = link_of(Box((SIDE,) * 3), inertial_of_box(1.0, SIDE, SIDE, SIDE), None, name,
                   Pose((0.0, 0.0, height)))
    return replace(link, self_collide=own)


def height_of_upper(lab: Lab, model: Model) -> float:
    lab.configure(gravity=(0.0, 0.0, -9.8))
    lab.load(ground())
    number = lab.load(model)
    lab.seconds(1.0)
    return lab.pose(number, "upper").position[2]


@pytest.mark.parametrize("whole,lower,upper,expected", [
    (False, None, None, FALLS), (True, None, None, RESTS),
    (False, True, True, RESTS), (False, True, None, RESTS), (False, False, True, RESTS),
    (True, False, False, FALLS), (True, False, None, RESTS)])
def test_free_links_collide_where_one_of_them_asks(lab: Lab, whole: bool, lower: Optional[bool],
                                                   upper: Optional[bool], expected: float):
    model = Model("pair", self_collide=whole, allow_auto_disable=False,
                  links=[cube("lower", 0.1, lower), cube("upper", 0.4, upper)])
    assert height_of_upper(lab, model) == pytest.approx(expected, abs=0.005)


def lift(whole: bool, lower: Optional[bool], upper: Optional[bool]) -> Model:
    """A tree: the upper cube slides down a long mast that stands on the lower cube's base."""
    mast = Link("mast", Pose((0.5, 0.0, 0.1)), Inertial(50.0, Pose(), 1, 0, 0, 1, 0, 1))
    slide = JointAxis((0.0, 0.0, 1.0))
    return Model("lift", self_collide=whole,
                 links=[mast, cube("lower", 0.1, lower), cube("upper", 0.4, upper)],
                 joints=[Joint("stand", "fixed", "world", "mast"),
                         Joint("foot", "fixed", "mast", "lower"),
                         Joint("slide", "prismatic", "mast", "upper", axis=slide)])


@pytest.mark.parametrize("whole,lower,upper,expected", [
    (False, None, None, FALLS), (True, None, None, RESTS), (False, True, True, RESTS),
    (False, True, False, RESTS), (True, False, False, FALLS)])
def test_links_of_a_tree_collide_where_one_of_them_asks(lab: Lab, whole: bool,
                                                        lower: Optional[bool],
                                                        upper: Optional[bool], expected: float):
    assert height_of_upper(lab, lift(whole, lower, upper)) == pytest.approx(expected, abs=0.005)


def test_links_that_a_joint_connects_never_collide(lab: Lab):
    slide = JointAxis((0.0, 0.0, 1.0))
    knuckle = Model("knuckle", self_collide=True, links=[cube("lower", 0.1), cube("upper", 0.15)],
                    joints=[Joint("hold", "fixed", "world", "lower"),
                            Joint("turn", "universal", "lower", "upper", axis=slide,
                                  axis2=JointAxis((1.0, 0.0, 0.0)))])
    lab.configure(gravity=(0.0, 0.0, 0.0))
    number = lab.load(knuckle)
    lab.seconds(0.2)
    assert lab.pose(number, "upper").orientation == pytest.approx((0, 0, 0, 1), abs=1e-9)
    assert lab.joint(number, "turn")[1] == pytest.approx(0.0, abs=1e-9)


def test_a_removed_model_leaves_the_next_one_its_own_rule(lab: Lab):
    free = [cube("lower", 0.1, False), cube("upper", 0.4, False)]
    lab.configure(gravity=(0.0, 0.0, -9.8))
    lab.load(ground())
    lab.remove(lab.load(Model("apart", links=free)))
    number = lab.load(Model("pair", self_collide=True, allow_auto_disable=False,
                            links=[cube("lower", 0.1), cube("upper", 0.4)]))
    lab.seconds(1.0)
    assert lab.pose(number, "upper").position[2] == pytest.approx(RESTS, abs=0.005)


@pytest.mark.parametrize("outer,inner,expected", [(False, True, RESTS), (True, False, FALLS)])
def test_links_of_a_nested_model_do_what_their_own_model_says(lab: Lab, outer: bool, inner: bool,
                                                              expected: float):
    inside = Model("inside", self_collide=inner, links=[cube("lower", 0.1), cube("upper", 0.4)])
    whole = Model("whole", self_collide=outer, allow_auto_disable=False, models=[inside])
    flat = flatten_model(whole)
    assert unflatten_model(flat) == whole
    lab.configure(gravity=(0.0, 0.0, -9.8))
    lab.load(ground())
    number = lab.load(flat)
    lab.seconds(1.0)
    assert lab.pose(number, "inside::upper").position[2] == pytest.approx(expected, abs=0.005)
