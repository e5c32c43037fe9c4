"""Pendulums: angle, period, energy."""
from __future__ import annotations

import math

import pytest
from closed_forms import pendulum, pendulum_period
from conftest import Lab, arm, ground
from laws import Laws

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.shapes import Box, Collision
from my_simulations.engine.commands import SetJoints
from my_simulations.geometry import Pose, dot, quat_from_rpy, rotate, transform, twist_at

G = 9.8
Y = (0.0, 1.0, 0.0)
AMPLITUDES = (0.1, 1.5, 3.0)  # rad from hanging


def _let_go(lab: Lab, amplitude: float, mass: float = 1.0, moment: float = 1e-3,
            damping: float = 0.0) -> int:
    """A point mass 1 m from its hinge, at rest `amplitude` from hanging."""
    model = lab.load(arm("revolute", JointAxis(Y, damping=damping), mass=mass, moment=moment))
    lab.apply(SetJoints(((lab.joint_rows[model, "hinge"], math.pi / 2 - amplitude, 0.0),)))
    lab.backend.read()
    return model


@pytest.mark.parametrize("amplitude", AMPLITUDES)
@pytest.mark.parametrize("mass, moment, damping", [
    (1.0, 1e-3, 0.0), (2.0, 0.3, 0.0), (1e-3, 1e-6, 0.0), (1000.0, 1.0, 0.0),
    (1.0, 1e-3, 0.05), (1.0, 1e-3, 0.5), (1.0, 1e-3, 5.0), (1e-3, 1e-6, 5e-4),
    (1000.0, 1.0, 500.0)])
def test_a_pendulum_swings_as_a_runge_kutta_reference_for_10_s(
        lab: Lab, laws: Laws, amplitude: float, mass: float, moment: float, damping: float):
    model = _let_go(lab, amplitude, mass, moment, damping)
    angle, rate = math.pi / 2 - amplitude, 0.0
    law = f"pendulum, {'damped' if damping else 'undamped'}: angle over 10 s, rad"
    for _ in range(50):
        lab.steps(200)
        angle, rate = pendulum(angle, rate, mass + moment, mass * G, damping, 0.2, 5e-4)
        laws.near(law, lab.joint(model)[0], angle, abs=0.005)


@pytest.mark.parametrize("amplitude", [0.1, 1.0, 2.0, 3.0])
def test_the_period_at_any_amplitude_is_that_of_the_elliptic_integral(
        lab: Lab, laws: Laws, amplitude: float):
    model = _let_go(lab, amplitude)
    expected = pendulum_period(amplitude, 1.001, G)
    crossings, before = [], lab.joint(model)[0] - math.pi / 2
    for step in range(1, round(3.5 * expected * 200)):
        lab.steps(5)
        now = lab.joint(model)[0] - math.pi / 2
        if before * now < 0:
            crossings.append((step - now / (now - before)) * 5e-3)
        before = now
    # The integrator's own period differs by (w dt)^2 / 24 of it only, at first order none; what
    # is left is how well a crossing can be placed between two steps.
    laws.near("pendulum: period at large amplitude, s", crossings[4] - crossings[0],
              2 * expected, rel=1e-3)


@pytest.mark.parametrize("amplitude", [0.1, 1.0, 2.0])
def test_a_pendulum_keeps_its_phase_for_60_s(lab: Lab, laws: Laws, amplitude: float):
    model = _let_go(lab, amplitude)
    period = pendulum_period(amplitude, 1.001, G)
    count, before, last = 0, -1.0, 0.0
    for step in range(1, 3001):
        lab.steps(20)
        now = lab.joint(model)[0] - math.pi / 2
        if before < 0.0 <= now:   # from the side it was let go on: at 1/4, 5/4, ... of a period
            last = (step - now / (now - before)) * 20e-3
            count += 1
        before = now
    laws.near("pendulum: phase after 60 s, periods", last / period, count - 0.75, abs=0.01)


@pytest.mark.parametrize("amplitude", AMPLITUDES)
def test_an_undamped_pendulum_keeps_its_energy(lab: Lab, laws: Laws, amplitude: float):
    model = _let_go(lab, amplitude)

    def energy() -> float:
        angle, rate = lab.joint(model)
        return 1.001 * rate * rate / 2 - G * math.sin(angle)

    start, swing = energy(), G * (1 - math.cos(amplitude))
    # A symplectic integrator of first order: the energy goes up and down by dt w of the swing's
    # (3 rad/s: 0.3 %), and comes back.
    cycle = pendulum_period(amplitude, 1.001, G)
    for _ in range(60):
        lab.steps(1000)
        laws.at_most("pendulum: energy over 60 s, share of the swing's",
                     abs(energy() - start) / swing, 5e-3)
    lab.steps(round((math.ceil(60 / cycle) * cycle - 60) * 1000))  # to rest at the turning point
    laws.at_most("pendulum: energy lost for good in 60 s, share of the swing's",
                 abs(energy() - start) / swing, 1e-3)


def _double(masses: float = 1.0) -> Model:
    def bob(name: str, x: float) -> Link:
        moment = 1e-3 * masses
        return Link(name, Pose((x, 0, 0)),
                    Inertial(masses, Pose((1, 0, 0)), moment, 0, 0, moment, 0, moment))

    return Model("double", links=[bob("a", 0.0), bob("b", 1.0)], joints=[
        Joint("upper", "revolute", "world", "a", axis=JointAxis(Y)),
        Joint("lower", "revolute", "a", "b", axis=JointAxis(Y))])


@pytest.mark.parametrize("mass", [1e-3, 1.0, 1000.0])
def test_a_double_pendulum_keeps_its_energy(lab: Lab, laws: Laws, mass: float):
    model = lab.load(_double(mass))

    def energy() -> float:
        total = 0.0
        for name in "ab":
            pose, twist = lab.pose(model, name), lab.twist(model, name)
            speed = twist_at(twist, rotate(pose.orientation, (1, 0, 0))).linear
            total += (dot(speed, speed) + 1e-3 * dot(twist.angular, twist.angular)) / 2
            total += G * transform(pose, (1, 0, 0))[2]
        return total

    start, swing = energy(), 2 * G * 3
    # A first-order integrator is off by dt w of the energy that turns at w; the lower bob whirls at
    # 20 rad/s, which makes 2 % at 1 ms.
    for _ in range(100):
        lab.steps(100)
        laws.at_most("double pendulum: energy over 10 s, share of the swing's",
                     abs(energy() - start) / swing, 0.02)


def test_a_ragdoll_gains_little_energy_on_impact(lab: Lab, laws: Laws):
    # Twenty links of 0.5 kg on hinges about crossing axes fall from 1.5 m. An impact must only
    # take energy away; Bullet's integrator of joints gives some.
    moment = 0.5 * 0.1 * 0.1 / 6
    links = [Link(f"l{n}", Pose((0.12 * n, 0, 0)), Inertial(
        0.5, ixx=moment, iyy=moment, izz=moment), [Collision("c", Box((0.1, 0.1, 0.1)))])
        for n in range(20)]
    joints = [Joint(f"j{n}", "revolute", f"l{n}", f"l{n + 1}", pose=Pose((-0.06, 0, 0)),
                    axis=JointAxis((0.0, 1.0, 0.0) if n % 2 else (0.0, 0.0, 1.0)))
              for n in range(19)]
    lab.load(ground())
    model = lab.load(Model("ragdoll", links=links, joints=joints), (0, 0, 1.5),
                     quat_from_rpy(0.3, 0.4, 0.0))

    def energy() -> float:
        total = 0.0
        for link in links:
            pose, twist = lab.pose(model, link.name), lab.twist(model, link.name)
            total += 0.25 * dot(twist.linear, twist.linear) + 0.5 * G * pose.position[2]
            total += moment * dot(twist.angular, twist.angular) / 2
        return total

    least = energy()
    for _ in range(150):    # the last link lies after 1 s
        lab.steps(10)
        now = energy()
        laws.at_most("a ragdoll of 20 links falls from 1.5 m: energy it gains, J", now - least, 2.0)
        least = min(least, now)
