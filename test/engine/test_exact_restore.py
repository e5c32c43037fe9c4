"""What follows `save` and every `restore` of it is equal, bit for bit, whatever touches."""
from __future__ import annotations

import pickle
import random
from pathlib import Path

import pytest

import my_simulations
from my_simulations.engine.drive_commands import JointServo, PidGains
from my_simulations.engine.timed_forces import JointPid

ROOT = Path(__file__).resolve().parents[2]
BOX = """<sdf version="1.7"><model name="box"><link name="link">
<inertial><mass>2</mass><inertia><ixx>0.0133</ixx><iyy>0.0133</iyy><izz>0.0133</izz></inertia>
</inertial><collision name="c"><geometry><box><size>0.2 0.2 0.2</size></box></geometry>
</collision></link></model></sdf>"""
PENDULUM = """<sdf version="1.7"><model name="pendulum"><link name="rod">
<pose>0 0 1 0.7 0 0</pose><inertial><pose>0 0 -0.5 0 0 0</pose><mass>1</mass>
<inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia></inertial></link>
<joint name="pin" type="revolute"><parent>world</parent><child>rod</child>
<axis><xyz>1 0 0</xyz>{dynamics}</axis></joint></model></sdf>"""
SWING = PENDULUM.format(dynamics="")
DAMPED = PENDULUM.format(dynamics="<dynamics><damping>0.5</damping><spring_stiffness>3"
                                  "</spring_stiffness></dynamics>")
WHEEL = """<link name="{name}"><pose>0 {y} 0.1 1.5707963 0 0</pose><inertial><mass>0.5</mass>
<inertia><ixx>0.002</ixx><iyy>0.002</iyy><izz>0.0025</izz></inertia></inertial>
<collision name="c"><geometry><cylinder><radius>0.1</radius><length>0.04</length></cylinder>
</geometry></collision></link><joint name="{name}_joint" type="revolute"><parent>base</parent>
<child>{name}</child><axis><xyz>0 0 -1</xyz></axis></joint>"""
ROBOT = """<sdf version="1.7"><model name="robot"><link name="base"><pose>0 0 0.12 0 0 0</pose>
<inertial><mass>4</mass><inertia><ixx>0.05</ixx><iyy>0.05</iyy><izz>0.08</izz></inertia></inertial>
<collision name="c"><geometry><box><size>0.4 0.3 0.1</size></box></geometry></collision>
<collision name="caster"><pose>-0.15 0 -0.07 0 0 0</pose><geometry><sphere><radius>0.05</radius>
</sphere></geometry><surface><friction><ode><mu>0</mu><mu2>0</mu2></ode></friction></surface>
</collision></link>""" + "".join(WHEEL.format(name=name, y=y) for name, y in (
    ("left", 0.18), ("right", -0.18))) + "</model></sdf>"


@pytest.fixture
def world():
    with my_simulations.open_world() as opened:
        yield opened


def rows(world):
    """Poses and twists of all links, and all joints, as bytes."""
    links, joints = world.links(), world.joints()
    return b"".join(part.tobytes() for part in (
        links.pose.array, links.twist.array, joints.position.array, joints.rate.array))


def record(world, steps, act=lambda world, n: None):
    """States each 50 steps, before which `act` gives commands."""
    found = []
    for n in range(steps // 50):
        act(world, n)
        world.step(50)
        found.append(rows(world))
    return found


def assert_repeats(world, steps=500, act=lambda world, n: None):
    saved = world.save()
    first = record(world, steps, act)
    for before in (0, 137):
        world.step(before)
        world.restore(saved)
        assert world.time == saved.time
        assert record(world, steps, act) == first


def heap(world, count):
    place = random.Random(1)
    for n in range(count):
        world.spawn(BOX, f"box_{n}", [place.uniform(-0.3, 0.3), place.uniform(-0.3, 0.3),
                                      0.15 + 0.25 * (n // 4), 0, 0, place.uniform(0, 3)])


@pytest.mark.parametrize("before", [100, 300, 700, 5000])   # in the air, falling, rocking, asleep
def test_a_box_on_the_ground(world, before):
    world.spawn(BOX, pose=[0, 0, 0.5, 0.5, 0.3, 0.2])
    world.step(before)
    assert_repeats(world)


@pytest.mark.parametrize("before", [100, 1500])
def test_a_heap_of_a_hundred_boxes(world, before):
    heap(world, 100)
    world.step(before)
    assert_repeats(world, 200)


def test_a_pendulum_among_boxes(world):
    world.spawn(SWING)
    heap(world, 8)
    world.step(400)
    assert_repeats(world)


@pytest.mark.parametrize("name", ["exercises", "lab_room", "lab_course"])
@pytest.mark.parametrize("before", [0, 500, 3000])
def test_worlds_of_the_package(name, before):
    with my_simulations.open_world(str(ROOT / f"world/{name}.world")) as world:
        world.step(before)
        assert_repeats(world)


@pytest.mark.parametrize("dynamics", ["", "<dynamics><damping>10</damping></dynamics>"])
def test_a_motor_goes_on_driving(world, dynamics):
    world.spawn(PENDULUM.format(dynamics=dynamics))
    world.drive_joint("pendulum::pin", 2.0, 50.0)
    world.step(303)   # between two checks of the damper, which the motor cancels
    saved = world.save()
    first = record(world, 400)
    assert world.joints().rate.array[0] == pytest.approx(2.0, rel=1e-3)
    world.release_joint("pendulum::pin")
    world.step(100)
    world.restore(saved)
    assert record(world, 400) == first


def test_a_robot_that_is_driven_among_boxes(world):
    world.spawn(ROBOT)
    world.spawn(BOX, pose=[0.45, 0.05, 0.1])
    drive(world, 0)
    world.step(500)
    assert_repeats(world, 1000, drive)
    assert world.states().pose["box"][0] > 0.5   # it was pushed


def drive(world, n):
    world.drive_joint("robot::left_joint", 6.0 + 0.3 * (n % 5), 3.0)
    world.drive_joint("robot::right_joint", 6.0 - 0.2 * (n % 3), 3.0)


def test_a_robot_that_accelerates():
    robot = ROBOT.replace("</model>", """
        <plugin name="drive" filename="libgazebo_ros_diff_drive.so">
        <leftJoint>left_joint</leftJoint><rightJoint>right_joint</rightJoint>
        <wheelSeparation>0.36</wheelSeparation><wheelDiameter>0.2</wheelDiameter>
        <wheelAcceleration>0.3</wheelAcceleration><updateRate>30</updateRate></plugin></model>""")
    with my_simulations.open_world() as world:
        world.spawn(robot)
        world.step(100)
        world.publish("/robot/cmd_vel", {"linear": {"x": 0.6}, "angular": {"z": 0.5}})
        world.step(447)
        saved = world.save()
        speed = world.states().twist["robot"][0]
        first = record(world, 1000)
        assert speed < 0.2 and world.states().twist["robot"][0] > 0.4
        world.publish("/robot/cmd_vel", {"linear": {"x": -0.6}, "angular": {"z": 0.5}})
        world.step(100)
        world.restore(saved)
        assert record(world, 1000) == first


def test_attached_boxes(world):
    for n in range(3):
        world.spawn(BOX, f"box_{n}", [0.3 * n, 0, 0.5, 0.3, 0, 0])
    world.simulator.models.attach("one", "box_0::link", "box_1::link")
    world.simulator.models.attach("two", "box_1::link", "box_2::link")
    world.step(500)
    saved = world.save()
    first = record(world, 500)
    world.simulator.models.detach("one")
    world.step(300)
    world.restore(saved)
    assert record(world, 500) == first
    poses = world.states().pose
    assert sum((poses["box_1"][:3] - poses["box_0"][:3]) ** 2) == pytest.approx(0.09, rel=1e-3)


def test_a_wrench_goes_on_as_long_as_it_would_have(world):
    world.spawn(BOX, pose=[0, 0, 0.1])
    world.step(100)
    world.apply_wrench("box::link", (40, 0, 0), duration=0.3)
    world.step(100)
    saved = world.save()
    first = record(world, 500)
    travelled = world.states().pose["box"][0]
    world.restore(saved)
    world.simulator.wrenches.clear_wrenches("box::link")
    world.step(400)
    world.apply_wrench("box::link", (0, 90, 0))
    world.step(100)
    world.restore(saved)
    assert record(world, 500) == first
    assert travelled > 0.3


@pytest.mark.parametrize("gains", [
    JointServo(0, "effort", 0.5, gains=PidGains(20.0, 60.0, 3.0, -50.0, 50.0)),
    JointServo(0, "position", 0.5, gains=None, most_effort=20.0),
    JointServo(0, "position", 0.5, holds=True, most_effort=0.5),
    JointServo(0, "velocity", 0.5, drive_gains=PidGains(2.0, 30.0, 0.0, -50.0, 50.0))])
def test_a_servo_keeps_its_integral(world, gains):
    world.spawn(DAMPED)
    world.simulator.drives.set(servos=[gains])
    world.step(700)
    saved = world.save()
    first = record(world, 500)
    world.move_joint("pendulum::pin", -1.0, 50.0)
    world.step(200)
    world.restore(saved)
    assert record(world, 500) == first


def test_an_arm_that_stands_by_its_integral_does_not_sag_after_a_save(world):
    world.spawn(SWING)
    world.simulator.wrenches.apply_effort("pendulum::pin", JointPid(0.5, False, 20.0, 60.0, 3.0))
    world.step(8000)
    before = world.joints().position.array[0]
    assert before == pytest.approx(0.5, abs=1e-3)
    assert_repeats(world)
    assert world.joints().position.array[0] == pytest.approx(before, abs=1e-5)


def test_what_slept_stays_where_it_is(world):
    for n in range(6):
        world.spawn(BOX, f"box_{n}", [0, 0, 0.1 + 0.2 * n])
    world.step(4000)
    before, contacts = world.links().pose.array.copy(), world.contacts()
    assert not world.links().twist.array.any()
    saved = world.save()
    world.step(500)
    world.restore(saved)
    world.step(50)
    assert not world.links().twist.array.any()
    assert world.links().pose.array == pytest.approx(before, abs=1e-12)
    assert len(world.contacts()) == len(contacts)
    assert (sum(one.force for one in world.contacts())
            == pytest.approx(sum(one.force for one in contacts), rel=0.05))
    world.remove("box_0")
    world.step(500)
    assert world.states().pose["box_1"][2] < 0.15


def test_a_robot_that_stood_still_stays_where_it_is(world):
    world.spawn(ROBOT)
    world.step(6400)
    place = world.links().pose.array.copy()
    saved = world.save()
    world.step(4000)
    assert world.links().pose.array == pytest.approx(place, abs=2e-6)   # held again
    drive(world, 0)
    world.step(500)
    assert world.states().pose["robot"][0] > 0.1
    world.restore(saved)
    assert_repeats(world)


def test_what_slept_sleeps_after_two_saves(world):
    world.spawn(BOX, pose=[0, 0, 0.1])
    world.step(4000)
    world.save()
    world.save()
    world.step(5)
    world.save()
    world.step(20)
    assert not world.links().twist.array.any()


def test_a_box_that_was_just_put_into_the_air_does_not_sleep_there(world):
    world.spawn(BOX, pose=[0, 0, 0.1])
    world.step(4000)
    world.set_pose("box", [0, 0, 1])
    world.save()
    world.step(100)
    assert world.states().twist["box"][2] == pytest.approx(-0.98, rel=1e-3)


def test_models_that_came_and_went(world):
    for n in range(3):
        world.spawn(BOX, f"box_{n}", [0.05 * n, 0, 0.1 + 0.25 * n])
    world.spawn(SWING)
    world.drive_joint("pendulum::pin", 1.0, 50.0)
    world.step(200)
    saved, names = world.save(), world.names
    first = record(world, 500)
    world.remove("box_1")
    world.remove("pendulum")
    world.spawn(BOX, "another", [0, 0, 3])
    world.spawn(BOX, "box_1", [1, 0, 3])
    world.step(200)
    world.restore(saved)
    assert world.names == names
    assert record(world, 500) == first
    world.spawn(BOX, "another", [0, 0, 3])
    world.remove("box_2")
    world.step(10)


def test_a_changed_gravity_comes_back(world):
    world.spawn(BOX, pose=[0, 0, 0.4, 0.2, 0, 0])
    saved = world.save()
    first = record(world, 500)
    physics = world.simulator.physics
    physics.set(physics.settings, (0.0, 1.0, -3.0))
    world.step(100)
    world.restore(saved)
    assert physics.gravity == (0.0, 0.0, -9.8)
    assert record(world, 500) == first


def test_another_process_repeats_it_too(world):
    world.spawn(ROBOT)
    heap(world, 8)
    drive(world, 0)
    world.step(300)
    saved = pickle.loads(pickle.dumps(world.save()))
    first = record(world, 500, drive)
    with my_simulations.open_world() as other:
        other.spawn(BOX, "something", [0, 0, 1])
        other.restore(saved)
        assert other.time == saved.time
        assert record(other, 500, drive) == first


def test_a_model_that_was_stopped_stays_so(world):
    world.spawn(BOX, pose=[0, 0, 0.1])
    world.apply_wrench("box::link", (0, 0, 3000), duration=0.5)
    world.step(600)
    world.simulator.wrenches.clear_wrenches("box::link")
    assert not world.links().twist.array.any()
    assert_repeats(world, 300)
    assert not world.links().twist.array.any()


def test_a_save_changes_a_settled_heap_by_less_than_a_tenth_of_a_millimetre(world):
    heap(world, 20)
    world.step(6000)
    before = world.links().pose.array.copy()
    world.save()
    assert world.links().pose.array == pytest.approx(before, abs=1e-12)
    world.step(1000)
    assert world.links().pose.array == pytest.approx(before, abs=1e-4)


def test_a_save_does_not_change_a_flight(world):
    world.spawn(BOX, pose=[0, 0, 5, 0.5, 0.3, 0.2])
    world.set_pose("box", [0, 0, 5, 0.5, 0.3, 0.2], twist=[1, 0, 2, 3, 2, 1])
    world.simulator.resets.reset_simulation()
    world.set_pose("box", [0, 0, 5, 0.5, 0.3, 0.2], twist=[1, 0, 2, 3, 2, 1])
    world.step(500)
    plain = world.links().pose.array.copy()
    world.simulator.resets.reset_simulation()
    world.set_pose("box", [0, 0, 5, 0.5, 0.3, 0.2], twist=[1, 0, 2, 3, 2, 1])
    world.step(200)
    world.save()
    world.step(300)
    assert world.links().pose.array == pytest.approx(plain, abs=1e-9)


def test_a_reset_after_a_restore_repeats_the_start(world):
    heap(world, 8)
    world.simulator.resets.reset_simulation()
    world.step(500)
    first, saved = rows(world), world.save()
    world.restore(saved)
    world.simulator.resets.reset_simulation()
    world.step(500)
    assert rows(world) == first
