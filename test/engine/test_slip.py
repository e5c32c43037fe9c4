"""Force-dependent slip, against v = slip F."""
from __future__ import annotations

import math
from dataclasses import replace

import pytest
from conftest import Lab, inertial_of_box, link_of
from laws import Laws

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.shapes import Box, Collision, Cylinder, Surface
from my_simulations.engine.commands import FOREVER, ReadContacts
from my_simulations.engine.drive_commands import JointMotor, SetMotors, SetWheelSlips, WheelSlip
from my_simulations.engine.timed_forces import AddTimedForces, TimedWrench
from my_simulations.geometry import Pose, quat_from_rpy

G = 9.8


def _floor(lab: Lab, surface: Surface = Surface()) -> None:
    lab.load(Model("floor", static=True, links=[link_of(Box((60, 60, 1)), Inertial(), surface)]),
             (0, 0, -0.5))


def _plate(lab: Lab, surface: Surface, y: float = 0.0, mass: float = 2.0, jointed: bool = False,
           yaw: float = 0.0) -> int:
    inertial = inertial_of_box(mass, 0.4, 0.4, 0.1)
    model = Model(f"plate{y}", links=[link_of(Box((0.4, 0.4, 0.1)), inertial, surface)],
                  allow_auto_disable=False)
    if jointed:
        half = replace(inertial, mass=mass / 2, ixx=inertial.ixx / 2, iyy=inertial.iyy / 2,
                       izz=inertial.izz / 2)
        model = replace(model, links=[replace(model.links[0], inertial=half),
                                      Link("rider", inertial=half)],
                        joints=[Joint("mount", "fixed", "link", "rider")])
    return lab.load(model, (0, y, 0.05), quat_from_rpy(0, 0, yaw))


def _pull(lab: Lab, plate: int, force: "tuple[float, float, float]") -> None:
    lab.apply(AddTimedForces((TimedWrench(plate, lab.rows[plate, "link"], lab.step, FOREVER,
                                          force),)))


@pytest.mark.parametrize("jointed", [False, True])
@pytest.mark.parametrize("slip", [0.003, 0.02, 0.3])
def test_what_is_pulled_slips_by_its_slip_times_the_force(lab: Lab, laws: Laws, slip: float,
                                                          jointed: bool) -> None:
    _floor(lab)
    plates = [(_plate(lab, Surface(slip1=slip, slip2=slip), 2.0 * n, jointed=jointed), direction)
              for n, direction in enumerate((0.0, 0.7, 2.0))]
    lab.seconds(0.3)
    for plate, direction in plates:
        _pull(lab, plate, (4 * math.cos(direction), 4 * math.sin(direction), 0))
    lab.seconds(6.0)
    starts = [lab.pose(plate).position for plate, _ in plates]
    lab.seconds(1.0)
    for (plate, direction), start in zip(plates, starts):
        x, y, _ = lab.pose(plate).position
        laws.near("force-dependent slip: speed under a force, m/s",
                  (x - start[0]) * math.cos(direction) + (y - start[1]) * math.sin(direction),
                  4 * slip, rel=0.01)
        laws.at_most("force-dependent slip: share of the speed aside",
                     abs((y - start[1]) * math.cos(direction) - (x - start[0])
                         * math.sin(direction)) / (4 * slip), 0.02)


def test_a_slippery_plate_slows_down_as_in_syrup(lab: Lab, laws: Laws) -> None:
    _floor(lab)
    plate = _plate(lab, Surface(slip1=0.1, slip2=0.1))
    lab.seconds(0.3)
    lab.push(plate, (1.0, 0, 0))
    lab.seconds(0.2)
    laws.near("force-dependent slip: speed after one time constant, m/s",
              lab.twist(plate).linear[0], math.exp(-1.0), rel=0.02)


def test_friction_is_still_limited_by_mu(lab: Lab, laws: Laws) -> None:
    _floor(lab)
    plate = _plate(lab, Surface(mu=0.3, slip1=0.01, slip2=0.01))
    lab.seconds(0.3)
    lab.push(plate, (2.0, 0, 0))
    lab.seconds(0.4)
    laws.near("force-dependent slip: friction at most mu N, speed after 0.4 s, m/s",
              lab.twist(plate).linear[0], 2.0 - 0.3 * G * 0.4, rel=0.02)


def test_slips_of_two_surfaces_add_up(lab: Lab, laws: Laws) -> None:
    _floor(lab, Surface(slip1=0.02, slip2=0.02))
    plates = [_plate(lab, Surface()), _plate(lab, Surface(slip1=0.03, slip2=0.03), 2.0)]
    lab.seconds(0.3)
    for plate in plates:
        _pull(lab, plate, (4, 0, 0))
    lab.seconds(2.0)
    for plate, slip in zip(plates, (0.02, 0.05)):
        laws.near("force-dependent slip: of two surfaces, m/s", lab.twist(plate).linear[0],
                  4 * slip, rel=0.01)


def test_a_slip_in_one_direction_leaves_the_other_one_hard(lab: Lab, laws: Laws) -> None:
    _floor(lab)
    surface = Surface(fdir1=(1, 0, 0), slip1=0.05)
    plates = [_plate(lab, surface), _plate(lab, surface, 2.0, yaw=math.pi / 2)]
    lab.seconds(0.3)
    for plate in plates:
        _pull(lab, plate, (4, 0, 0))
    lab.seconds(2.0)
    laws.near("force-dependent slip: along fdir1, m/s", lab.twist(plates[0]).linear[0], 0.2,
              rel=0.02)
    laws.at_most("force-dependent slip: across fdir1, m/s", abs(lab.twist(plates[1]).linear[0]),
                 1e-3)


@pytest.mark.parametrize("jointed", [False, True])
@pytest.mark.parametrize("mus, slips, yaw", [
    ((1.0, 0.1), (0.1, 0.0), math.pi / 2), ((1.0, 0.1), (0.0, 0.1), math.pi / 2),
    ((0.1, 1.0), (0.0, 0.1), 0.0), ((0.1, 1.0), (0.1, 0.0), 0.0),
])
def test_a_slip_leaves_both_coefficients_as_they_are(lab: Lab, laws: Laws, mus, slips, yaw: float,
                                                     jointed: bool) -> None:
    """What pulls in the direction of the smaller one slides with it, whichever of them slips."""
    _floor(lab)
    plate = _plate(lab, Surface(mu=mus[0], mu2=mus[1], fdir1=(1, 0, 0), slip1=slips[0],
                                slip2=slips[1]), yaw=yaw, jointed=jointed)
    lab.seconds(0.3)
    _pull(lab, plate, (0.5 * 2.0 * G, 0, 0))
    lab.seconds(1.0)
    laws.near("force-dependent slip: way with the smaller coefficient, m",
              lab.pose(plate).position[0], (0.5 - 0.1) * G / 2.0, rel=0.02)


def test_contacts_tell_of_the_friction_of_what_slips(lab: Lab, laws: Laws) -> None:
    _floor(lab)
    plate = _plate(lab, Surface(slip1=0.02, slip2=0.02))
    lab.seconds(0.3)
    _pull(lab, plate, (4, 0, 0))
    lab.seconds(2.0)
    row = lab.rows[plate, "link"]
    total = sum((1 if contact.row_a == row else -1) * contact.friction[0]
                for contact in lab.apply(ReadContacts()))
    laws.near("force-dependent slip: friction in the contact read-out, N", total, -4, rel=0.02)


def _cart() -> Model:
    """A body on four driven wheels whose first direction of friction is the axle."""
    links = [Link("link", inertial=inertial_of_box(8.0, 0.6, 0.4, 0.1))]
    joints = []
    for n, (x, y) in enumerate(((1, 1), (1, -1), (-1, 1), (-1, -1))):
        links.append(Link(f"w{n}", Pose((0.2 * x, 0.25 * y, 0), quat_from_rpy(-math.pi / 2, 0, 0)),
                          Inertial(0.5, ixx=1.5e-3, iyy=1.5e-3, izz=2.5e-3),
                          [Collision("c", Cylinder(0.1, 0.05),
                                     surface=Surface(fdir1=(0, 0, 1)))]))
        joints.append(Joint(f"j{n}", "revolute", "link", f"w{n}", axis=JointAxis((0, 0, 1))))
    return Model("cart", links=links, joints=joints)


@pytest.mark.parametrize("compliance", [0.5, 2.0])
def test_wheels_slip_in_proportion_to_their_speed(lab: Lab, laws: Laws, compliance: float) -> None:
    # Up a slope of 5 degrees: the slip ratio is the compliance times the slope's tangent.
    angle, turn = math.radians(5.0), 10.0
    lab.configure(gravity=(-G * math.sin(angle), 0.0, -G * math.cos(angle)))
    _floor(lab)
    cart = lab.load(_cart(), (-10, 0, 0.1))
    normal = 10.0 * G * math.cos(angle) / 4
    lab.seconds(0.1)
    lab.apply(SetWheelSlips(tuple(WheelSlip(
        lab.rows[cart, f"w{n}"], lab.joint_rows[cart, f"j{n}"], 0.1, normal, 0.0, compliance)
        for n in range(4))))
    lab.apply(SetMotors(tuple(JointMotor(lab.joint_rows[cart, f"j{n}"], turn, 20.0)
                              for n in range(4))))
    lab.seconds(2.0)
    start = lab.pose(cart).position[0]
    lab.seconds(1.0)
    laws.near("wheel slip: speed up a slope, m/s", lab.pose(cart).position[0] - start,
              0.1 * turn * (1.0 - compliance * math.tan(angle)), rel=0.02)
