"""Wheels under efforts: a base goes straight, turns as its wheels do, and stands on both edges."""
from __future__ import annotations

import math
from dataclasses import replace
from typing import List, Tuple

import pybullet
import pytest
from conftest import Lab, ground, inertial_of_box, slab
from laws import Laws
from mobile_bases import differential

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.shapes import Box, Collision, Cylinder, Sphere, Surface
from my_simulations.engine.commands import ReadContacts
from my_simulations.engine.drive_commands import JointMotor, SetMotors
from my_simulations.engine.timed_forces import AddTimedForces, TimedEffort
from my_simulations.geometry import Pose, quat_from_rpy

LYING = quat_from_rpy(-math.pi / 2, 0, 0)


def _car(radius: float, width: float, turned: bool = False) -> Model:
    """Four cylinder wheels with free axles; with `turned` in link frames that are not theirs."""
    across, about = (3 * radius ** 2 + width ** 2) / 24, radius ** 2 / 4
    links = [Link("link", inertial=inertial_of_box(10, 0.6, 0.4, 0.1))]
    joints: List[Joint] = []
    for n, (x, y) in enumerate([(3 * radius, 0.3), (3 * radius, -0.3), (-3 * radius, 0.3),
                                (-3 * radius, -0.3)]):
        collision = Collision("c", Cylinder(radius, width), Pose((0, 0, 0), LYING),
                              surface=Surface(mu=1.0))
        inertial = Inertial(0.5, Pose((0, 0, 0), LYING), across, 0, 0, across, 0, about)
        joint_at, axis = Pose(), (0.0, 1.0, 0.0)
        if turned:
            off = Pose((0.02, 0.03, 0), LYING)
            collision = replace(collision, pose=off)
            inertial = replace(inertial, pose=off)
            joint_at, axis = off, (0.0, 0.0, 1.0)
        at = (x - 0.02, y - 0.03, 0) if turned else (x, y, 0)
        links.append(Link(f"w{n}", Pose(at), inertial, [collision]))
        joints.append(Joint(f"j{n}", "revolute", "link", f"w{n}", joint_at, axis=JointAxis(axis)))
    return Model("car", links=links, joints=joints)


def _drive(lab: Lab, car: int, efforts: List[float], steps: int) -> None:
    lab.apply(AddTimedForces(tuple(
        TimedEffort(n + 1, lab.joint_rows[car, f"j{n}"], lab.step, lab.step + steps, effort)
        for n, effort in enumerate(efforts))))


def _yaw(lab: Lab, car: int) -> float:
    x, y, z, w = lab.pose(car).orientation
    return math.degrees(math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)))


@pytest.mark.parametrize("floor", ["plane", "box"])
@pytest.mark.parametrize("radius, width", [(0.1, 0.03), (0.1, 0.1), (0.05, 0.3)])
@pytest.mark.parametrize("turned", [False, True])
def test_wheels_under_equal_efforts_go_straight(lab: Lab, laws: Laws, floor: str, radius: float,
                                                width: float, turned: bool):
    lab.load(ground(1.0) if floor == "plane" else slab("floor", (60, 60, 1)),
             (0, 0, 0 if floor == "plane" else -0.5))
    car = lab.load(_car(radius, width, turned), (0, 0, radius))
    lab.steps(300)
    effort = 10.0 * radius
    start, before = lab.pose(car), _yaw(lab, car)
    _drive(lab, car, [effort] * 4, 1000)
    lab.seconds(1)
    laws.at_most(f"four wheels under equal efforts on a {floor}: yaw in 1 s, degrees",
                 abs(_yaw(lab, car) - before), 0.1)
    # Half of what four torques do to the car and its wheels' turning.
    rolling = 10.0 + 4 * 0.5 * 1.5
    laws.near(f"four wheels under equal efforts on a {floor}: way in 1 s, m",
              lab.pose(car).position[0] - start.position[0], 0.5 * 4 * 10.0 / rolling, rel=0.02)


def test_wide_wheels_stand_on_both_edges(lab: Lab, laws: Laws):
    lab.load(ground(1.0))
    car = lab.load(_car(0.1, 0.1), (0, 0, 0.1))
    _drive(lab, car, [0.5] * 4, 500)
    lab.seconds(0.5)
    edges = set()
    for contact in lab.apply(ReadContacts()):
        wheel = max(contact.row_a, contact.row_b) - lab.rows[car, "w0"]
        edges.add((wheel, contact.position[1] > lab.pose(car, f"w{wheel}").position[1]))
    assert len(edges) == 8
    laws.near("wide wheels that roll: height of the axle, m", lab.pose(car, "w0").position[2], 0.1,
              abs=1e-4)


def _two_wheeled(roll: float, mu: float) -> Model:
    """A light base on two driven wheels and a box that slides behind them."""
    side = quat_from_rpy(roll, 0, 0)
    links = [Link("link", Pose((0, 0, 0.01)),
                  Inertial(0.83, Pose(), 2.2e-3, 0, 0, 2.1e-3, 0, 2.0e-3))]
    joints: List[Joint] = []
    for n, y in enumerate((0.08, -0.08)):
        links.append(Link(f"w{n}", Pose((0, y, 0.033), side),
                          Inertial(0.0285, Pose(), 1.1e-5, 0, 0, 1.1e-5, 0, 2.1e-5),
                          [Collision("c", Cylinder(0.033, 0.018), surface=Surface(mu=mu))]))
        joints.append(Joint(f"j{n}", "revolute", "link", f"w{n}", axis=JointAxis((0, 0, 1))))
    links.append(Link("caster", Pose((-0.081, 0, 0.006), side),
                      Inertial(0.005, Pose(), 1e-3, 0, 0, 1e-3, 0, 1e-3),
                      [Collision("c", Box((0.03, 0.009, 0.02)), Pose((0, 0.001, 0)),
                                 surface=Surface(mu=0.1))]))
    joints.append(Joint("mount", "fixed", "link", "caster"))
    return Model("base", links=links, joints=joints)


@pytest.mark.parametrize("floor", ["plane", "box"])
@pytest.mark.parametrize("roll", [-math.pi / 2, -1.57])
@pytest.mark.parametrize("mu", [1.0, 1e5])
@pytest.mark.parametrize("period", [10, 33])   # of the commands, in steps
def test_a_base_on_two_wheels_keeps_its_heading_as_it_starts_and_stops(
        lab: Lab, laws: Laws, floor: str, roll: float, mu: float, period: int):
    """The commands of a driver that accelerates by 1 m/s^2, in steps that make the wheels slip."""
    lab.load(ground() if floor == "plane" else slab("floor", (60, 60, 1)),
             (0, 0, 0 if floor == "plane" else -0.5))
    base = lab.load(_two_wheeled(roll, mu))
    lab.seconds(1)
    speed, heading = 0.0, _yaw(lab, base)
    for goal in (0.22, 0.0) * 3:
        for _ in range(1500 // period):
            change = 1e-3 * period
            speed += max(-change, min(change, goal - speed))
            lab.apply(SetMotors(tuple(JointMotor(lab.joint_rows[base, f"j{n}"], speed / 0.033, 10.0)
                                      for n in range(2))))
            lab.steps(period)
        before, heading = heading, _yaw(lab, base)
        laws.at_most("a base on two wheels: yaw by a start or a stop, degrees",
                     abs(heading - before), 0.03)


def _motors(lab: Lab, base: int, rates: List[float], effort: float = 10.0) -> None:
    lab.apply(SetMotors(tuple(JointMotor(lab.joint_rows[base, f"j{n}"], rate, effort)
                              for n, rate in enumerate(rates))))


@pytest.mark.parametrize("heading", [0.0, 0.5, math.pi / 4])
def test_with_a_pyramid_motors_drive_a_base_as_its_wheels_turn(lab: Lab, laws: Laws,
                                                               heading: float):
    """Its wheels keep Bullet's contact points, which lag behind the axle."""
    lab.configure(cone=False)
    lab.load(ground())
    base = lab.load(_two_wheeled(-math.pi / 2, 1.0), (0, 0, 0), quat_from_rpy(0, 0, heading))
    _motors(lab, base, [0.3 / 0.033] * 2)
    lab.seconds(1)
    start, before = lab.pose(base).position, _yaw(lab, base)
    lab.seconds(1)
    laws.near("friction pyramid, a base on two driven wheels: way in 1 s, m",
              math.dist(lab.pose(base).position, start), 0.3, rel=0.002)
    laws.at_most("the same: yaw, degrees", abs(_yaw(lab, base) - before), 0.05)
    laws.near("the same: height of the axle, m", lab.pose(base, "w0").position[2], 0.033, abs=1e-4)
    _motors(lab, base, [-0.08 / 0.033, 0.08 / 0.033])   # 1 rad/s
    lab.seconds(1)
    before = _yaw(lab, base)
    lab.seconds(1)
    laws.near("the same, in place: turn in 1 s, degrees", (_yaw(lab, base) - before) % 360.0,
              math.degrees(1.0), rel=0.03)


def test_with_a_pyramid_free_wheels_roll_at_a_constant_speed(lab: Lab, laws: Laws):
    lab.configure(cone=False)
    lab.load(ground())
    base = lab.load(_car(0.1, 0.03), (0, 0, 0.1))
    lab.steps(100)
    _motors(lab, base, [5.0] * 4)
    lab.seconds(2)
    _motors(lab, base, [0.0] * 4, 0.0)
    lab.seconds(0.1)
    before = lab.twist(base).linear
    lab.seconds(5)
    laws.near("friction pyramid, a car with free wheels after 5 s: speed, m/s",
              math.hypot(*lab.twist(base).linear), math.hypot(*before), rel=0.01)


@pytest.mark.parametrize("cone, effort, each_step", [
    (False, 10.0, False), (False, 1e-3, True), (True, 10.0, True)])
def test_steps_of_driven_wheels_need_no_python_with_a_pyramid(
        lab: Lab, monkeypatch: pytest.MonkeyPatch, cone: bool, effort: float, each_step: bool):
    """The contact points of wheels are dropped in each step otherwise."""
    lab.configure(cone=cone)
    lab.load(ground())
    base = lab.load(_two_wheeled(-math.pi / 2, 1.0))
    lab.steps(300)
    _motors(lab, base, [5.0] * 2, effort)
    lab.push(base, (5.0 * 0.033, 0, 0))
    lab.steps(200)
    dropped: List[Tuple[int, ...]] = []
    monkeypatch.setattr(pybullet, "setCollisionFilterGroupMask",
                        lambda *arguments: dropped.append(arguments))
    lab.backend.step(lab.step, 100)
    assert (len(dropped) >= 100) is each_step
    assert each_step or not dropped


@pytest.mark.parametrize("floor", ["plane", "box"])
@pytest.mark.parametrize("roll", [-math.pi / 2, -1.57])
@pytest.mark.parametrize("heading", [0.0, 0.5, 1.1])
def test_a_base_on_two_wheels_keeps_its_heading_as_its_command_steps(
        lab: Lab, laws: Laws, floor: str, roll: float, heading: float):
    """The wheels slip in the step of the command. With -1.57, the caster stands on one edge."""
    lab.load(ground() if floor == "plane" else slab("floor", (60, 60, 1)),
             (0, 0, 0 if floor == "plane" else -0.5))
    base = lab.load(_two_wheeled(roll, 1.0), (0, 0, 0), quat_from_rpy(0, 0, heading))
    lab.seconds(1)
    before = _yaw(lab, base)
    for goal in (0.22, 0.0, -0.22, 0.0):
        lab.apply(SetMotors(tuple(JointMotor(lab.joint_rows[base, f"j{n}"], goal / 0.033, 10.0)
                                  for n in range(2))))
        lab.seconds(1)
        after = _yaw(lab, base)
        laws.at_most("a base on two wheels, commands in steps: yaw, degrees", abs(after - before),
                     0.05)
        before = after


@pytest.mark.parametrize("heading", [0.0, 0.5])
@pytest.mark.parametrize("step_size", [0.001, 0.002, 0.005, 0.01])
@pytest.mark.parametrize("period", [0.01, 0.02, 0.05])   # of the commands, s
@pytest.mark.parametrize("acceleration", [1.0, 2.5, math.inf])
def test_a_base_with_a_box_as_caster_keeps_its_heading_as_it_starts_and_stops(
        lab: Lab, laws: Laws, heading: float, step_size: float, period: float,
        acceleration: float):
    """Its caster leaves the floor and lands, and the solver loads one of its corners by chance."""
    lab.configure(step_size=step_size)
    lab.load(ground(1.0))
    base = differential(1.0)
    robot = lab.load(base.model, (0, 0, 0), quat_from_rpy(0, 0, heading))
    lab.seconds(1)
    speed, change = 0.0, acceleration * period
    for goal in (0.5, 0.0, -0.5, 0.0):
        before = _yaw(lab, robot)
        for _ in range(round(0.7 / period)):
            speed += max(-change, min(change, goal - speed))
            lab.apply(SetMotors(tuple(JointMotor(lab.joint_rows[robot, joint], rate, 10.0)
                                      for joint, rate in base.rates(speed, 0.0).items())))
            lab.steps(round(period / step_size))
        law = "a base with a box as caster: yaw by a start or stop"
        laws.at_most(f"{law}, 10 ms, degrees" if step_size > 0.005 else f"{law}, degrees",
                     abs(_yaw(lab, robot) - before), 0.15 if step_size > 0.005 else 0.05)


def test_contacts_of_a_base_with_a_box_as_caster_carry_its_weight(lab: Lab, laws: Laws):
    lab.load(ground(1.0))
    base = differential(1.0)
    robot = lab.load(base.model)
    lab.seconds(0.5)
    lab.apply(SetMotors(tuple(JointMotor(lab.joint_rows[robot, joint], rate, 10.0)
                              for joint, rate in base.rates(0.3, 1.0).items())))
    lab.seconds(0.5)
    for _ in range(20):
        lab.steps(1)
        laws.near("a base with a box as caster in a curve: sum of the normal forces, N",
                  sum(contact.force for contact in lab.apply(ReadContacts())),
                  9.8 * sum(link.inertial.mass for link in base.model.links), rel=0.02)


def test_a_wheel_of_many_shapes_stays_one_body(lab: Lab):
    lab.load(ground(1.0))
    car = _car(0.1, 0.05)
    spokes = [Collision(f"s{n}", Box((0.01, 0.01, 0.01))) for n in range(14)]
    car.links[1].collisions.extend(spokes)
    body = lab.load(car, (0, 0, 0.1))
    lab.seconds(0.5)
    assert abs(lab.pose(body).position[2] - 0.1) < 1e-3


@pytest.mark.parametrize("step_size", [0.001, 0.002, 0.005])
@pytest.mark.parametrize("mu", [1.0, 10.0, 100.0])
def test_a_light_base_with_a_tall_mast_drives_upright(lab: Lab, laws: Laws, mu: float,
                                                      step_size: float):
    """Friction at its wheels turns it as easily as it shifts it, and mu N limits nothing."""
    lab.configure(step_size=step_size)
    lab.load(ground(100.0))
    radius, high = 0.05, 0.7
    links = [Link("link", Pose((0, 0, 0.1)),
                  Inertial(1.2, Pose((-0.1, 0, 0)), 3.5e-3, 0, 0, 5e-3, 0, 5e-3),
                  [Collision("c", Sphere(0.03), Pose((-0.25, 0, -0.07)), surface=Surface(mu=0.0))]),
             Link("mast", Pose((-0.07, 0.07, high)),
                  Inertial(2.4, Pose(), 0.07, 0, 0, 0.07, 0, 5e-4))]
    joints = [Joint("mount", "fixed", "link", "mast")]
    for n, y in enumerate((0.17, -0.17)):
        links.append(Link(f"w{n}", Pose((0, y, radius), LYING),
                          Inertial(0.05, Pose(), 1e-3, 0, 0, 1e-3, 0, 1e-3),
                          [Collision("c", Cylinder(radius, 0.025), surface=Surface(mu=mu))]))
        joints.append(Joint(f"j{n}", "revolute", "link", f"w{n}", axis=JointAxis((0, 0, 1))))
    base = lab.load(Model("base", links=links, joints=joints))
    lab.seconds(0.5)
    for speed in [0.02 * n for n in range(1, 11)] + [0.2] * 90:
        lab.apply(SetMotors(tuple(JointMotor(lab.joint_rows[base, f"j{n}"], speed / radius, 1e3)
                                  for n in range(2))))
        lab.steps(round(0.02 / step_size))
        x, y = lab.pose(base).orientation[:2]
        laws.at_most("a light base with a tall mast drives: tilt, rad", 2 * math.hypot(x, y), 0.05)
    laws.near("a light base with a tall mast drives for 2 s: way, m", lab.pose(base).position[0],
              0.02 * sum(min(0.02 * n, 0.2) for n in range(1, 101)), rel=0.03)


def _arm_on_a_foot() -> Model:
    """A cylinder that turns in the air, on a fixed foot that touches the ground."""
    lying = Pose((0, 0, 0), LYING)
    links = [Link("foot", Pose((0, 0, 0.1)), inertial_of_box(1, 0.2, 0.2, 0.2),
                  [Collision("c", Box((0.2, 0.2, 0.2)))]),
             Link("w0", Pose((0, 0, 0.5)), Inertial(0.5, lying, 1e-3, 0, 0, 1e-3, 0, 1e-3),
                  [Collision("c", Cylinder(0.05, 0.1), lying, surface=Surface(mu=1.0))])]
    return Model("arm", links=links, joints=[
        Joint("stand", "fixed", "world", "foot"),
        Joint("j0", "revolute", "foot", "w0", axis=JointAxis((0, 1, 0)))])


def test_a_link_of_a_fixed_arm_that_touches_nothing_is_no_wheel(
        lab: Lab, monkeypatch: pytest.MonkeyPatch):
    lab.load(ground())
    arm = lab.load(_arm_on_a_foot())
    lab.steps(100)
    taken: List[object] = []
    change = pybullet.changeDynamics

    def changed(*arguments: object, **values: object) -> None:
        taken.extend(value for name, value in values.items() if name == "anisotropicFriction")
        change(*arguments, **values)

    monkeypatch.setattr(pybullet, "changeDynamics", changed)
    _motors(lab, arm, [5.0])
    lab.steps(50)
    assert abs(lab.joint(arm, "j0")[1] - 5.0) < 0.01
    assert not taken
