"""Faults of a model, whatever it came from."""
import math

import pytest

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.shapes import (
    Box,
    Collision,
    Cylinder,
    Empty,
    Mesh,
    Plane,
    Sphere,
    Visual,
)
from my_simulations.description.validate import geometry_fault, has_zero_size, validate
from my_simulations.errors import Severity, errors_of
from my_simulations.geometry import Pose

NAN = math.nan
NOWHERE = Pose((NAN, 0.0, 0.0))


def codes(model):
    return [issue.code for issue in validate(model)]


def model(*links, joints=(), **options):
    return Model("m", links=list(links or [Link("a"), Link("b")]), joints=list(joints), **options)


def test_a_sound_model_has_no_fault():
    joint = Joint("j", "revolute", "a", "b", axis=JointAxis())
    assert validate(model(joints=[joint])) == []


@pytest.mark.parametrize("faulty, code", [
    (Model(""), "name-empty"),
    (model(pose=NOWHERE), "pose-not-finite"),
    (model(Link("")), "name-empty"),
    (model(Link("a"), Link("a")), "name-repeated"),
    (model(Link("a", NOWHERE)), "pose-not-finite"),
    (model(Link("world")), "name-reserved"),
    (model(Link("a", inertial=Inertial(mass=0.0))), "mass-not-positive"),
    (model(Link("a", inertial=Inertial(mass=NAN))), "inertia-not-finite"),
    (model(Link("a", inertial=Inertial(ixx=math.inf))), "inertia-not-finite"),
    (model(Link("a", inertial=Inertial(ixx=-1.0))), "inertia-not-positive"),
    (model(Link("a", inertial=Inertial(iyz=1.0))), "inertia-not-positive"),
    (model(Link("a", collisions=[Collision("c", Box((1, 0, 1)))])), "bad-shape"),
    (model(Link("a", collisions=[Collision("c", Box(), NOWHERE)])), "bad-shape"),
    (model(joints=[Joint("", "fixed", "a", "b")]), "name-empty"),
    (model(joints=[Joint("j", "fixed", "a", "c")]), "joint-link-unknown"),
    (model(joints=[Joint("j", "fixed", "a", "world")]), "joint-link-unknown"),
    (model(joints=[Joint("j", "fixed", "", "b")]), "joint-link-missing"),
    (model(joints=[Joint("j", "fixed", "b", "b")]), "joint-link-repeated"),
    (model(joints=[Joint("j", "fixed", "a", "b", NOWHERE)]), "pose-not-finite"),
    (model(joints=[Joint("j", "revolute", "a", "b")]), "joint-axis-missing"),
    (model(joints=[Joint("j", "revolute", "a", "b", axis=JointAxis((0, 0, 0)))]),
     "joint-axis-zero"),
    (model(joints=[Joint("j", "revolute", "a", "b", axis=JointAxis(lower=NAN))]),
     "joint-not-finite"),
    (model(models=[Model("n"), Model("n")]), "name-repeated"),
    (model(models=[model(Link("a", inertial=Inertial(mass=-1.0)))]), "mass-not-positive"),
])
def test_each_fault_is_an_error_of_its_own_code(faulty, code):
    assert [issue.code for issue in errors_of(validate(faulty))] == [code]


def test_a_static_model_may_have_any_inertia_and_so_may_those_inside_it():
    bad = Link("a", inertial=Inertial(mass=0.0, ixx=0.0))
    assert validate(model(bad, static=True, models=[model(bad)])) == []


def test_a_joint_may_hold_to_the_world_and_to_nested_links():
    inner = Model("n", links=[Link("l")])
    joints = [Joint("j", "fixed", "world", "a"), Joint("k", "fixed", "a", "n::l")]
    assert validate(model(joints=joints, models=[inner])) == []


@pytest.mark.parametrize("faulty, code", [
    (model(Link("a", inertial=Inertial(ixx=1.0, iyy=1.0, izz=3.0))), "inertia-impossible"),
    (model(Link("a", visuals=[Visual("v", Sphere(-1.0))])), "bad-shape"),
    (model(canonical_link="gone"), "link-unknown"),
    (model(joints=[Joint("j", "revolute", "a", "b", axis=JointAxis(lower=1, upper=0))]),
     "joint-limits-reversed"),
])
def test_what_gazebo_would_bear_is_a_warning(faulty, code):
    assert [(i.code, i.severity) for i in validate(faulty)] == [(code, Severity.WARNING)]


def test_the_inertia_of_a_thin_rod_and_of_a_plate_is_possible():
    rod = Inertial(ixx=1e-9, iyy=1.0, izz=1.0)
    plate = Inertial(ixx=0.5, iyy=0.5, izz=1.0)
    assert validate(model(Link("a", inertial=rod), Link("b", inertial=plate))) == []


@pytest.mark.parametrize("geometry, fine", [
    (Box(), True), (Box((1, -1, 1)), False), (Box((1, NAN, 1)), False), (Sphere(0.0), False),
    (Cylinder(0.0, 1.0), False), (Cylinder(1.0, 0.0), False), (Plane(), True),
    (Plane((0, 0, 0)), False), (Mesh(scale=(-1, 1, 1)), True), (Mesh(scale=(1, 0, 1)), False),
    (Empty(), True),
])
def test_the_numbers_of_shapes_are_checked(geometry, fine):
    assert (geometry_fault(geometry) == "") is fine


def test_flat_shapes_are_told_from_negative_ones():
    assert has_zero_size(Box((1, 0, 1))) and has_zero_size(Sphere(0.0))
    assert not has_zero_size(Box((0, -1, 1))) and not has_zero_size(Box())


def test_a_reader_adds_the_place():
    faulty = model(Link("a", inertial=Inertial(mass=0.0)))
    (issue,) = validate(faulty, lambda subject: {"file": "f", "line": 7})
    assert (issue.file, issue.line) == ("f", 7)
