"""Free motion against closed forms."""
from __future__ import annotations

import math

import pytest
from conftest import Lab, ball, box, ground, inertial_of_box, link_of, slab
from laws import Laws

from my_simulations.description.model import Inertial, Link, Model
from my_simulations.description.shapes import Box, Surface
from my_simulations.engine.commands import FOREVER, SetModelState
from my_simulations.engine.timed_forces import AddTimedForces, TimedWrench
from my_simulations.geometry import Pose, Twist, conjugate, quat_from_rpy, rotate

G = 9.8


def test_free_fall_is_the_integrators_own_formula(lab: Lab, laws: Laws):
    falling = lab.load(box(), (0, 0, 100))
    lab.steps(1000)
    # Semi-implicit Euler: z = z0 - g dt^2 n (n + 1) / 2, as ODE has it.
    laws.near("free fall and projectiles: place after 1 s, m", lab.pose(falling).position,
              (0, 0, 100 - 9.8e-6 * 1000 * 1001 / 2), abs=1e-9)
    laws.near("free fall: speed after 1 s, m/s", lab.twist(falling).linear[2], -9.8, abs=1e-9)


def test_a_projectile_keeps_its_horizontal_speed(lab: Lab, laws: Laws):
    thrown = lab.load(box(), (0, 0, 50))
    lab.push(thrown, (10, -3, 5))
    lab.steps(1000)
    laws.near("free fall and projectiles: place after 1 s, m", lab.pose(thrown).position,
              (10, -3, 50 + 5 - 9.8e-6 * 1000 * 1001 / 2), abs=1e-9)


def test_a_spin_without_torque_does_not_decay(lab: Lab):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    top = lab.load(box())
    lab.push(top, angular=(0, 0, 3))
    lab.steps(5000)
    assert lab.twist(top).angular == pytest.approx((0, 0, 3), abs=1e-9)


def test_an_offset_centre_of_mass_travels_straight_while_the_link_circles_it(lab: Lab):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    com = Pose((0.3, 0.1, 0.0), quat_from_rpy(0.0, 0.0, 0.4))
    model = Model("odd", links=[Link("link", inertial=Inertial(2.0, com, 1, 0, 0, 2, 0, 2.5))])
    odd = lab.load(model, (1, 2, 3), quat_from_rpy(0, 0, 0.7))
    assert lab.pose(odd).position == pytest.approx((1, 2, 3))
    assert lab.pose(odd).orientation == pytest.approx(quat_from_rpy(0, 0, 0.7))
    lab.apply(SetModelState(odd, lab.pose(odd), Twist((0.5, 0, 0), (0, 0, 2))))
    lab.steps(1)
    arm = rotate(quat_from_rpy(0, 0, 0.7), com.position)
    centre_speed = (0.5 - 2 * arm[1], 2 * arm[0], 0.0)
    lab.steps(999)
    expected = [1 + arm[0] + centre_speed[0], 2 + arm[1] + centre_speed[1]]
    turned = rotate(quat_from_rpy(0, 0, 0.7 + 2.0), com.position)
    x, y, _ = lab.pose(odd).position
    assert (x + turned[0], y + turned[1]) == pytest.approx(expected, abs=1e-5)
    # The twist is that of the link's origin: v - w x lever.
    linear = lab.twist(odd).linear
    assert linear[0] == pytest.approx(centre_speed[0] + 2 * turned[1], abs=1e-3)
    assert linear[1] == pytest.approx(centre_speed[1] - 2 * turned[0], abs=1e-3)


def test_setting_a_state_is_read_back_exactly_with_offset_and_tilted_inertia(lab: Lab):
    tilted = Inertial(1.0, Pose((0.1, -0.2, 0.3), quat_from_rpy(0.3, 0.2, 0.1)),
                      0.1, 0.01, 0.02, 0.2, 0.03, 0.25)
    odd = lab.load(Model("odd", links=[Link("link", inertial=tilted)]))
    pose = Pose((4, 5, 6), quat_from_rpy(0.4, -0.5, 0.6))
    lab.apply(SetModelState(odd, pose, Twist((1, 2, 3), (0.3, 0.2, 0.1))))
    lab.backend.read()
    assert lab.pose(odd).position == pytest.approx(pose.position, abs=1e-12)
    assert lab.pose(odd).orientation == pytest.approx(pose.orientation, abs=1e-12)
    assert lab.twist(odd).linear == pytest.approx((1, 2, 3), abs=1e-12)
    assert lab.twist(odd).angular == pytest.approx((0.3, 0.2, 0.1), abs=1e-12)


def test_weightless_links_hang_still(lab: Lab, laws: Laws):
    floating = lab.load(box(gravity=False), (0, 0, 5))
    lab.steps(2000)
    laws.near("gravity off: place after 2 s, m", lab.pose(floating).position, (0, 0, 5), abs=1e-9)


def test_a_static_model_never_moves(lab: Lab):
    wall = lab.load(slab("wall", (0.1, 2, 2)), (1, 0, 1))
    thrown = lab.load(box(mass=50), (-1, 0, 1))
    lab.push(thrown, (8, 0, 0))
    lab.steps(1000)
    assert lab.pose(wall) == Pose((1, 0, 1))
    assert lab.pose(thrown).position[0] < 0.6


def test_gravity_can_change_while_bodies_sleep(lab: Lab):
    lab.load(ground())
    resting = lab.load(box(), (0, 0, 0.5))
    lab.seconds(4)
    lab.configure(gravity=(0.0, 0.0, 2.0))
    lab.steps(1000)
    assert lab.pose(resting).position[2] == pytest.approx(0.5 + 1.0, abs=0.02)
    assert math.isfinite(lab.twist(resting).linear[2])


@pytest.mark.parametrize("dt", [0.001, 0.004, 0.0001])
@pytest.mark.parametrize("linear, angular", [(0.01, 0.005), (0.002, 0.05), (0.3, 0.001),
                                             (1.0, 1.0)])
def test_velocity_decay_takes_its_share_off_in_every_step(lab: Lab, dt: float, linear: float,
                                                          angular: float):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    model = box()
    model.links[0].linear_decay, model.links[0].angular_decay = linear, angular
    coasting = lab.load(model)
    lab.configure(step_size=dt)
    lab.push(coasting, (10, 0, 0), (0, 0, 2))
    lab.steps(100)
    assert lab.twist(coasting).linear[0] == pytest.approx(10 * (1 - linear) ** 100, rel=1e-6)
    assert lab.twist(coasting).angular[2] == pytest.approx(2 * (1 - angular) ** 100, rel=1e-6)


@pytest.mark.parametrize("share", [0.001, 0.01, 0.03, 0.04, 0.05])
def test_a_damped_body_falls_and_turns_at_its_terminal_velocity(lab: Lab, laws: Laws, share: float):
    model = box()
    model.links[0].linear_decay = model.links[0].angular_decay = share
    sinking = lab.load(model)
    lab.apply(AddTimedForces((TimedWrench(1, lab.rows[sinking, "link"], 0, FOREVER,
                                          torque=(0.0, 0.0, G / 6)),)))
    lab.steps(2000)
    left = 1.0 - (1.0 - share) ** 2000
    laws.near("velocity decay: terminal velocity, m/s", lab.twist(sinking).linear[2],
              -G * 0.001 / share * left, rel=1e-6)
    laws.near("velocity decay: terminal rate, rad/s", lab.twist(sinking).angular[2],
              G * 0.001 / share * left, rel=1e-6)


@pytest.mark.parametrize("size", [(0.2, 0.2, 0.2), (0.1, 0.2, 0.4)])
@pytest.mark.parametrize("articulated", [False, True])
@pytest.mark.parametrize("share", [0.001, 0.03])
def test_velocity_decay_slows_what_tumbles_freely(lab: Lab, laws: Laws, size, articulated: bool,
                                                  share: float):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    link = link_of(Box(size), inertial_of_box(1.0, *size))
    link.angular_decay = share
    satellite = lab.load(Model("satellite", links=[link]), articulated=articulated)
    lab.push(satellite, angular=(0.0, 0.0, 10.0))
    lab.steps(1000)
    laws.near("velocity decay: rate of what tumbles after 1000 steps, rad/s",
              lab.twist(satellite).angular[2], 10.0 * (1.0 - share) ** 1000, abs=1e-5)


def test_a_damped_body_tumbles_as_eulers_equations_say(lab: Lab, laws: Laws):
    """The share is taken off the momentum, which keeps its direction."""
    lab.configure(gravity=(0.0, 0.0, 0.0))
    moments = (0.1, 0.2, 0.3)
    brick = Model("brick", links=[Link("link", inertial=Inertial(
        1.0, Pose(), moments[0], 0, 0, moments[1], 0, moments[2]), angular_decay=2e-4)])
    model = lab.load(brick)
    lab.push(model, angular=(1.0, 10.0, 1.0))

    def momentum():
        turn = lab.pose(model).orientation
        own = rotate(conjugate(turn), lab.twist(model).angular)
        return rotate(turn, tuple(i * w for i, w in zip(moments, own)))

    lab.backend.read()
    before = momentum()
    lab.steps(5000)
    laws.near("velocity decay: momentum of what tumbles after 5 s, N m s", momentum(),
              [each * (1.0 - 2e-4) ** 5000 for each in before], abs=1e-3)


def test_a_free_asymmetric_body_keeps_its_momentum_and_flips(lab: Lab, laws: Laws):
    lab.configure(gravity=(0.0, 0.0, 0.0))
    moments = (0.1, 0.2, 0.3)
    brick = Model("brick", links=[Link("link", inertial=Inertial(
        1.0, Pose(), moments[0], 0, 0, moments[1], 0, moments[2]))])
    model = lab.load(brick)
    lab.push(model, angular=(0.1, 10.0, 0.1))   # about the middle axis: the tennis racket theorem

    def momentum_and_energy():
        turn = lab.pose(model).orientation
        own = rotate(conjugate(turn), lab.twist(model).angular)
        momentum = rotate(turn, tuple(i * w for i, w in zip(moments, own)))
        return momentum, sum(i * w * w for i, w in zip(moments, own)) / 2

    lab.backend.read()
    before, energy = momentum_and_energy()
    flips, side = 0, 1.0
    for _ in range(2000):
        lab.steps(10)
        up = rotate(lab.pose(model).orientation, (0, 1, 0))[1]
        if up * side < -0.8:
            flips, side = flips + 1, -side
    after, energy_after = momentum_and_energy()
    laws.at_most("free asymmetric body, 10 rad/s for 20 s: momentum off, share",
                 math.dist(before, after) / math.dist(before, (0, 0, 0)), 0.01)
    laws.near("free asymmetric body, 10 rad/s for 20 s: energy, J", energy_after, energy, rel=0.02)
    assert flips >= 5


def test_a_sphere_rolls_down_a_slope_with_five_sevenths_of_the_slide(lab: Lab, laws: Laws):
    tilt, angle = quat_from_rpy(0, math.radians(10), 0), math.radians(10)
    slope = slab("slope", (40, 4, 0.2))
    slope.links[0].collisions[0].surface = Surface(mu=100.0)
    lab.load(slope, orientation=tilt)
    start = (0.6 * math.sin(angle), 0.0, 0.6 * math.cos(angle))
    rolling = lab.load(ball(), start, tilt)
    lab.seconds(2)
    expected = 0.5 * 5 / 7 * 9.8 * math.sin(angle) * 4
    laws.near("sphere on a slope: way it rolls in 2 s, m",
              math.dist(start, lab.pose(rolling).position), expected, rel=0.02)
