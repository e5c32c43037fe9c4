"""IMU, GPS, magnetometer and altimeter against their formulas."""
from __future__ import annotations

import math

import pytest

from my_simulations.description.surroundings import SphericalCoordinates
from my_simulations.geometry import (
    IDENTITY,
    STILL,
    Pose,
    Twist,
    compose,
    quat_from_rpy,
    rpy_from_quat,
)
from my_simulations.sensing import gps
from my_simulations.sensing.sensor_models import (
    acceleration_between,
    measure_altitude,
    measure_magnetic_field,
    measure_motion,
    velocity_at,
)

GRAVITY = (0.0, 0.0, -9.8)
NONE = (0.0, 0.0, 0.0)


def test_an_imu_at_rest_reads_g_upwards_whichever_way_it_is_mounted():
    found = measure_motion(IDENTITY, STILL, NONE, GRAVITY, IDENTITY)
    assert found.linear_acceleration == pytest.approx((0, 0, 9.8))
    tipped = measure_motion(IDENTITY, STILL, NONE, GRAVITY,
                            Pose((0.1, 0, 0), quat_from_rpy(math.pi / 2, 0, 0)))
    assert tipped.linear_acceleration == pytest.approx((0, 9.8, 0))
    assert tipped.angular_velocity == pytest.approx(NONE)


def test_an_imu_in_free_fall_reads_nothing():
    assert measure_motion(IDENTITY, STILL, GRAVITY, GRAVITY, IDENTITY
                          ).linear_acceleration == pytest.approx(NONE)


def test_a_spinning_imu_reads_its_rate_and_the_centripetal_acceleration():
    rate, lever, elapsed = 2.0, 0.5, 1e-4
    mount = Pose((lever, 0.0, 0.0), quat_from_rpy(0, 0, math.pi / 2))
    twist = Twist(angular=(0, 0, rate))
    poses = [Pose(orientation=quat_from_rpy(0, 0, rate * t)) for t in (-elapsed / 2, elapsed / 2)]
    before, now = (velocity_at(pose, twist, mount) for pose in poses)
    assert math.hypot(*now) == pytest.approx(rate * lever)
    found = measure_motion(IDENTITY, twist, acceleration_between(before, now, elapsed), NONE, mount)
    assert found.angular_velocity == pytest.approx((0, 0, rate))
    # Towards the axis: -x of the link, which is +y of a sensor turned by 90 degrees.
    assert found.linear_acceleration == pytest.approx((0, rate * rate * lever, 0), abs=1e-5)


def test_an_imus_orientation_refers_to_the_world_or_to_the_first_one():
    link, mount = Pose(orientation=quat_from_rpy(0, 0, 0.5)), Pose(
        orientation=quat_from_rpy(0, 0, 0.2))
    assert rpy_from_quat(measure_motion(link, STILL, NONE, GRAVITY, mount).orientation
                         ) == pytest.approx((0, 0, 0.7))
    first = compose(IDENTITY, mount).orientation
    assert rpy_from_quat(measure_motion(link, STILL, NONE, GRAVITY, mount, first).orientation
                         ) == pytest.approx((0, 0, 0.5))


def test_no_time_is_no_acceleration():
    assert acceleration_between((0, 0, 0), (1, 0, 0), 0.0) == NONE


def test_a_magnetometer_reads_the_worlds_field_in_its_own_axes():
    field = (5.5645e-6, 22.8758e-6, -42.3884e-6)
    assert measure_magnetic_field(IDENTITY, IDENTITY, field) == pytest.approx(field)
    turned = Pose(orientation=quat_from_rpy(0, 0, math.pi / 2))
    assert measure_magnetic_field(turned, IDENTITY, field) == pytest.approx(
        (field[1], -field[0], field[2]))


def test_an_altimeter_reads_height_and_climb_of_its_own_place():
    link = Pose((0, 0, 5.0))
    twist = Twist((0, 0, 1.0), (0, 1.0, 0))
    found = measure_altitude(link, twist, Pose((2.0, 0, 0.5)), 1.0)
    assert found == pytest.approx((4.5, 1.0 - 2.0))


def test_a_receiver_at_the_origin_reads_the_origin():
    zurich = SphericalCoordinates(latitude_deg=47.397742, longitude_deg=8.545594, elevation=488.0)
    found = gps.measure((0, 0, 10.0), (1.0, 2.0, 3.0), zurich)
    assert found[:3] == pytest.approx((47.397742, 8.545594, 498.0), abs=1e-9)


@pytest.mark.parametrize("latitude, longitude, altitude", [
    (0.0, 0.0, 0.0), (47.4, 8.5, 488.0), (-33.9, 151.2, 8000.0), (89.999, -120.0, 10.0),
    (-90.0, 0.0, 2800.0)])
def test_geodetic_undoes_earth_centred(latitude, longitude, altitude):
    place = gps.earth_centred(math.radians(latitude), math.radians(longitude), altitude)
    found = gps.geodetic(*place)
    assert math.degrees(found[0]) == pytest.approx(latitude, abs=1e-10)
    assert math.degrees(found[1]) == pytest.approx(longitude, abs=1e-9)
    assert found[2] == pytest.approx(altitude, abs=1e-6)


def test_earth_centred_knows_the_half_axes_of_wgs_84():
    assert gps.earth_centred(0.0, 0.0, 0.0) == pytest.approx((6378137.0, 0, 0))
    assert gps.earth_centred(math.pi / 2, 0.0, 0.0)[2] == pytest.approx(6356752.314245)


def test_a_hundred_metres_are_degrees_of_the_ellipsoid_with_gazebos_signs():
    origin = SphericalCoordinates(latitude_deg=47.0, longitude_deg=8.0, heading_deg=180.0)
    lat = math.radians(47.0)
    e2 = 1.0 - (6356752.314245 / 6378137.0) ** 2
    around = 6378137.0 / math.sqrt(1 - e2 * math.sin(lat) ** 2)
    along = 6378137.0 * (1 - e2) / (1 - e2 * math.sin(lat) ** 2) ** 1.5
    east = gps.measure((100.0, 0, 0), (1, 0, 0), origin)
    assert east.longitude_deg - 8.0 == pytest.approx(
        math.degrees(100.0 / (around * math.cos(lat))), rel=1e-6)
    assert east.velocity == pytest.approx((1, 0, 0))
    north = gps.measure((0, 100.0, 0), (0, 1, 0), origin)
    assert north.latitude_deg - 47.0 == pytest.approx(math.degrees(100.0 / along), rel=1e-4)
    assert north.velocity == pytest.approx((0, 1, 0))
    flipped = gps.measure((100.0, 0, 0), (1, 0, 0), SphericalCoordinates(
        latitude_deg=47.0, longitude_deg=8.0))
    assert flipped.longitude_deg < 8.0 and flipped.velocity == pytest.approx((-1, 0, 0))
