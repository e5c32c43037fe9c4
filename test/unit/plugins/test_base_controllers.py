"""Controllers of bases with steered wheels and mecanum wheels; motors of legs; sensors."""
from __future__ import annotations

import math

import pytest
from planar_pose import planar_pose
from robot_control import Arm, hide_package

from my_simulations.description.model import JointAxis
from my_simulations.description.sensor import ForceTorque, Imu, Sensor
from my_simulations.engine.commands import JointWrench
from my_simulations.geometry import Pose, Twist
from my_simulations.plugins.context import PluginError
from my_simulations.plugins.control.four_wheel_steering_controller import (
    corners_of,
    fitted_motion,
    wheel_motions,
)

EFFORT = "hardware_interface/EffortJointInterface"
VELOCITY = "hardware_interface/VelocityJointInterface"
POSITION = "hardware_interface/PositionJointInterface"
FREE = JointAxis((0.0, 1.0, 0.0))


def go(robot, seconds, x=0.0, y=0.0, yaw=0.0):
    for _ in range(round(seconds / 0.1)):
        robot.deliver("drive/cmd_vel", linear={"x": x, "y": y}, angular={"z": yaw})
        robot.context.advance(0.1)


def car(**settings):
    robot = Arm(axis=FREE, names=("rear", "steer"), interfaces=(VELOCITY, POSITION),
                places={"rear": (-0.4, 0.0, 0.1), "steer": (0.6, 0.0, 0.1)},
                drive={"type": "ackermann_steering_controller/AckermannSteeringController",
                       "rear_wheel": "rear", "front_steer": "steer", "wheel_radius": 0.1,
                       **settings})
    robot.run("drive")
    return robot


def test_a_steered_axle_makes_a_circle_of_its_wheel_base():
    robot = car()
    go(robot, 0.3, yaw=0.4)                 # steer first
    go(robot, 2.0, x=0.5, yaw=0.4)
    assert robot.context.joints["rear"].velocity == pytest.approx(5.0)
    assert robot.at("steer") == pytest.approx(0.4, abs=1e-6)
    x, y, yaw = planar_pose(robot.published("drive/odom")[-1].pose.pose)
    radius = 1.0 / math.tan(0.4)            # the joints are 1 m apart
    assert yaw == pytest.approx(0.5 * 2.0 / radius, rel=0.02)
    assert (x, y) == pytest.approx((radius * math.sin(yaw), radius * (1.0 - math.cos(yaw))),
                                   abs=1e-6)
    twist = robot.published("drive/odom")[-1].twist.twist
    assert (twist.linear.x, twist.angular.z) == pytest.approx((0.5, 0.5 / radius), rel=1e-3)


def test_a_radius_multiplier_of_a_steered_axle_corrects_the_odometry_alone():
    """Unlike that of the two-wheeled controller, as in ros_controllers."""
    robot = car(wheel_radius_multiplier=1.1)
    go(robot, 1.0, x=0.5)
    assert robot.context.joints["rear"].velocity == pytest.approx(5.0)
    assert robot.published("drive/odom")[-1].twist.twist.linear.x == pytest.approx(0.55)


def test_without_feedback_the_odometry_is_that_of_the_commands():
    robot = car(open_loop=True)
    robot.context.joints["rear"].stuck = True
    go(robot, 1.0, x=0.5)
    assert planar_pose(robot.published("drive/odom")[-1].pose.pose) == pytest.approx(
        (0.5, 0.0, 0.0), abs=0.02)


WHEELS = ("front_left", "front_right", "rear_left", "rear_right")
STEERS = tuple(f"{name}_steer" for name in WHEELS)
PLACES = {name: (x, y, 0.1) for name, x, y in zip(WHEELS, (0.5, 0.5, -0.5, -0.5),
                                                  (0.4, -0.4, 0.4, -0.4))}
STEER_PLACES = {f"{name}_steer": (x, math.copysign(0.3, y), z)
                for name, (x, y, z) in PLACES.items()}


def four_wheels(**settings):
    robot = Arm(axis=FREE, names=(*WHEELS, *STEERS), interfaces=[VELOCITY] * 4 + [POSITION] * 4,
                places={**PLACES, **STEER_PLACES},
                drive={"type": "four_wheel_steering_controller/FourWheelSteeringController",
                       "front_wheel": list(WHEELS[:2]), "rear_wheel": list(WHEELS[2:]),
                       "front_steering": list(STEERS[:2]), "rear_steering": list(STEERS[2:]),
                       "wheel_radius": 0.1, **settings})
    robot.run("drive")
    return robot


@pytest.mark.parametrize("motion", [(1.0, 0.0, 0.0), (0.8, 0.2, 0.5), (-0.5, 0.1, 0.4)])
def test_wheels_that_roll_as_a_motion_says_tell_that_motion(motion):
    corners = corners_of(0.8, 1.0, 0.1)
    assert fitted_motion(corners, wheel_motions(corners, motion)) == pytest.approx(motion)


def test_all_wheels_stand_across_the_lines_to_the_centre_of_the_turn():
    robot = four_wheels()
    go(robot, 0.5, x=1.0, yaw=0.5)          # a circle of 2 m about (0, 2)
    for name in WHEELS:
        x, y, _ = STEER_PLACES[f"{name}_steer"]
        angle = robot.at(f"{name}_steer")
        assert math.tan(angle) == pytest.approx(x / (2.0 - y), abs=1e-6)
        ahead = PLACES[name][1] - y         # the wheel's place outside of its axis
        way = math.hypot(x, 2.0 - y) - ahead
        assert robot.context.joints[name].velocity == pytest.approx(0.5 * way / 0.1)


def test_a_turn_on_four_steered_wheels_closes_in_the_odometry():
    robot = four_wheels()
    go(robot, 2.0, x=1.0, yaw=0.5)
    first = planar_pose(robot.published("drive/odom")[-1].pose.pose)
    go(robot, 2.0, x=1.0, yaw=0.5)
    x, y, yaw = planar_pose(robot.published("drive/odom")[-1].pose.pose)
    turn = yaw - first[2]
    assert turn == pytest.approx(1.0, abs=1e-3)
    assert math.hypot(x - first[0], y - first[1]) == pytest.approx(4.0 * math.sin(turn / 2.0),
                                                                   abs=1e-3)
    state = robot.published("drive/odom_steer")[-1].data
    assert state.speed == pytest.approx(1.0, abs=1e-6)
    assert math.tan(state.front_steering_angle) == pytest.approx(0.25, abs=1e-3)
    assert state.rear_steering_angle == pytest.approx(-state.front_steering_angle, abs=1e-6)


def test_a_command_by_angles_goes_sideways():
    robot = four_wheels()
    for _ in range(10):
        robot.deliver("drive/cmd_four_wheel_steering", speed=0.5, front_steering_angle=0.3,
                   rear_steering_angle=0.3)
        robot.context.advance(0.1)
    assert [robot.at(name) for name in STEERS] == pytest.approx([0.3] * 4, abs=1e-6)
    twist = robot.published("drive/odom")[-1].twist.twist
    assert (twist.linear.x, twist.linear.y, twist.angular.z) == pytest.approx(
        (0.5 * math.cos(0.3), 0.5 * math.sin(0.3), 0.0), abs=1e-6)


def test_a_twist_that_is_no_number_changes_nothing_of_a_command_by_angles():
    robot = four_wheels()
    for _ in range(5):
        robot.deliver("drive/cmd_four_wheel_steering", speed=0.5, front_steering_angle=0.3,
                   rear_steering_angle=0.3)
        robot.deliver("drive/cmd_vel", linear={"x": math.nan, "y": 0.0}, angular={"z": 0.0})
        robot.context.advance(0.1)
    assert [robot.at(name) for name in STEERS] == pytest.approx([0.3] * 4, abs=1e-6)
    assert [text for text in robot.context.log_messages if "not finite" in text] == [
        "controller 'drive' ignores commands that are not finite"]


def test_an_axle_without_two_wheels_is_told():
    with pytest.raises(AssertionError, match="a left and a right"):
        four_wheels(front_wheel=["front_left"])


MECANUM = {"front_left_wheel_joint": "front_left", "back_left_wheel_joint": "rear_left",
           "back_right_wheel_joint": "rear_right", "front_right_wheel_joint": "front_right"}


def mecanum(**settings):
    robot = Arm(VELOCITY, axis=FREE, names=WHEELS, places=PLACES,
                drive={"type": "mecanum_drive_controller/MecanumDriveController",
                       "wheel_radius": 0.1, **MECANUM, **settings})
    robot.run("drive")
    return robot


def rates(robot):
    return tuple(robot.context.joints[name].velocity for name in WHEELS)


def test_mecanum_wheels_turn_for_each_way_as_their_rollers_say():
    robot = mecanum()
    go(robot, 0.2, x=0.5)
    assert rates(robot) == pytest.approx((5.0, 5.0, 5.0, 5.0))
    go(robot, 0.2, y=0.5)
    assert rates(robot) == pytest.approx((-5.0, 5.0, 5.0, -5.0))
    go(robot, 0.2, yaw=1.0)
    assert rates(robot) == pytest.approx((-9.0, 9.0, -9.0, 9.0))


@pytest.mark.parametrize("offset", [{}, {"x": 0.2, "y": -0.1, "theta": 0.3}])
def test_mecanum_odometry_is_the_way_that_was_commanded(offset):
    robot = mecanum(base_frame_offset=offset)
    go(robot, 0.3, x=0.2, y=0.1, yaw=0.4)
    twist = robot.published("drive/odom")[-1].twist.twist
    assert (twist.linear.x, twist.linear.y, twist.angular.z) == pytest.approx((0.2, 0.1, 0.4))
    assert len(robot.published("drive/odomTopic")) == len(robot.published("drive/odom"))


def motor():
    arm = Arm(EFFORT, go={"type": "unitree_legged_control/UnitreeJointController",
                          "joint": "one"})
    arm.run("go")

    def send(mode=10, q=0.0, dq=0.0, tau=0.0, stiffness=0.0, damping=0.0):
        arm.deliver("go/command", mode=mode, q=q, dq=dq, tau=tau, Kp=stiffness, Kd=damping)
    return arm, send


@pytest.mark.parametrize("stiffness, damping", [(100.0, 20.0), (100.0, 0.0), (0.0, 20.0),
                                                (0.0, 0.0)])
def test_a_leg_motor_gives_its_effort_on_top_of_stiffness_and_damping(stiffness, damping):
    arm, send = motor()
    joint = arm.context.joints["one"]
    joint.position, joint.velocity = 0.1, -0.2
    send(q=0.5, dq=0.3, tau=7.0, stiffness=stiffness, damping=damping)
    arm.context.advance(0.001)
    if stiffness or damping:
        assert joint.effort == pytest.approx(7.0 + stiffness * 0.4 + damping * 0.5)
    else:
        assert joint.servo.target == 7.0
    state = arm.published("go/state")
    arm.context.advance(0.009)
    assert state[-1].mode == 10 and state[-1].q == pytest.approx(joint.position)


def test_a_leg_motor_brakes_until_a_command_comes_and_when_told():
    arm, send = motor()
    joint = arm.context.joints["one"]
    joint.velocity = 1.0
    arm.context.advance(0.001)
    assert joint.effort == pytest.approx(-20.0)
    send(tau=3.0)
    send(mode=0)
    joint.velocity = 0.5
    arm.context.advance(0.001)
    assert joint.effort == pytest.approx(-10.0)


def test_a_leg_motor_leaves_its_loops_out_for_the_values_that_say_so():
    arm, send = motor()
    send(q=2.146e9, dq=16000.0, tau=2.0, stiffness=50.0, damping=5.0)
    assert arm.context.joints["one"].servo.target == 2.0


def test_sensors_of_the_robot_are_published_by_their_names():
    arm = Arm(imus={"type": "imu_sensor_controller/ImuSensorController", "publish_rate": 50},
              wrists={"type": "force_torque_sensor_controller/ForceTorqueSensorController",
                      "publish_rate": 50})
    context = arm.context
    context.model_sensors = [("base", Sensor("trunk_imu", "imu", imu=Imu()))]
    context.description.joints[0].sensors.append(
        Sensor("wrist", "force_torque", force_torque=ForceTorque()))
    context.joint_wrenches = {"one": JointWrench((0.0, 0.0, 9.0), (0.5, 0.0, 0.0),
                                           (0.0, 0.0, 0.0, 1.0))}
    arm.run("imus", "wrists")
    link = context.link("base")
    link.pose, link.twist = Pose(), Twist((0.0, 0.0, 0.0), (0.0, 0.0, 0.7))
    context.advance(0.05)
    imu = arm.published("trunk_imu")[-1]
    assert imu.header.frame_id == "base"
    assert imu.linear_acceleration.z == pytest.approx(9.8)
    assert imu.angular_velocity.z == 0.7
    wrench = arm.published("wrist")[-1]
    assert wrench.header.frame_id == "one"
    assert (wrench.wrench.force.z, wrench.wrench.torque.x) == (-9.0, -0.5)


def test_sensors_are_named_by_the_parameters_of_pal_hardware_gazebo():
    arm = Arm(imus={"type": "imu_sensor_controller/ImuSensorController", "publish_rate": 50},
              wrists={"type": "force_torque_sensor_controller/ForceTorqueSensorController",
                      "publish_rate": 50},
              imu={"base_imu": {"frame": "imu_frame", "gazebo_sensor_name": "trunk_imu"}},
              force_torque={"wrist_ft": {"frame": "ft_link", "sensor_joint": "one"}})
    context = arm.context
    context.model_sensors = [("base", Sensor("trunk_imu", "imu", imu=Imu()))]
    context.joint_wrenches = {"one": JointWrench((0.0, 0.0, 9.0), (0.5, 0.0, 0.0),
                                                 (0.0, 0.0, 0.0, 1.0))}
    arm.run("imus", "wrists")
    context.link("base").pose = Pose()
    context.advance(0.05)
    assert arm.published("base_imu")[-1].header.frame_id == "imu_frame"
    wrench = arm.published("wrist_ft")[-1]
    assert (wrench.header.frame_id, wrench.wrench.force.z) == ("one", 9.0)


def test_a_parameter_that_names_an_absent_imu_is_reported():
    arm = Arm(imus={"type": "imu_sensor_controller/ImuSensorController", "publish_rate": 50},
              imu={"base_imu": {"frame": "imu_frame", "gazebo_sensor_name": "trunk"}})
    assert not arm.load("imus")
    assert 'name="trunk"' in arm.context.log_messages[-1]


@pytest.mark.parametrize("kind", ["imu_sensor_controller/ImuSensorController",
                                  "force_torque_sensor_controller/ForceTorqueSensorController"])
def test_a_robot_without_such_sensors_is_told(kind):
    arm = Arm(sense={"type": kind, "publish_rate": 50})
    assert not arm.load("sense")
    assert "<sensor type=" in arm.context.log_messages[-1]


def test_messages_that_are_not_installed_leave_the_rest_working():
    robot = four_wheels()
    hide_package(robot.context, "four_wheel_steering_msgs")
    assert robot.switch((), ["drive"])
    assert robot.ask("unload_controller", name="drive").ok
    robot.run("drive")
    assert "cmd_vel only" in robot.context.log_messages[-1]
    go(robot, 0.2, x=0.5)
    assert robot.published("drive/odom")[-1].KIND == "nav_msgs/Odometry"


# -- cars and rovers -----------------------------------------------------------------------------

ROVER = {"front_left": (0.3, 0.25), "front_right": (0.3, -0.25), "mid_left": (0.0, 0.3),
         "mid_right": (0.0, -0.3), "back_left": (-0.25, 0.25), "back_right": (-0.25, -0.25)}


def rover(**settings):
    wheels = [f"{name}_wheel_joint" for name in ROVER]
    steers = [f"{name}_steer_joint" for name in ROVER if not name.startswith("mid")]
    robot = Arm(axis=FREE, names=(*wheels, *steers),
                interfaces=[VELOCITY] * 6 + [POSITION] * 4,
                drive={"type": "ackermann_drive_controller/AckermannDriveController",
                       "wheel_radius": 0.1, "mid_wheel_lat_separation": 0.6,
                       "front_wheel_lat_separation": 0.5, "front_wheel_lon_separation": 0.3,
                       "back_wheel_lat_separation": 0.5, "back_wheel_lon_separation": 0.25,
                       **settings})
    robot.run("drive")
    return robot


@pytest.mark.parametrize("speed, yaw", [(0.5, 0.5), (-0.5, 0.5), (0.1, -1.0), (0.0, 1.0),
                                        (0.5, 0.0)])
def test_all_wheels_of_a_rover_roll_about_one_centre(speed, yaw):
    robot = rover()
    go(robot, 0.5, x=speed, yaw=yaw)
    for name, (x, y) in ROVER.items():
        steer = robot.context.joints.get(f"{name}_steer_joint")
        angle = 0.0 if steer is None else steer.position
        assert abs(angle) <= math.pi / 2.0 + 1e-9
        rim = robot.context.joints[f"{name}_wheel_joint"].velocity * 0.1
        # the velocity of the ground below the wheel
        assert (rim * math.cos(angle), rim * math.sin(angle)) == pytest.approx(
            (speed - yaw * y, yaw * x), abs=1e-6)
    twist = robot.published("drive/odom")[-1].twist.twist
    assert (twist.linear.x, twist.angular.z) == pytest.approx((speed, yaw), abs=0.02)


def steer_bot(**settings):
    names = ("rear_right", "rear_left", "front_right", "front_left", "steer_right", "steer_left")
    robot = Arm(axis=FREE, names=names, interfaces=[VELOCITY] * 4 + [POSITION] * 2,
                places={"steer_right": (0.5, -0.3, 0.1), "steer_left": (0.5, 0.3, 0.1)},
                inside="<robotSimType>steer_bot_hardware_gazebo/SteerBotHardwareGazebo"
                       "</robotSimType>",
                steer_bot_hardware_gazebo={
                    "rear_wheel": "rear_wheel_joint", "front_steer": "front_steer_joint",
                    "virtual_rear_wheels": list(names[:2]),
                    "virtual_front_wheels": list(names[2:4]),
                    "virtual_front_steers": list(names[4:]), "enable_ackermann_link": True,
                    "wheel_separation_w": 0.6, "wheel_separation_h": 1.0, **settings},
                drive={"type": "steer_drive_controller/SteerDriveController",
                       "rear_wheel": "rear_wheel_joint", "front_steer": "front_steer_joint",
                       "wheel_separation_h": 1.0, "wheel_radius": 0.1})
    robot.run("drive")
    return robot


@pytest.mark.parametrize("order", [("steer_right", "steer_left"), ("steer_left", "steer_right")])
def test_the_wheels_of_a_car_stand_across_the_lines_to_the_centre_of_its_turn(order):
    robot = steer_bot(virtual_front_steers=list(order))
    go(robot, 1.0, x=0.5, yaw=0.4)
    radius = 1.0 / math.tan(0.4)
    assert robot.at("steer_left") == pytest.approx(math.atan(1.0 / (radius - 0.3)), abs=1e-6)
    assert robot.at("steer_right") == pytest.approx(math.atan(1.0 / (radius + 0.3)), abs=1e-6)
    for name in ("rear_right", "rear_left", "front_right", "front_left"):
        assert robot.context.joints[name].velocity == pytest.approx(5.0)
    assert robot.published("drive/odom")[-1].twist.twist.linear.x == pytest.approx(0.5, rel=1e-3)
    robot.switch(stop=["drive"])
    robot.context.advance(0.1)
    assert robot.context.joints["rear_left"].velocity == 0.0


def test_a_car_without_ackermanns_link_steers_both_wheels_alike():
    robot = steer_bot(enable_ackermann_link=False)
    go(robot, 1.0, x=0.5, yaw=0.4)
    assert robot.at("steer_left") == pytest.approx(0.4, abs=1e-6)
    assert robot.at("steer_right") == pytest.approx(0.4, abs=1e-6)


def test_a_car_needs_two_steered_wheels():
    with pytest.raises(PluginError, match="right and left"):
        steer_bot(virtual_front_steers=["steer_right"])


# -- PAL and Robotnik ----------------------------------------------------------------------------

def test_pals_base_goes_in_any_direction():
    names = ("left_front", "left_back", "right_back", "right_front")
    places = {"left_front": (0.3, 0.2, 0.1), "left_back": (-0.3, 0.2, 0.1),
              "right_back": (-0.3, -0.2, 0.1), "right_front": (0.3, -0.2, 0.1)}
    robot = Arm(axis=FREE, names=names, interfaces=[VELOCITY] * 4, places=places,
                drive={"type": "omni_drive_controller/OmniDriveController", "wheel_radius": 0.1,
                       "axis_separation_multiplier": 2.0, "wheel_radius_multiplier": 0.5,
                       **{f"{name}_wheel": name for name in names}})
    robot.run("drive")
    go(robot, 1.0, x=0.3, y=0.2, yaw=0.5)
    arm = (0.6 * 2.0 + 0.4) / 2.0
    rims = [robot.context.joints[name].velocity * 0.05 for name in names]
    assert rims == pytest.approx([0.3 - 0.2 - arm * 0.5, 0.3 + 0.2 - arm * 0.5,
                                  0.3 - 0.2 + arm * 0.5, 0.3 + 0.2 + arm * 0.5])
    twist = robot.published("drive/odom")[-1].twist.twist
    assert (twist.linear.x, twist.linear.y, twist.angular.z) == pytest.approx((0.3, 0.2, 0.5))


def test_limits_of_currents_must_name_all_actuators():
    robot = Arm(limits={"type": "pal_ros_controllers/CurrentLimitController",
                        "actuators": ["a", "b"]})
    robot.run("limits")
    robot.deliver("limits/command", actuator_names=["b", "a"], current_limits=[1.0, 1.0])
    assert robot.context.log_messages == []
    robot.deliver("limits/command", actuator_names=["b"], current_limits=[1.0])
    assert any("actuators a, b" in text for text in robot.context.log_messages)


def test_commands_of_joints_are_published_by_their_interfaces():
    robot = Arm(names=("turn", "roll", "push"), interfaces=(POSITION, VELOCITY, EFFORT), axis=FREE,
                read={"type": "joint_read_command_controller/JointReadCommandController"},
                turning={"type": "position_controllers/JointPositionController", "joint": "turn"},
                rolling={"type": "velocity_controllers/JointVelocityController", "joint": "roll"},
                pushing={"type": "effort_controllers/JointEffortController", "joint": "push"})
    robot.run("read", "turning", "rolling", "pushing")
    for name, value in (("turning", 0.5), ("rolling", -2.0), ("pushing", 3.0)):
        robot.deliver(f"{name}/command", data=value)
    robot.context.advance(0.02)
    told = robot.published("joint_commands")[-1]
    assert told.name == ["turn", "roll", "push"]
    assert (told.position, told.velocity, told.effort) == (
        [0.5, 0.0, 0.0], [0.0, -2.0, 0.0], [0.0, 0.0, 3.0])
