"""Wheels that slide: a skid-steered base turns on the spot, whatever its heading."""
from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from conftest import Lab, ground, inertial_of_box, slab
from laws import Laws

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.shapes import Collision, Cylinder, Surface
from my_simulations.engine.bullet.edge_loads import distribute_loads
from my_simulations.engine.bullet.link_states import Motion
from my_simulations.engine.commands import ReadContacts
from my_simulations.engine.drive_commands import JointMotor, SetMotors
from my_simulations.engine.timed_forces import AddTimedForces, TimedWrench
from my_simulations.geometry import Pose, norm, quat_from_rpy, rotate

AHEAD, ASIDE, RADIUS, SPEED = 0.2, 0.25, 0.1, 0.3   # wheels from the centre, m; m/s


EXPECTED = SPEED * ASIDE / (AHEAD ** 2 + ASIDE ** 2)


def _base(speed: float = SPEED, mu: float = 1.0, brake: float = 1e3) -> Model:
    """Four wheels whose joints turn at given rates, the left ones backwards."""
    links = [Link("link", inertial=inertial_of_box(10, 0.6, 0.4, 0.1))]
    joints = []
    wheel = Link("wheel", inertial=Inertial(0.5, ixx=0.0015, iyy=0.0015, izz=0.0025), collisions=[
        Collision("c", Cylinder(RADIUS, 0.05), surface=Surface(mu=mu))])
    for n, (x, y) in enumerate([(AHEAD, ASIDE), (AHEAD, -ASIDE), (-AHEAD, ASIDE),
                                (-AHEAD, -ASIDE)]):
        links.append(replace(wheel, name=f"w{n}", pose=Pose(
            (x, y, 0), quat_from_rpy(-math.pi / 2, 0, 0))))
        joints.append(Joint(f"j{n}", "revolute", "link", f"w{n}", axis=JointAxis(
            (0, 0, 1), friction=brake, motor_rate=speed / RADIUS * (-1 if y > 0 else 1))))
    return Model("base", links=links, joints=joints)


@pytest.mark.parametrize("heading", range(0, 91, 15))
def test_a_skid_steered_base_turns_at_every_heading(lab: Lab, laws: Laws, heading: int):
    # Four equal wheels that slip in the direction of Coulomb's law: v b / (a^2 + b^2).
    lab.load(ground(1.0))
    base = lab.load(_base(), (0, 0, RADIUS), quat_from_rpy(0, 0, math.radians(heading)))
    lab.steps(400)
    laws.near("a skid-steered base: turn, rad/s", lab.twist(base).angular[2], EXPECTED, rel=0.05)


@pytest.mark.parametrize("heading", [0, 30, 45, 90])
@pytest.mark.parametrize("along, across", [(1.0, 0.3), (0.5, 1.0)])
def test_a_skid_steered_base_turns_by_the_friction_along_its_axles_and_across(
        lab: Lab, laws: Laws, heading: int, along: float, across: float):
    # Friction is -N M (M v) / |M v|; M has `across` in the rolling direction, `along` on the axle.
    lab.load(ground(1.0))
    model = _base()
    surface = Surface(mu=along, mu2=across, fdir1=(0.0, 0.0, 1.0))
    model.links = [replace(link, collisions=[replace(one, surface=surface)
                                             for one in link.collisions]) for link in model.links]
    base = lab.load(model, (0, 0, RADIUS), quat_from_rpy(0, 0, math.radians(heading)))
    lab.steps(500)
    rates = []
    for _ in range(300):
        lab.steps(1)
        rates.append(lab.twist(base).angular[2])
    expected = across ** 2 * SPEED * ASIDE / ((across * ASIDE) ** 2 + (along * AHEAD) ** 2)
    laws.near("skid steering with two coefficients: turn, share", np.mean(rates) / expected, 1.0,
              rel=0.05)


@pytest.mark.parametrize("mu", [0.3, 1.0])
@pytest.mark.parametrize("share", [0.1, 5.0])
@pytest.mark.parametrize("step_size", [0.001, 0.005, 0.01])
def test_a_skid_steered_base_turns_slowly_and_fast(lab: Lab, laws: Laws, step_size: float,
                                                   share: float, mu: float):
    lab.configure(step_size=step_size)
    lab.load(ground(1.0))
    base = lab.load(_base(share * SPEED, mu), (0, 0, RADIUS))
    lab.steps(500)
    angle, steps = 0.0, 500
    for _ in range(steps):
        lab.steps(1)
        angle += step_size * lab.twist(base).angular[2]
    laws.near("a skid-steered base at 0.03 to 1.5 m/s, mu 0.3 and 1: mean turn",
              angle / (step_size * steps) / (share * EXPECTED), 1.0, rel=0.05)


@pytest.mark.parametrize("period", [10, 20, 50])
def test_a_skid_steered_base_turns_under_commands_that_change(lab: Lab, laws: Laws, period: int):
    # Controllers with feedback send another rate at each of their steps: 100, 50 and 20 Hz.
    lab.load(ground(1.0))
    base = lab.load(_base(), (0, 0, RADIUS))
    rows = [lab.joint_rows[base, f"j{n}"] for n in range(4)]
    angle, steps = 0.0, 1500
    for step in range(500 + steps):
        if step % period == 0:
            change = 1e-3 * (1 if step // period % 2 else -1)
            lab.apply(SetMotors(tuple(
                JointMotor(row, SPEED / RADIUS * (-1 if n % 2 == 0 else 1) + change, 1e3)
                for n, row in enumerate(rows))))
        lab.steps(1)
        angle += 1e-3 * lab.twist(base).angular[2] * (step >= 500)
    laws.near("a skid-steered base, commands at 20 to 100 Hz: mean turn, rad/s",
              angle / (1e-3 * steps), EXPECTED, rel=0.05)


def test_a_skid_steered_base_turns_in_a_wind_that_changes_each_step(lab: Lab, laws: Laws):
    lab.load(ground(1.0))
    base = lab.load(_base(), (0, 0, RADIUS))
    row = lab.rows[base, "link"]
    angle, steps = 0.0, 1500
    for step in range(500 + steps):
        lab.apply(AddTimedForces((TimedWrench(step + 1, row, lab.step, lab.step + 1,
                                              force=(1e-3, 0.0, 0.0)),)))
        lab.steps(1)
        angle += 1e-3 * lab.twist(base).angular[2] * (step >= 500)
    laws.near("a skid-steered base, 1 mN renewed each step: mean turn, rad/s",
              angle / (1e-3 * steps), EXPECTED, rel=0.05)


def test_a_skid_steered_base_turns_on_a_box(lab: Lab, laws: Laws):
    lab.load(slab("floor", (60, 60, 1)), (0, 0, -0.5))
    base = lab.load(_base(), (0, 0, RADIUS), quat_from_rpy(0, 0, 0.5))
    lab.steps(600)
    laws.near("a skid-steered base on a box: turn, rad/s", lab.twist(base).angular[2], EXPECTED,
              rel=0.05)


@pytest.mark.parametrize("crooked", [0.0, 8e-4])   # half of pi as 1.57
@pytest.mark.parametrize("rate", [1.0, 3.0])
def test_a_base_on_wide_wheels_turns_in_place(lab: Lab, laws: Laws, rate: float, crooked: float):
    lab.load(ground())
    base = _base(speed=0.0, mu=0.8)
    for link in base.links[1:]:
        link.collisions[0] = replace(link.collisions[0], geometry=Cylinder(RADIUS, 0.12),
                                     pose=Pose((0, 0, 0), quat_from_rpy(crooked, 0, 0)))
    car = lab.load(base, (0, 0, RADIUS), quat_from_rpy(0, 0, 0.3))
    lab.seconds(1)
    start = lab.pose(car).position
    lab.apply(SetMotors(tuple(JointMotor(lab.joint_rows[car, f"j{n}"], rate * side, 1e3)
                              for n, side in enumerate((-1, 1, -1, 1)))))
    for _ in range(8):
        lab.seconds(0.5)
        laws.at_most("a skid-steered base that turns for 4 s: way from its place, m",
                     math.dist(lab.pose(car).position, start), 0.01)


def test_a_base_that_skids_comes_to_rest_and_stays(lab: Lab, laws: Laws):
    # Braked wheels that slide over a slope of 10 degrees stop as Coulomb's law says, and hold.
    angle, mu, speed = math.radians(10), 0.8, 1.0
    tilt = quat_from_rpy(0.0, angle, 0.0)
    lab.load(slab("slope", (60, 60, 0.2)), (0, 0, 0), tilt)
    base = lab.load(_base(0.0, mu), rotate(tilt, (0.0, 0.0, 0.1 + RADIUS)), tilt)
    lab.seconds(1)
    start = lab.pose(base)
    lab.push(base, rotate(tilt, (speed, 0.0, 0.0)))
    lab.seconds(2)
    stopped = lab.pose(base)
    slowing = 9.8 * (mu * math.cos(angle) - math.sin(angle))
    laws.near("a base with braked wheels that slides downhill: way to a stop, m",
              math.dist(stopped.position, start.position), speed ** 2 / (2 * slowing), rel=0.05)
    lab.seconds(10)
    laws.at_most("a base that has slid to rest on a slope: way in 10 s, mm",
                 1e3 * math.dist(lab.pose(base).position, stopped.position), 0.1)


def test_sliding_wheels_tell_their_friction(lab: Lab, laws: Laws):
    lab.load(ground(1.0))
    base = lab.load(_base(), (0, 0, RADIUS))
    lab.steps(400)
    wheels = {lab.rows[base, f"w{n}"] for n in range(4)}
    contacts = [contact for contact in lab.apply(ReadContacts()) if contact.force > 0.0]
    assert wheels <= {row for contact in contacts for row in (contact.row_a, contact.row_b)}
    laws.near("the same: sum of the normal forces, N", sum(contact.force for contact in contacts),
              9.8 * (10 + 4 * 0.5), rel=0.02)
    for contact in contacts:
        laws.near("friction of wheels that slide, by normal force",
                  norm(contact.friction) / contact.force, 1.0, rel=0.02)


def _turn_by_coulomb(aside: float, width: float, com: float) -> float:
    """Turn, rad/s, of `_base` whose wheels have two edges and whose centre of mass is aside.

    The load is linear in where an edge is; velocities along, across and turn are found by
    following a base of unit mass and inertia, that Coulomb's forces move, to its steady state.
    """
    edges = np.array([(x, y + side * width / 2, SPEED * (-1 if y > 0 else 1))
                      for x in (AHEAD, -AHEAD) for y in (aside, -aside) for side in (-1, 1)])
    x, y, speed = edges.T
    load = (1.0 + com * y / (y ** 2).mean()) / len(edges)
    ahead = across = turn = 0.0
    for _ in range(20000):
        slip = np.stack([ahead - turn * (y - com) - speed, across + turn * x])
        force = -load * slip / np.maximum(np.hypot(*slip), 1e-3)
        ahead, across = ahead + 0.01 * force[0].sum(), across + 0.01 * force[1].sum()
        turn += 0.1 * (x * force[1] - (y - com) * force[0]).sum()
    return float(turn)


@pytest.mark.parametrize("com", [0.0, -0.07])
@pytest.mark.parametrize("crooked", [0.0, 1.3e-6, 8e-4])   # pi as 3.14159, half of it as 1.57
def test_a_base_on_wide_wheels_turns_as_its_edges_share_its_weight(lab: Lab, laws: Laws,
                                                                   com: float, crooked: float):
    lab.load(ground(1.0))
    base, width = _base(), 0.12
    for link in base.links[1:]:
        link.collisions[0] = replace(link.collisions[0], geometry=Cylinder(RADIUS, width),
                                     pose=Pose((0, 0, 0), quat_from_rpy(crooked, 0, 0)))
    # Of the whole: the wheels' 2 kg stand where they are.
    base.links[0].inertial = replace(base.links[0].inertial, pose=Pose((0.0, 1.2 * com, 0.0)))
    car = lab.load(base, (0, 0, RADIUS))
    lab.steps(1000)
    begin, turn = lab.step, 0.0
    while lab.step < begin + 1000:
        lab.steps(10)
        turn += lab.twist(car).angular[2] / 100
    laws.near("a skid-steered base on wide wheels, its weight aside: mean turn, rad/s", turn,
              _turn_by_coulomb(ASIDE, width, com), rel=0.05)


def _wheel_at(x: float, y: float, loads, gap: float = 0.0, tilt: float = 0.0):
    """A lying wheel for `distribute_loads`: its contacts at two edges 0.1 m apart."""
    contacts = [(0, 1, 0, 0, -1, (x, y + side, 0.0), (x, y + side, 0.0), (0.0, 0.0, 1.0), gap * n,
                 load, 0, (1.0, 0.0, 0.0), 0, (0.0, 1.0, 0.0))
                for n, (side, load) in enumerate(zip((-0.05, 0.05), loads))]
    moves = Motion((x, y, 0.1), quat_from_rpy(tilt, 0.0, 0.0), (0, 0, 0), (0, 0, 0))
    return moves, (0.0, 1.0, 0.0), (), contacts


CORNERS = [(0.3, 0.3), (0.3, -0.3), (-0.3, 0.3), (-0.3, -0.3)]


def test_edges_share_with_the_same_sum_and_the_same_moments():
    wheels = [_wheel_at(*at, loads) for at, loads in zip(
        CORNERS, [(20.0, 0.0), (30.0, 0.0), (0.0, 25.0), (0.0, 35.0)])]
    _check_sums(wheels, 8)


def _check_sums(wheels, count: int) -> None:
    """The loads of `count` edges are positive, with the sum and the moments of Bullet's."""
    before = [(contact[5], contact[9]) for wheel in wheels for contact in wheel[3]]
    after = [(contact[5], load) for contacts, loads in distribute_loads(wheels)
             for contact, load in zip(contacts, loads)]
    assert len(after) == count and min(load for _, load in after) > 0.0
    for weight in (lambda at: 1.0, lambda at: at[0], lambda at: at[1]):
        assert sum(weight(at) * load for at, load in after) == pytest.approx(
            sum(weight(at) * load for at, load in before))


def test_edges_that_would_be_pulled_down_carry_nothing():
    _check_sums([_wheel_at(*at, loads) for at, loads in zip(
        CORNERS, [(50.0, 0.0), (20.0, 0.0), (9.0, 0.0), (0.1, 0.0)])], 6)


def _box_at(x: float, corners, loads):
    """A box of 0.2 m and 0.1 m for `distribute_loads`, with contacts at some of its corners."""
    moves = Motion((x, 0.0, 0.05), (0.0, 0.0, 0.0, 1.0), (0, 0, 0), (0, 0, 0))
    contacts = [(0, 1, 0, 0, -1, (x + a, b, 0.0), (x + a, b, 0.0), (0.0, 0.0, 1.0), 0.0, load)
                for (a, b), load in zip(corners, loads)]
    return moves, None, tuple((a, b, c) for a in (-0.1, 0.1) for b in (-0.05, 0.05)
                              for c in (-0.05, 0.05)), contacts


def test_corners_of_a_box_that_the_solver_dropped_carry_a_load():
    wheels = [_wheel_at(0.3, y, loads) for y, loads in ((0.3, (11.0, 0.0)), (-0.3, (0.0, 13.0)))]
    wheels.append(_box_at(-0.3, [(0.1, -0.05), (-0.1, 0.05)], (6.0, 0.5)))
    _check_sums(wheels, 8)
    contacts, _ = distribute_loads(wheels)[2]
    assert sorted(tuple(round(part, 9) for part in contact[5]) for contact in contacts) == [
        (-0.4, -0.05, 0.0), (-0.4, 0.05, 0.0), (-0.2, -0.05, 0.0), (-0.2, 0.05, 0.0)]


@pytest.mark.parametrize("wheels", [
    [_wheel_at(*at, (10.0, 0.0), tilt=0.1) for at in CORNERS],
    [_wheel_at(*at, (10.0, 0.0), gap=1e-3) for at in CORNERS[::3]][:1]])
def test_loads_stay_where_wheels_are_tilted_or_have_one_edge(wheels):
    for (contacts, loads), wheel in zip(distribute_loads(wheels), wheels):
        assert loads == [contact[9] for contact in wheel[3] if contact[9] > 0.0]
        assert len(contacts) == 1
