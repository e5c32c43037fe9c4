"""Receivers on robots: gps, magnetic field, height, sonar, IMU, against their formulas."""
from __future__ import annotations

import json
import math

import numpy as np
import pytest

from my_simulations.description.sensor import (
    Camera,
    Gps,
    Magnetometer,
    Noise,
    Ray,
    ScanAngles,
    Sensor,
)
from my_simulations.description.surroundings import SphericalCoordinates
from my_simulations.geometry import Pose, Twist, quat_from_rpy
from my_simulations.plugins.sensors import environment, hector
from my_simulations.plugins.sensors.hector_errors import SensorErrors
from my_simulations.plugins.sensors.hector_imu import HectorImu
from my_simulations.plugins.sensors.segmentation import SegmentationCamera
from my_simulations.plugins.testing import FakeContext
from my_simulations.sensing import gps
from my_simulations.sensing.api import Pictures, RayReturns


def of(cls, inside="", pose=None, twist=None, seconds=0.25, **options):
    context = FakeContext(f"<plugin><updateRate>4</updateRate>{inside}</plugin>", **options)
    context.link("base").pose = pose or Pose()
    context.link("base").twist = twist or Twist()
    cls(context).load()
    context.advance(seconds)
    return context


def test_a_fix_lies_where_an_independent_ellipsoid_says():
    context = of(hector.Gps, "<referenceLatitude>40</referenceLatitude><referenceLongitude>10"
                 "</referenceLongitude><referenceHeading>90</referenceHeading>",
                 Pose((120.0, 50.0, 7.0)), Twist((2.0, 1.0, 0.5)))
    (fix,) = context.published["fix"]
    # Heading 90: the world's x points east and its y north. Earth-centred places agree to a few mm.
    lat, lon = math.radians(40.0), math.radians(10.0)
    x, y, z = gps.earth_centred(lat, lon, 0.0)
    east, north, up = 120.0, 50.0, 7.0
    there = (x - math.sin(lon) * east - math.sin(lat) * math.cos(lon) * north
             + math.cos(lat) * math.cos(lon) * up,
             y + math.cos(lon) * east - math.sin(lat) * math.sin(lon) * north
             + math.cos(lat) * math.sin(lon) * up, z + math.cos(lat) * north + math.sin(lat) * up)
    expected = gps.geodetic(*there)
    assert math.radians(fix.latitude) == pytest.approx(expected[0], abs=0.002 / 6.4e6)
    assert math.radians(fix.longitude) == pytest.approx(expected[1], abs=0.002 / 6.4e6)
    assert fix.altitude == pytest.approx(expected[2], abs=0.002)
    (velocity,) = context.published["fix_velocity"]
    # North, west, up.
    assert (velocity.vector.x, velocity.vector.y, velocity.vector.z) == pytest.approx(
        (1.0, -2.0, 0.5))
    assert fix.header.frame_id == "world"


def test_the_world_tells_where_it_is():
    context = FakeContext("<plugin><useWorldSphericalCoordinates>true"
                          "</useWorldSphericalCoordinates></plugin>")
    context.spherical_coordinates = SphericalCoordinates(latitude_deg=-33.0, longitude_deg=151.0,
                                                  elevation=20.0)
    hector.Gps(context).load()
    context.advance(0.25)
    (fix,) = context.published["fix"]
    assert (fix.latitude, fix.longitude, fix.altitude) == pytest.approx((-33.0, 151.0, 20.0))


def test_a_world_that_does_not_say_where_it_is_lies_on_the_equator_with_x_to_the_east():
    context = of(hector.Gps, "<useWorldSphericalCoordinates>true</useWorldSphericalCoordinates>",
                 Pose((10.0, 0.0, 0.0)))
    (fix,) = context.published["fix"]
    assert fix.latitude == pytest.approx(0.0, abs=1e-12) and fix.altitude == 0.0
    assert fix.longitude == pytest.approx(math.degrees(10.0 / 6378137.0))


def test_the_drift_of_the_velocity_is_integrated_into_the_place():
    context = FakeContext("<plugin><updateRate>4</updateRate><velocityDrift>0 0 1</velocityDrift>"
                          "<velocityDriftFrequency>1e-9</velocityDriftFrequency>"
                          "<driftFrequency>0</driftFrequency></plugin>")
    plugin = context.load(hector.Gps)
    context.advance(60.0)
    climb = context.published["fix_velocity"][-1].vector.z
    assert abs(climb) > 0.01
    # 240 samples; each one has what was integrated until the one before.
    assert context.published["fix"][-1].altitude == pytest.approx(59.75 * climb, rel=0.02)
    plugin.reset()
    context.advance(0.25)
    assert context.published["fix"][-1].altitude == 0.0


def test_errors_have_their_moments():
    context = FakeContext("<plugin><gaussianNoise>0.5 0.1 0</gaussianNoise><drift>2 0 0</drift>"
                          "<driftFrequency>10</driftFrequency><offset>0 0 3</offset></plugin>")
    errors = SensorErrors(context)
    apart = 3 * 10 ** 8   # ns: three time constants, after which samples are independent
    drawn = np.array([errors.apply((1.0, 1.0, 1.0), n * apart) for n in range(1, 2001)])
    assert drawn.mean(axis=0) == pytest.approx((1.0, 1.0, 4.0), abs=0.12)
    assert drawn.std(axis=0) == pytest.approx((math.hypot(2.0, 0.5), 0.1, 0.0), rel=0.05, abs=1e-9)
    again = SensorErrors(context)
    assert [again.apply((1.0, 1.0, 1.0), n * apart) for n in range(1, 4)] == drawn[:3].tolist()


def test_drift_has_its_time_constant():
    context = FakeContext("<plugin><drift>1</drift><driftFrequency>0.5</driftFrequency></plugin>")
    errors = SensorErrors(context, width=1)
    drawn = np.array([errors.apply((0.0,), n * 10 ** 8)[0] for n in range(1, 40001)])
    lag = 20  # 2 s: one time constant
    assert np.mean(drawn[lag:] * drawn[:-lag]) / np.var(drawn) == pytest.approx(
        math.exp(-1.0), abs=0.08)


def test_a_compass_feels_the_field_in_its_own_axes():
    inside = ("<magnitude>2</magnitude><inclination>60</inclination><referenceHeading>0"
              "</referenceHeading>")
    (plain,) = of(hector.Magnetic, inside).published["magnetic"]
    assert (plain.vector.x, plain.vector.y, plain.vector.z) == pytest.approx(
        (1.0, 0.0, -math.sqrt(3.0)))
    context = of(hector.Magnetic, inside + "<useMagneticFieldMsgs>1</useMagneticFieldMsgs>",
                 Pose(orientation=quat_from_rpy(0.0, 0.0, math.pi / 2)))
    (turned,) = context.published["magnetic"]
    field = turned.magnetic_field
    assert (field.x, field.y) == pytest.approx((0.0, -1.0), abs=1e-12)


def test_pressure_falls_with_the_height():
    context = of(hector.Baro, "<elevation>100</elevation>", Pose((0, 0, 50.0)))
    (height,) = context.published["pressure_height"]
    (altimeter,) = context.published["altimeter"]
    assert height.point.z == 50.0 and altimeter.altitude == 150.0
    # The barometric formula of the standard atmosphere: 12 Pa a metre at sea level.
    assert altimeter.pressure == pytest.approx(1013.25 * math.exp(-150.0 / 8434.0), abs=0.1)


def test_a_sonar_tells_the_nearest_and_its_view():
    ray = Ray(ScanAngles(3, 1.0, -0.2, 0.2), ScanAngles(3, 1.0, -0.1, 0.1), 0.1, 3.0)
    context = FakeContext(sensor=Sensor("s", "ray", ray=ray), sensor_link="base")
    context.returns = RayReturns(np.array([2.0, 0.7, math.inf]), np.zeros(3), np.zeros(3))
    hector.Sonar(context).load()
    context.advance(0.1)
    (found,) = context.published["sonar"]   # 10 Hz are the plugin's own
    assert (found.max_range, found.header.frame_id) == (3.0, "sonar_link")
    assert found.range == np.float32(0.7)
    assert found.field_of_view == pytest.approx(0.2)


def test_a_hector_imu_measures_at_rest_and_turning():
    context = of(HectorImu, "<topicName>imu/data</topicName>"
                 "<rateGaussianNoise>0.005 0.005 0.005</rateGaussianNoise>",
                 twist=Twist(angular=(0.0, 0.0, 0.7)))
    (sample,) = context.published["imu/data"]
    assert sample.linear_acceleration.z == pytest.approx(9.8)
    assert sample.angular_velocity.z == pytest.approx(0.7, abs=0.03)
    assert sample.angular_velocity_covariance[4] == pytest.approx(0.005 ** 2)
    assert sample.header.frame_id == "base" and "imu/data/calibrate" in context.services


def test_a_biased_accelerometer_tilts_what_it_takes_for_level():
    context = of(HectorImu, "<accelOffset>0.98 0 0</accelOffset><yawOffset>0.1</yawOffset>")
    (sample,) = context.published["imu"]
    turn = sample.orientation
    assert 2 * turn.y == pytest.approx(-0.1, abs=2e-3) and 2 * turn.z == pytest.approx(
        0.1, abs=2e-3)
    (bias,) = context.published["imu/bias"]
    assert bias.linear_acceleration.x == pytest.approx(0.98)


def of_sensor(cls, kind, block, **world):
    context = FakeContext(sensor=Sensor("s", kind, Pose((0.5, 0, 0)), update_rate=10.0,
                                        **{kind: block}), sensor_link="base")
    for name, value in world.items():
        setattr(context, name, value)
    cls(context).load()
    return context


def test_a_gps_sensor_measures_by_gazebos_model():
    place = SphericalCoordinates(latitude_deg=48.0, longitude_deg=11.0, elevation=500.0,
                                 heading_deg=180.0)
    context = of_sensor(environment.GpsSensor, "gps",
                        Gps(position_vertical=Noise("gaussian", stddev=2.0)),
                        spherical_coordinates=place)
    context.link("base").pose = Pose((10.0, 20.0, 0.0))
    context.link("base").twist = Twist((1.0, 0.0, 0.0))
    context.advance(40.0)
    fixes = context.published["robot/fix"]
    expected = gps.measure((10.5, 20.0, 0.0), (1.0, 0.0, 0.0), place)
    assert fixes[0].latitude == pytest.approx(expected.latitude_deg, abs=1e-9)
    heights = np.array([fix.altitude for fix in fixes])
    assert heights.mean() == pytest.approx(500.0, abs=0.4)
    assert heights.std() == pytest.approx(2.0, rel=0.12)
    assert context.published["robot/fix_velocity"][0].vector.x == pytest.approx(1.0)


def test_a_magnetometer_feels_the_worlds_field():
    context = of_sensor(environment.MagnetometerSensor, "magnetometer",
                        Magnetometer(x=Noise("gaussian", stddev=1e-7)),
                        magnetic_field=(5e-6, 2e-5, -4e-5))
    context.link("base").pose = Pose(orientation=quat_from_rpy(0.0, 0.0, math.pi / 2))
    context.advance(20.0)
    fields = np.array([(m.magnetic_field.x, m.magnetic_field.y, m.magnetic_field.z)
                       for m in context.published["robot/magnetic_field"]])
    assert fields.mean(axis=0) == pytest.approx((2e-5, -5e-6, -4e-5), abs=3e-8)
    assert fields[:, 0].std() == pytest.approx(1e-7, rel=0.15)
    assert np.ptp(fields[:, 1]) == 0.0


def test_an_altimeter_counts_from_where_it_began():
    context = of_sensor(environment.AltimeterSensor, "altimeter", None)
    context.link("base").pose = Pose((0.0, 0.0, 1.5))
    context.link("base").twist = Twist((0.0, 0.0, -0.3))
    context.advance(0.1)
    assert context.published["robot/altitude"][0].point.z == pytest.approx(1.5)
    assert context.published["robot/altitude_velocity"][0].vector.z == pytest.approx(-0.3)


def test_a_segmentation_camera_numbers_links():
    context = FakeContext(sensor=Sensor("s", "camera", update_rate=10.0,
                                        cameras=[Camera(width=3, height=1)]), sensor_link="base")
    context.labels = {4: "a::link", 7: "b::link"}
    SegmentationCamera(context).load()
    for rows in ([-1, 4, -1], [7, 4, -1]):
        context.pictures = [Pictures(labels=np.array([rows], np.int32))]
        context.advance(0.1)
    images = [np.frombuffer(one.data, np.uint16).tolist() for one in context.published["image_raw"]]
    assert images == [[0, 1, 0], [2, 1, 0]]
    assert [json.loads(one.data) for one in context.published["labels"]] == [
        {"1": "a::link"}, {"1": "a::link", "2": "b::link"}]
