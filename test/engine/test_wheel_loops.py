"""Light wheels under loops that return efforts, as of velocity interfaces with gains."""
from __future__ import annotations

import math

import pytest
from conftest import Lab, ground
from laws import Laws

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.shapes import Collision, Cylinder, Sphere, Surface
from my_simulations.engine.drive_commands import JointServo, PidGains, SetServos
from my_simulations.geometry import Pose, quat_from_rpy

RADIUS, ASIDE, MASS, WHEEL = 0.05, 0.2, 10.0, 0.1   # m, m from the centre, kg
BEHIND, CASTER = 0.02, 1.0   # m behind the axles: centre of mass, ball without friction
ABOUT = 0.4                  # kg m^2, of the base about the vertical at its centre of mass
G = 9.8
FRONT, BESIDE, SKID_RADIUS, HEAVY, HEAVY_WHEEL, SPIN = 0.22, 0.28, 0.19, 40.0, 5.0, 0.09


def _skid_steered(mus: "tuple[float, float]") -> Model:
    """A base on four heavy wheels, `mus` along and across them, its centre of mass between them."""
    links = [Link("link", inertial=Inertial(HEAVY, ixx=0.7, iyy=1.3, izz=1.3))]
    joints = []
    for name, x, y in (("left", FRONT, BESIDE), ("right", FRONT, -BESIDE),
                       ("left_rear", -FRONT, BESIDE), ("right_rear", -FRONT, -BESIDE)):
        links.append(Link(name, Pose((x, y, 0)), Inertial(
            HEAVY_WHEEL, ixx=0.05, iyy=SPIN, izz=0.05), [
                Collision("c", Cylinder(SKID_RADIUS, 0.01), Pose((0, 0, 0), quat_from_rpy(
                    math.pi / 2, 0, 0)), surface=Surface(mu=mus[0], mu2=mus[1],
                                                         fdir1=(1.0, 0.0, 0.0)))]))
        joints.append(Joint(name, "revolute", "link", name, axis=JointAxis((0, 1, 0))))
    return Model("base", links=links, joints=joints)


def _base(spin: float, mu: float, first: "tuple[float, float, float]") -> Model:
    """A base on two wheels, `spin` kg m^2 about their axles, and a ball without friction."""
    links = [Link("link", inertial=Inertial(
        MASS, Pose((-BEHIND, 0, 0)), ixx=0.1, iyy=0.2, izz=ABOUT), collisions=[
            Collision("c", Sphere(0.01), Pose((-CASTER, 0, 0.01 - RADIUS)),
                      surface=Surface(mu=0.0))])]
    joints = []
    for name, y in (("left", ASIDE), ("right", -ASIDE)):
        links.append(Link(name, Pose((0, y, 0)), Inertial(
            WHEEL, ixx=0.6 * spin, iyy=spin, izz=0.6 * spin), [
                Collision("c", Cylinder(RADIUS, 0.004), Pose((0, 0, 0), quat_from_rpy(
                    math.pi / 2, 0, 0)), surface=Surface(mu=mu, mu2=mu, fdir1=first))]))
        joints.append(Joint(name, "revolute", "link", name, axis=JointAxis((0, 1, 0))))
    return Model("base", links=links, joints=joints)


def _command(lab: Lab, base: int, left: float, right: float, gains: PidGains) -> None:
    lab.apply(SetServos(tuple(
        JointServo(lab.joint_rows[base, name], "velocity", rate, drive_gains=gains)
        for name, rate in (("left", left), ("right", right)))))


@pytest.mark.parametrize("first", [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)], ids=["no fdir1", "fdir1"])
@pytest.mark.parametrize("stiff", [0.4, 1.2, 3.6])
@pytest.mark.parametrize("step_size", [0.001, 0.002, 0.005, 0.01])
def test_light_wheels_under_loops_turn_a_base_in_place(lab: Lab, laws: Laws, step_size: float,
                                                       stiff: float, first):
    """`stiff`: p dt / I. Above 2 a loop swings without end in the air, but not on the ground."""
    lab.configure(step_size=step_size)
    lab.load(ground(2.0))
    spin = 5e-4
    base = lab.load(_base(spin, 2.0, first), (0, 0, RADIUS), quat_from_rpy(0, 0, 0.3))
    lab.steps(round(0.2 / step_size))
    goal, gain = 0.5 * ASIDE / RADIUS, stiff * spin / step_size
    _command(lab, base, -goal, goal, PidGains(gain))
    turned, rates, steps = 0.0, [], round(3.0 / step_size)
    for step in range(steps):
        lab.steps(1)
        turned += step_size * lab.twist(base).angular[2]
        if 4 * step > 3 * steps:
            rates.append(lab.joint(base, "left")[1])
    # Each wheel turns itself and half of the base: J dw/dt = p (goal - w).
    about = ABOUT + MASS * BEHIND ** 2 + 2 * (WHEEL * ASIDE ** 2 + 0.6 * spin)
    lag = (spin + about * (RADIUS / ASIDE) ** 2 / 2) / gain
    laws.near("light wheels under loops turn a base in place: angle in 3 s, rad", turned,
              0.5 * (3.0 - lag * (1.0 - math.exp(-3.0 / lag))),
              rel=0.02 if step_size < 0.01 else 0.06)
    swing = max(abs(one - other) for one, other in zip(rates, rates[1:]))
    laws.at_most("light wheels under loops: change of their rate in a step, share", swing / goal,
                 0.05)


@pytest.mark.parametrize("stiff", [0.2, 0.5, 1.0])
@pytest.mark.parametrize("step_size", [0.001, 0.002, 0.005])
def test_skid_steered_wheels_under_loops_slide_against_their_slip(lab: Lab, laws: Laws,
                                                                  step_size: float, stiff: float):
    """What the joints of the wheels yield does not change the direction of their friction."""
    _turn_on_sliding_wheels(lab, laws, step_size, stiff, (0.7, 0.7), "equal coefficients")


@pytest.mark.parametrize("mus", [(0.7, 0.4), (0.5, 0.8)])
def test_skid_steered_wheels_with_two_coefficients_under_loops(lab: Lab, laws: Laws, mus):
    _turn_on_sliding_wheels(lab, laws, 0.001, 1.0, mus, "two coefficients")


def _turn_on_sliding_wheels(lab: Lab, laws: Laws, step_size: float, stiff: float,
                            mus: "tuple[float, float]", what: str) -> None:
    """Compare rates in place with Coulomb's law; `stiff`: p dt / I.

    Friction -N M (M v) / |M v| balances on the base if b mu^2 (u - w b) = a mu2^2 w a, at the speed
    u of the rims and the rate w; its part along the wheels balances the loop.
    """
    lab.configure(step_size=step_size)
    lab.load(ground(2.0))
    base = lab.load(_skid_steered(mus), (0, 0, SKID_RADIUS), quat_from_rpy(0, 0, 0.3))
    lab.steps(round(0.2 / step_size))
    along, across = (BESIDE * mus[0]) ** 2, (FRONT * mus[1]) ** 2
    turn = BESIDE * mus[0] ** 2 / (along + across)       # rate of the base for u = 1
    slip = mus[0] * (1.0 - turn * BESIDE), mus[1] * turn * FRONT
    load = (HEAVY + 4 * HEAVY_WHEEL) * G / 4
    torque = load * mus[0] * slip[0] / math.hypot(*slip) * SKID_RADIUS
    gain = stiff * SPIN / step_size
    rim = 3.0                                              # rad/s, of the wheels
    goal = rim + torque / gain
    lab.apply(SetServos(tuple(
        JointServo(lab.joint_rows[base, name], "velocity", -goal if "left" in name else goal,
                   drive_gains=PidGains(gain)) for name in
        ("left", "right", "left_rear", "right_rear"))))
    lab.steps(round(1.5 / step_size))
    turned, rolled, steps = 0.0, 0.0, round(1.0 / step_size)
    for _ in range(steps):
        lab.steps(1)
        turned += lab.twist(base).angular[2] / steps
        rolled += lab.joint(base, "right")[1] / steps
    laws.near(f"skid-steered wheels under loops, {what}: rate of the wheels, rad/s", rolled, rim,
              rel=0.05)
    laws.near(f"skid-steered wheels under loops, {what}: rate of the base, rad/s", turned,
              rim * SKID_RADIUS * turn, rel=0.05)


@pytest.mark.parametrize("first", [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)], ids=["no fdir1", "fdir1"])
@pytest.mark.parametrize("step_size", [0.001, 0.002, 0.005, 0.01])
def test_light_wheels_that_a_loop_spins_push_with_all_friction(lab: Lab, laws: Laws,
                                                               step_size: float, first):
    lab.configure(step_size=step_size)
    lab.load(ground(1.0))
    mu, spin, gain = 0.2, 3e-4, 0.01
    base = lab.load(_base(spin, mu, first), (0, 0, RADIUS), quat_from_rpy(0, 0, 0.3))
    lab.steps(round(0.2 / step_size))
    _command(lab, base, 100.0, 100.0, PidGains(gain))
    lab.steps(round(0.2 / step_size))
    speeds = [math.hypot(*lab.twist(base).linear[:2])]
    lab.steps(round(0.5 / step_size))
    speeds.append(math.hypot(*lab.twist(base).linear[:2]))
    # What the ball bears grows with the acceleration: C b = m g d + M a R.
    whole = MASS + 2 * WHEEL
    pushed = mu * G * (1.0 - MASS * BEHIND / (whole * CASTER)) / (1.0 + mu * RADIUS / CASTER)
    laws.near("light wheels that a loop spins: acceleration, m/s^2", (speeds[1] - speeds[0]) / 0.5,
              pushed, rel=0.05)
    # The rate at which the loop balances the friction.
    laws.near("light wheels that a loop spins: rate, rad/s", lab.joint(base, "left")[1],
              100.0 - whole * pushed / 2 * RADIUS / gain, rel=0.05)
