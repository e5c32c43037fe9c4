"""Gains that suit a joint, from what it has to move."""
from __future__ import annotations

import pytest

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.geometry import Pose
from my_simulations.simulator.joint_gains import axis_inertia, default_gains


def link(name, x=0.0, mass=1.0, moment=0.1):
    return Link(name, Pose((x, 0.0, 0.0)),
                Inertial(mass, ixx=moment, iyy=moment, izz=moment))


def hinge(parent, child, kind="revolute", axis=(0.0, 0.0, 1.0)):
    return Joint(f"{parent}_{child}", kind, parent, child, axis=JointAxis(axis))


def test_of_two_free_links_both_give_way():
    model = Model("m", links=[link("a"), link("b", moment=0.3)], joints=[hinge("a", "b")])
    assert axis_inertia(model, model.joints[0]) == pytest.approx(1 / (1 / 0.1 + 1 / 0.3))


def test_a_link_on_the_world_moves_alone_with_all_that_hangs_on_it():
    model = Model("m", links=[link("a"), link("b", 2.0)],
                  joints=[hinge("world", "a"), hinge("a", "b")])
    # About a's axis: both moments, and b at a distance of 2 m.
    assert axis_inertia(model, model.joints[0]) == pytest.approx(0.1 + 0.1 + 1.0 * 2.0 ** 2)
    assert axis_inertia(model, model.joints[1]) == pytest.approx(0.1)


def test_of_a_slider_masses_count():
    model = Model("m", links=[link("a", mass=4.0), link("b", mass=4.0)],
                  joints=[hinge("a", "b", "prismatic")])
    assert axis_inertia(model, model.joints[0]) == pytest.approx(2.0)


@pytest.mark.parametrize("rate", [True, False])
@pytest.mark.parametrize("load", [1.0, 15.0])
def test_the_loop_settles_at_its_target_alone_and_under_load(rate, load):
    """A wheel of 3e-4 kg m^2 at 1 kHz, with as much inertia again as a robot of 3.6 kg gives."""
    dt, inertia = 1e-3, 3e-4
    model = Model("m", links=[link("a", moment=1e3), link("b", moment=inertia)],
                  joints=[hinge("a", "b")])
    gains = default_gains(model, model.joints[0], rate, dt)
    position = speed = integral = 0.0
    last = None
    for _ in range(8000):
        error = (speed if rate else position) - 5.0
        slope = 0.0 if last is None else (error - last) / dt
        last = error
        integral += gains["i"] * error * dt
        effort = max(-5.0, min(5.0, -(gains["p"] * error + integral + gains["d"] * slope)))
        speed += effort / (load * inertia) * dt
        position += speed * dt
        assert abs(speed) < 1e4
    assert (speed if rate else position) == pytest.approx(5.0, rel=0.02)
