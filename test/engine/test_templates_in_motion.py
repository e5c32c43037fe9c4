"""Templates of robots in a running world: they drive, turn, see, grip and hold."""
from __future__ import annotations

import math

import numpy as np
import pytest

import my_simulations
from my_simulations.messages import geometry_msgs, pixels
from my_simulations.robot_templates import template_named

HEAD = ('<include><uri>model://ground_plane</uri></include>'
        '<include><uri>model://sun</uri></include>')
WALL = """<model name="wall"><static>true</static><pose>2 0 0.5 0 0 0</pose><link name="link">
<collision name="c"><geometry><box><size>0.2 8 1</size></box></geometry></collision>
<visual name="v"><geometry><box><size>0.2 8 1</size></box></geometry><material>
<ambient>1 0 0 1</ambient><diffuse>1 0 0 1</diffuse></material></visual></link></model>"""


@pytest.fixture
def opened(tmp_path):
    worlds = []

    def start(name, more="", **values):
        text = template_named(name).sdf(values)
        model = text[text.index("<model"):text.rindex("</sdf>")]
        path = tmp_path / "template.world"
        path.write_text(f'<sdf version="1.6"><world name="w">{HEAD}{model}{more}</world></sdf>')
        worlds.append(my_simulations.open_world(str(path)))
        return worlds[-1]

    yield start
    for world in worlds:
        world.close()


def twist(x=0.0, yaw=0.0):
    return geometry_msgs.Twist(linear=geometry_msgs.Vector3(x=x),
                               angular=geometry_msgs.Vector3(z=yaw))


def yaw_of(pose):
    x, y, z, w = pose[3:]
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


@pytest.mark.parametrize("template, name", [("differential_drive", "car"),
                                            ("four_wheels", "rover")])
def test_a_car_stands_drives_straight_and_turns(opened, template, name):
    world = opened(template, camera=False)
    world.step(500)
    before = world.states().pose[name]
    assert before[:3] == pytest.approx((0.0, 0.0, 0.0), abs=0.005)
    world.publish("/cmd_vel", twist(x=0.3))
    world.step(2000)
    after = world.states().pose[name]
    assert 0.5 < after[0] - before[0] < 0.62
    assert abs(after[1]) < 0.02 and abs(yaw_of(after)) < 0.03
    world.publish("/cmd_vel", twist(yaw=0.8))
    world.step(1000)
    # Wheels that skid turn a car less than those that roll.
    assert yaw_of(world.states().pose[name]) - yaw_of(after) > (0.6 if name == "car" else 0.15)
    assert world.issues == []


def test_all_sensors_of_a_car_publish_what_is_before_it(opened):
    world = opened("differential_drive", WALL, laser=True, imu=True)
    world.step(200)
    image = pixels(world.topics["/camera/image_raw"].wait())
    assert image.shape == (240, 320, 3)
    red, green, blue = (float(part) for part in np.median(image[110:130, 150:170], axis=(0, 1)))
    assert red > 2 * green and red > 2 * blue
    scan = world.topics["/scan"].wait()
    laser = 1.9 + 0.2 * 0.4
    assert scan.ranges[len(scan.ranges) // 2] == pytest.approx(laser, abs=0.03)
    acceleration = world.topics["/imu"].wait().linear_acceleration
    assert acceleration.z == pytest.approx(9.8, abs=0.2)
    assert world.issues == []


def test_an_arm_stays_upright_and_its_gripper_opens(opened):
    world = opened("arm")
    world.step(2000)
    positions = dict(zip(*(lambda one: (one.name, one.position))(
        world.topics["/joint_states"].wait())))
    for joint in ("shoulder_pan", "shoulder_lift", "elbow", "wrist"):
        assert positions[joint] == pytest.approx(0.0, abs=0.02)
    for finger in ("left_finger_joint", "right_finger_joint"):
        assert positions[finger] == pytest.approx(0.04, abs=0.004)
    assert world.issues == []


@pytest.mark.parametrize("template, topic", [("camera", "/camera/image_raw"), ("laser", "/scan"),
                                             ("imu", "/imu")])
def test_a_sensor_alone_publishes(opened, template, topic):
    world = opened(template)
    assert world.topics[topic].wait() is not None
    assert world.issues == []
