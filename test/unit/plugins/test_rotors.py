"""RotorS' plugins against their formulas."""
from __future__ import annotations

import math

import numpy as np
import pytest
from planar_pose import yaw_of

from my_simulations.description.model import Inertial, Joint, JointAxis
from my_simulations.description.sensor import Gps, Sensor
from my_simulations.description.surroundings import SphericalCoordinates
from my_simulations.geometry import Pose, Twist, quat_from_rpy
from my_simulations.plugins.context import PluginError
from my_simulations.plugins.flight.motor_model import MotorModel
from my_simulations.plugins.flight.multirotor_base import ControllerInterface, MultirotorBase
from my_simulations.plugins.flight.rotors_odometry import RotorsOdometry
from my_simulations.plugins.flight.rotors_sensors import (
    RotorsGps,
    RotorsImu,
    RotorsMagnetometer,
    RotorsPressure,
    air_pressure,
)
from my_simulations.plugins.flight.rotors_wind import RotorsWind
from my_simulations.plugins.testing import FakeContext

K, MOMENT = 8.54858e-06, 0.016


def loaded(cls, inside="", joints=(), **options):
    context = FakeContext(f"<plugin>{inside}</plugin>", joints=joints, **options)
    return context, context.load(cls)


ROTOR = ("<robotNamespace>mav</robotNamespace><jointName>rotor_1_joint</jointName><linkName>rotor_1"
         "</linkName><motorNumber>1</motorNumber>")


def motor(inside="<turningDirection>ccw</turningDirection>"):
    return loaded(MotorModel, ROTOR + inside, ["rotor_1_joint"])


def order(context, *speeds):
    context.deliver("mav/command/motor_speed", angular_velocities=list(speeds))


# -- rotors --------------------------------------------------------------------------------------

@pytest.mark.parametrize("way, sign", [("ccw", 1.0), ("cw", -1.0)])
def test_thrust_grows_with_the_square_of_the_speed(way, sign):
    context, _ = motor(f"<turningDirection>{way}</turningDirection>")
    order(context, 0.0, 500.0)
    context.advance(1.0)
    assert context.joints["rotor_1_joint"].velocity == pytest.approx(sign * 50.0)
    assert context.wrenches["rotor_1"][0] == pytest.approx((0.0, 0.0, K * 500.0 ** 2))
    assert context.wrenches["rotor_1"][1] == pytest.approx(
        (0.0, 0.0, -sign * MOMENT * K * 500.0 ** 2))


def test_a_rotor_follows_with_its_lags():
    context, _ = motor("<turningDirection>ccw</turningDirection><timeConstantUp>0.1"
                       "</timeConstantUp><timeConstantDown>0.2</timeConstantDown>")
    order(context, 0.0, 300.0)
    context.advance(0.1)
    speed = context.joints["rotor_1_joint"].velocity * 10.0
    assert speed == pytest.approx(300.0 * (1.0 - math.exp(-1.0)))
    order(context, 0.0, 0.0)
    context.advance(0.2)
    assert context.joints["rotor_1_joint"].velocity * 10.0 == pytest.approx(speed * math.exp(-1.0))


def test_commands_beyond_the_fastest_speed_are_limited_and_short_ones_reported():
    context, plugin = motor()
    order(context, 0.0, 5000.0)
    context.advance(1.0)
    assert context.joints["rotor_1_joint"].velocity == pytest.approx(83.8)
    order(context, 1.0)
    assert any("motor 1" in text for text in context.log_messages)
    plugin.reset()
    context.advance(0.01)
    assert context.wrenches["rotor_1"] == ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    assert not context.joints["rotor_1_joint"].servo.drive


def test_a_rotor_in_the_wind_is_dragged_across_its_axis():
    context, _ = motor()
    context.link("rotor_1").pose = Pose(orientation=quat_from_rpy(math.pi / 2, 0.0, 0.0))
    context.link("rotor_1").twist = Twist((3.0, 1.0, 0.0))
    context.deliver("mav/wind_speed", velocity={"x": 1.0, "y": 0.0, "z": 0.0})
    order(context, 0.0, 400.0)
    context.advance(1.0)
    # The axis is -y of the world; across it, the air passes at 2 m/s along x.
    assert context.wrenches["rotor_1"][0] == pytest.approx(
        (-400.0 * 1e-4 * 2.0, -K * 400.0 ** 2, 0.0), abs=1e-12)
    assert context.wrenches["rotor_1"][1] == pytest.approx(
        (-400.0 * 1e-6 * 2.0, MOMENT * K * 400.0 ** 2, 0.0), abs=1e-12)


def test_motors_by_force_and_by_position():
    context, _ = motor("<motorType>force</motorType>")
    order(context, 0.0, 0.25)
    assert context.joints["rotor_1_joint"].servo.target == 0.25
    context, _ = motor("<motorType>position</motorType><joint_control_pid><p>30</p><d>11</d>"
                       "</joint_control_pid>")
    order(context, 0.0, 0.5)
    context.advance(5.0)
    assert context.joints["rotor_1_joint"].position == pytest.approx(0.5, abs=1e-3)
    with pytest.raises(PluginError, match="jointName"):
        loaded(MotorModel)


def test_states_of_rotors_are_published_in_the_order_of_their_numbers():
    context = FakeContext("<plugin><linkName>base</linkName></plugin>",
                          joints=("b_joint", "a_joint"))
    context.description.joints = [
        Joint("b_joint", "continuous", "base", "rotor_1", axis=JointAxis()),
        Joint("a_joint", "continuous", "base", "rotor_0", axis=JointAxis()),
        Joint("arm_joint", "revolute", "base", "arm", axis=JointAxis())]
    MultirotorBase(context).load()
    context.joints["a_joint"].velocity, context.joints["b_joint"].velocity = 3.0, -4.0
    context.advance(0.001)
    assert context.published["joint_states"][-1].name == ["a_joint", "b_joint"]
    assert context.published["motor_speed"][-1].angular_velocities == [30.0, -40.0]


def test_commands_are_passed_on():
    context, _ = loaded(ControllerInterface, "<robotNamespace>mav</robotNamespace>")
    context.deliver("mav/command/motor_speed", angular_velocities=[1.0, 2.0])
    (passed,) = context.published["mav/gazebo/command/motor_speed"]
    assert passed.angular_velocities == [1.0, 2.0]


# -- odometry ------------------------------------------------------------------------------------

def odometry(inside="", seconds=0.001):
    context, _ = loaded(RotorsOdometry, f"<linkName>sensor</linkName>{inside}")
    context.link("sensor").pose = Pose((1.0, 2.0, 3.0), quat_from_rpy(0.0, 0.0, math.pi / 2))
    context.link("sensor").twist = Twist((0.5, 0.0, 0.1), (0.0, 0.2, 0.3))
    context.advance(seconds)
    return context


def test_odometry_has_velocities_in_the_axes_of_the_link():
    context = odometry()
    (told,) = context.published["odometry"]
    assert told.pose.pose.position.y == 2.0
    linear, angular = told.twist.twist.linear, told.twist.twist.angular
    assert (linear.x, linear.y, linear.z) == pytest.approx((0.0, -0.5, 0.1))
    assert (angular.x, angular.y, angular.z) == pytest.approx((0.2, 0.0, 0.3))
    assert context.published["transform"][-1].transform.translation.z == 3.0
    assert context.published["position"][-1].point.x == 1.0
    assert context.transforms[-1][:2] == ("world", "odometry_sensor")


def test_odometry_in_the_frame_of_another_link():
    context, _ = loaded(RotorsOdometry,
                        "<linkName>sensor</linkName><parentFrameId>base</parentFrameId>")
    context.link("base").pose = Pose((1.0, 0.0, 0.0))
    context.link("base").twist = Twist((0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    context.link("sensor").pose = Pose((3.0, 0.0, 0.0))
    context.link("sensor").twist = Twist((0.0, 2.0, 0.0), (0.0, 0.0, 1.0))
    context.advance(0.001)
    (told,) = context.published["odometry"]
    assert told.pose.pose.position.x == 2.0
    assert told.twist.twist.linear.y == pytest.approx(0.0)
    assert told.twist.twist.angular.z == pytest.approx(0.0)


def test_odometry_comes_late_and_not_in_every_step():
    context = odometry("<measurementDivisor>10</measurementDivisor>", 0.1)
    assert len(context.published["odometry"]) == 10
    context = odometry("<measurementDelay>5</measurementDelay>", 0.02)
    assert [one.header.stamp.to_nsec() for one in context.published["odometry"]] == [
        step * 10 ** 6 for step in range(1, 16)]


def test_noise_of_odometry_has_its_moments():
    context = odometry("<noiseNormalPosition>0.1 0 0</noiseNormalPosition>"
                       "<noiseUniformLinearVelocity>0 0 0.6</noiseUniformLinearVelocity>"
                       "<noiseNormalQuaternion>0 0 0.01</noiseNormalQuaternion>", 2.0)
    told = context.published["odometry"]
    x = np.array([one.pose.pose.position.x for one in told])
    vz = np.array([one.twist.twist.linear.z for one in told])
    assert (x.mean(), x.std()) == pytest.approx((1.0, 0.1), abs=0.01)
    assert vz.std() == pytest.approx(0.6 / math.sqrt(3.0), rel=0.05)
    assert abs(vz - 0.1).max() <= 0.6
    yaws = [yaw_of(one.pose.pose.orientation) for one in told]
    assert np.std(yaws) == pytest.approx(0.01, rel=0.1)
    assert told[0].pose.covariance[0] == pytest.approx(0.01)


# -- sensors -------------------------------------------------------------------------------------

QUIET = "".join(f"<{kind}{what}>0</{kind}{what}>" for kind in ("gyroscope", "accelerometer")
                for what in ("NoiseDensity", "TurnOnBiasSigma", "BiasRandomWalk", "RandomWalk"))


def test_an_imu_without_noise_feels_gravity_and_rates():
    context, _ = loaded(RotorsImu, "<linkName>imu</linkName>" + QUIET)
    context.link("imu").pose = Pose(orientation=quat_from_rpy(math.pi / 2, 0.0, 0.0))
    context.link("imu").twist = Twist((0.0, 0.0, 0.0), (0.0, 0.0, 2.0))
    context.advance(0.002)
    told = context.published["imu"][-1]
    assert (told.linear_acceleration.y, told.angular_velocity.y) == pytest.approx((9.8, 2.0))
    assert told.orientation_covariance == [-1.0] * 9


def test_noise_of_an_imu_has_its_density():
    context, _ = loaded(RotorsImu, "<linkName>imu</linkName>" + QUIET.replace(
        "<gyroscopeNoiseDensity>0", "<gyroscopeNoiseDensity>0.001"))
    context.advance(3.0)
    rates = np.array([one.angular_velocity.x for one in context.published["imu"]])
    assert rates.std() == pytest.approx(0.001 / math.sqrt(0.001), rel=0.05)


def test_a_magnetometer_feels_the_field_in_its_axes():
    context, _ = loaded(RotorsMagnetometer, "<linkName>mag</linkName><refMagNorth>1</refMagNorth>"
                        "<refMagEast>2</refMagEast><refMagDown>3</refMagDown>")
    context.link("mag").pose = Pose(orientation=quat_from_rpy(0.0, 0.0, math.pi / 2))
    context.advance(0.001)
    field = context.published["magnetic_field"][-1].magnetic_field
    assert (field.x, field.y, field.z) == pytest.approx((2.0, -1.0, 3.0))


def test_pressure_is_that_of_the_standard_atmosphere():
    assert air_pressure(0.0) == pytest.approx(101325.0)
    assert air_pressure(1000.0) == pytest.approx(89876.3, rel=1e-4)    # the tables of 1976
    assert air_pressure(5000.0) == pytest.approx(54048.3, rel=1e-4)
    context, _ = loaded(RotorsPressure, "<linkName>base</linkName>")
    context.pose = Pose((0.0, 0.0, 500.0))
    context.advance(0.001)
    assert context.published["air_pressure"][-1].fluid_pressure == pytest.approx(
        air_pressure(1000.0))


def test_a_gps_says_where_the_world_is_and_how_fast_the_link_moves():
    sensor = Sensor("gps", "gps", update_rate=5.0, gps=Gps())
    context, _ = loaded(RotorsGps, "<horVelStdDev>0</horVelStdDev><verVelStdDev>0</verVelStdDev>",
                        sensor=sensor, sensor_link="gps_link")
    context.spherical_coordinates = SphericalCoordinates(latitude_deg=47.0, longitude_deg=8.0,
                                                  elevation=500.0)
    context.link("gps_link").twist = Twist((1.0, 2.0, 3.0))
    context.advance(0.2)
    (fix,) = context.published["gps"]
    assert (fix.latitude, fix.longitude, fix.altitude) == pytest.approx((47.0, 8.0, 500.0))
    assert fix.position_covariance[0] == 9.0
    linear = context.published["ground_speed"][0].twist.linear
    assert (linear.x, linear.y, linear.z) == (1.0, 2.0, 3.0)


def test_a_gust_blows_for_its_time():
    context, _ = loaded(RotorsWind, "<linkName>base</linkName><xyzOffset>0 0 1</xyzOffset>"
                        "<windForceMean>2</windForceMean><windDirection>1 0 0</windDirection>"
                        "<windGustForceMean>3</windGustForceMean><windGustStart>0.1</windGustStart>"
                        "<windGustDirection>0 2 0</windGustDirection>"
                        "<windGustDuration>0.1</windGustDuration><windSpeedMean>4</windSpeedMean>")
    context.link("base").inertial = Inertial(1.0)
    context.advance(0.05)
    assert context.wrenches["base"] == ((2.0, 0.0, 0.0), (0.0, 2.0, 0.0))
    context.advance(0.1)
    assert context.wrenches["base"][0] == pytest.approx((2.0, 3.0, 0.0))
    assert context.published["external_force"][-1].wrench.force.y == pytest.approx(3.0)
    context.advance(0.1)
    assert context.wrenches["base"][0] == (2.0, 0.0, 0.0)
    assert context.published["wind_speed"][-1].velocity.x == 4.0
