"""Bases with steered wheels and with mecanum wheels, driven by controllers on real physics."""
from __future__ import annotations

import math

import pytest
from conftest import ground
from plugin_case import PluginCase, kept
from wheeled_robots import axle, base, odometry, plugin, wheel

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.shapes import Collision, Sphere, Surface
from my_simulations.description.transmission import Transmission, TransmissionJoint
from my_simulations.description.world import World
from my_simulations.engine.bullet.backend import BulletBackend
from my_simulations.geometry import Pose, rpy_from_quat

CORNERS = {"front_left": (0.5, 0.4), "front_right": (0.5, -0.4), "rear_left": (-0.5, 0.4),
           "rear_right": (-0.5, -0.4)}
POSITION, VELOCITY = (f"hardware_interface/{kind}JointInterface" for kind in
                      ("Position", "Velocity"))
RADIUS = 0.1


class Case(PluginCase):
    """A base named `robot` whose controller `drive` runs."""

    def __init__(self, model, hardware=None, **settings):
        super().__init__(World(models=[ground(), model]), BulletBackend,
                         parameters={"robot": {"drive": settings, **(hardware or {})}})
        assert self.ask("robot/controller_manager/load_controller", name="drive").ok, self.issues
        assert self.ask("robot/controller_manager/switch_controller", start_controllers=["drive"],
                        stop_controllers=[], strictness=2).ok, self.issues
        self.sim.clock.advance(200)

    def drive(self, seconds, x=0.0, y=0.0, yaw=0.0):
        """Drive at a twist; commands come ten times a second."""
        for _ in range(round(seconds * 10)):
            self.deliver("robot/drive/cmd_vel", linear={"x": x, "y": y}, angular={"z": yaw})
            self.sim.clock.advance(100)

    def told(self):
        return odometry(self.last("robot/drive/odom", self.now()))

    def truth(self):
        pose, _ = self.sim.states.model_state("robot")
        return (*pose.position[:2], rpy_from_quat(pose.orientation)[2])


@pytest.fixture
def case():
    yield from kept(Case)


def robot(links, joints, driven, hardware=""):
    return Model("robot", links=links, joints=joints, transmissions=[
        Transmission(f"{joint}_trans", joints=[TransmissionJoint(joint, [interface])])
        for joint, interface in driven.items()],
        plugins=[plugin("libgazebo_ros_control.so", hardware)])


def fork(name, x, y):
    """A steering axis on the base, right above its wheel."""
    return (Link(f"{name}_fork", Pose((x, y, RADIUS)), Inertial(0.5, ixx=0.01, iyy=0.01, izz=0.01)),
            Joint(f"{name}_steer", "revolute", "base", f"{name}_fork",
                  axis=JointAxis((0.0, 0.0, 1.0), effort=100.0, velocity=10.0)))


def four_wheel_steering():
    """Each wheel stands right below its steering axis."""
    links, joints, driven = [base()], [], {}
    for name, (x, y) in CORNERS.items():
        carrier, steering = fork(name, x, y)
        links += [carrier, wheel(name, x, y)]
        joints += [steering, axle(f"{name}_axle", name, f"{name}_fork")]
        driven.update({f"{name}_steer": POSITION, f"{name}_axle": VELOCITY})
    pairs = {f"{end}_{kind}": [f"{end}_{side}_{joint}" for side in ("left", "right")]
             for end in ("front", "rear") for kind, joint in (("wheel", "axle"),
                                                              ("steering", "steer"))}
    return robot(links, joints, driven), {
        "type": "four_wheel_steering_controller/FourWheelSteeringController",
        "wheel_radius": RADIUS, **pairs}


def mecanum(rollers=14, size=0.025):
    """Wheels with balls on their rims, which turn freely about axes at 45 degrees to the wheel's.

    A ball on the ground does not slip along its axis, (1, -1) at the front left wheel. So that one
    turns by (x - y) / radius, which is the controller's law.
    """
    links, joints, driven, settings = [base(20.0)], [], {}, {}
    moment = 0.4 * 0.05 * size ** 2
    for name, (x, y) in CORNERS.items():
        links.append(Link(name, Pose((x, y, RADIUS)), Inertial(0.5, ixx=2e-3, iyy=3e-3, izz=2e-3)))
        joints.append(axle(f"{name}_axle", name))
        driven[f"{name}_axle"] = VELOCITY
        settings[f"{name.replace('rear', 'back')}_wheel_joint"] = f"{name}_axle"
        way = -1.0 if name in ("front_left", "rear_right") else 1.0
        for n in range(rollers):
            angle = 2.0 * math.pi * n / rollers
            down = (-math.sin(angle), 0.0, -math.cos(angle))     # from the hub to the ball
            ahead = (math.cos(angle), 0.0, -math.sin(angle))     # along the rim
            reach = RADIUS - size
            at = tuple(part * reach for part in down)
            links.append(Link(f"{name}_{n}", Pose((x + at[0], y, RADIUS + at[2])),
                              Inertial(0.05, ixx=moment, iyy=moment, izz=moment),
                              [Collision("c", Sphere(size), surface=Surface(mu=1.0, mu2=1.0))]))
            axis = tuple(math.sqrt(0.5) * part for part in (ahead[0], way, ahead[2]))
            joints.append(Joint(f"{name}_roller_{n}", "revolute", name, f"{name}_{n}",
                                axis=JointAxis(axis)))
    return robot(links, joints, driven), {
        "type": "mecanum_drive_controller/MecanumDriveController", "wheel_radius": RADIUS,
        **settings}


@pytest.mark.parametrize("x, yaw", [(0.5, 0.25), (-0.4, 0.3)])
def test_four_steered_wheels_drive_the_circle_of_the_twist(case, x, yaw):
    """Radius x / yaw about a point on the middle axis; wheels of a width rub as they turn."""
    model, settings = four_wheel_steering()
    one = case(model, **settings)
    one.drive(1.0, x, 0.0, yaw)     # wheels are steered
    before, told_before = one.truth(), one.told()
    one.drive(4.0, x, 0.0, yaw)
    after, told = one.truth(), one.told()
    turned = after[2] - before[2]
    chord = math.hypot(after[0] - before[0], after[1] - before[1])
    assert turned == pytest.approx(4.0 * yaw, rel=0.01)
    assert chord / (2.0 * math.sin(abs(turned) / 2.0)) == pytest.approx(abs(x / yaw), rel=0.01)
    assert told[2] - told_before[2] == pytest.approx(turned, rel=0.01)
    assert math.hypot(told[0] - after[0], told[1] - after[1]) < 0.02 * 5.0 * abs(x)


def test_two_equal_angles_drive_four_steered_wheels_aside_without_a_turn(case):
    model, settings = four_wheel_steering()
    one = case(model, **settings)
    for _ in range(30):
        one.deliver("robot/drive/cmd_four_wheel_steering", speed=0.5, front_steering_angle=0.3,
                 rear_steering_angle=0.3)
        one.sim.clock.advance(100)
    x, y, yaw = one.truth()
    assert math.atan2(y, x) == pytest.approx(0.3, abs=0.01) and abs(yaw) < 0.01
    assert one.told() == pytest.approx((x, y, yaw), abs=0.02)


@pytest.mark.parametrize("x, y, yaw", [(0.4, 0.0, 0.0), (0.0, 0.3, 0.0), (0.2, -0.2, 0.0),
                                       (0.0, 0.0, 0.5)])
def test_mecanum_wheels_go_each_way_that_is_commanded(case, x, y, yaw):
    model, settings = mecanum()
    one = case(model, **settings)
    one.drive(0.5, x, y, yaw)
    before, told_before = one.truth(), one.told()
    one.drive(2.0, x, y, yaw)
    true, told = ([b - a for a, b in zip(*pair)] for pair in (
        (before, one.truth()), (told_before, one.told())))
    assert told == pytest.approx([2.0 * x, 2.0 * y, 2.0 * yaw], abs=0.01)
    assert true == pytest.approx(told, abs=0.03)  # between two balls a wheel slips


def rover():
    """Six wheels, of which the four at the corners are steered."""
    places = {name.replace("rear", "back"): at for name, at in CORNERS.items()}
    links, joints, driven, settings = [base(20.0)], [], {}, {}
    for name, (x, y) in {**places, "mid_left": (0.0, 0.45), "mid_right": (0.0, -0.45)}.items():
        settings[f"{name}_wheel"] = f"{name}_axle"
        driven[f"{name}_axle"] = VELOCITY
        links.append(wheel(name, x, y))
        if name in places:
            carrier, steering = fork(name, x, y)
            links.append(carrier)
            joints.append(steering)
            settings[f"{name}_steer"], driven[f"{name}_steer"] = f"{name}_steer", POSITION
        joints.append(axle(f"{name}_axle", name, f"{name}_fork" if name in places else "base"))
    return robot(links, joints, driven), {
        "type": "ackermann_drive_controller/AckermannDriveController", "wheel_radius": RADIUS,
        "mid_wheel_lat_separation": 0.9, "front_wheel_lat_separation": 0.8,
        "front_wheel_lon_separation": 0.5, "back_wheel_lat_separation": 0.8,
        "back_wheel_lon_separation": 0.5, **settings}


@pytest.mark.parametrize("x, yaw", [(0.5, 0.4), (-0.4, 0.3), (0.0, 0.5)])
def test_a_rover_drives_the_circle_of_the_twist(case, x, yaw):
    model, settings = rover()
    one = case(model, **settings)
    one.drive(1.0, x=x, yaw=yaw)   # the wheels are steered while it moves
    before = one.truth()
    one.drive(3.0, x=x, yaw=yaw)
    x1, y1, heading = one.truth()
    turned = heading - before[2]
    assert turned == pytest.approx(3.0 * yaw, rel=0.02)
    chord = 2.0 * abs(x / yaw) * math.sin(turned / 2.0)
    assert math.hypot(x1 - before[0], y1 - before[1]) == pytest.approx(chord, rel=0.02, abs=0.02)


def car(width=0.1):
    """A narrow car: two driven wheels, two steered ones, as one of steer_drive_ros."""
    names = {"rear_right": (-0.5, -width / 2.0), "rear_left": (-0.5, width / 2.0),
             "front_right": (0.5, -width / 2.0), "front_left": (0.5, width / 2.0)}
    links, joints = [base()], []
    for name, (x, y) in names.items():
        links.append(wheel(name, x, y))
        carrier = "base"
        if name.startswith("front"):
            link, steering = fork(name, x, y)
            links.append(link)
            joints.append(steering)
            carrier = link.name
        joints.append(axle(f"{name}_axle", name, carrier))
    model = robot(links, joints, {}, "<robotSimType>steer_bot_hardware_gazebo/"
                                     "SteerBotHardwareGazebo</robotSimType>")
    axles = [f"{name}_axle" for name in names]
    return model, {"steer_bot_hardware_gazebo": {
        "rear_wheel": "rear_wheel_joint", "front_steer": "front_steer_joint",
        "virtual_rear_wheels": axles[:2],
        "virtual_front_steers": ["front_right_steer", "front_left_steer"],
        "enable_ackermann_link": True, "wheel_separation_w": width, "wheel_separation_h": 1.0}}, {
        "type": "steer_drive_controller/SteerDriveController", "rear_wheel": "rear_wheel_joint",
        "front_steer": "front_steer_joint", "wheel_separation_h": 1.0, "wheel_radius": RADIUS}


def test_a_car_drives_the_circle_of_its_steering_angle(case):
    model, hardware, settings = car()
    one = case(model, hardware, **settings)
    one.drive(1.0, x=0.4, yaw=0.4)   # angular.z is the angle
    before, told = one.truth(), one.told()
    one.drive(4.0, x=0.4, yaw=0.4)
    x, y, heading = one.truth()
    turned = heading - before[2]
    radius = math.hypot(x - before[0], y - before[1]) / (2.0 * math.sin(turned / 2.0))
    # The driven wheels turn alike without a differential, so they slip by the width.
    middle = 1.0 / math.tan(0.4)
    assert radius == pytest.approx(math.hypot(middle, 0.5), rel=0.03)
    assert one.told()[2] - told[2] == pytest.approx(4.0 * 0.4 / middle, rel=0.02)
    assert turned == pytest.approx(4.0 * 0.4 / middle, rel=0.03)
