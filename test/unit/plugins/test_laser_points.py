"""Lasers that publish points, in a world without rays."""
from __future__ import annotations

import math

import numpy as np
import pytest

from my_simulations.description.sensor import Ray, ScanAngles, Sensor
from my_simulations.plugins.sensors.laser_points import BlockLaser, Velodyne
from my_simulations.plugins.sensors.ray_sensor import RaySensor
from my_simulations.plugins.sensors.rays import fan_of
from my_simulations.plugins.testing import FakeContext
from my_simulations.sensing.api import RayFan, RayReturns


def laser(cls, ranges, inside="", rows=2, retro=None):
    samples = len(ranges) // rows
    ray = Ray(ScanAngles(samples, 1.0, -0.5, 0.5), ScanAngles(rows, 1.0, -0.2, 0.2), 0.1, 5.0)
    context = FakeContext(f"<plugin><topicName>points</topicName><frameName>mast</frameName>"
                          f"{inside}</plugin>", sensor=Sensor("s", "ray", update_rate=10.0,
                                                              ray=ray), sensor_link="base")
    count = len(ranges)
    context.returns = RayReturns(np.array(ranges), np.zeros(count) if retro is None
                                 else np.array(retro), np.zeros(count, int))
    cls(context).load()
    return context


def test_a_block_laser_has_a_point_for_each_ray():
    context = laser(BlockLaser, [1.0, 2.0, 0.05, math.inf], retro=[1.0, 2.0, 3.0, 4.0])
    context.advance(0.1)
    (cloud,) = context.published["points"]
    first, second, near, far = ((p.x, p.y, p.z) for p in cloud.points)
    assert first == pytest.approx((math.cos(0.2) * math.cos(0.5), -math.cos(0.2) * math.sin(0.5),
                                   -math.sin(0.2)))
    assert second[1] == pytest.approx(2 * math.cos(0.2) * math.sin(0.5))
    assert (math.hypot(*near), math.hypot(*far)) == pytest.approx((0.1, 5.0))  # the range's ends
    assert cloud.channels[0].values == [1.0, 2.0, 3.0, 4.0]


def test_a_block_laser_of_one_row_lies_level():
    context = laser(BlockLaser, [1.0, 1.0, 1.0], rows=1)
    context.advance(0.1)
    assert all(math.isfinite(p.x) for p in context.published["points"][0].points)


def velodyne_points(cloud):
    kind = np.dtype({"names": [field.name for field in cloud.fields],
                     "formats": [{4: "<u2", 7: "<f4"}[field.datatype] for field in cloud.fields],
                     "offsets": [field.offset for field in cloud.fields],
                     "itemsize": cloud.point_step})
    return np.frombuffer(cloud.data, kind)


def away(points):
    return np.sqrt(points["x"] ** 2 + points["y"] ** 2 + points["z"] ** 2)


def test_a_velodyne_publishes_what_is_met_column_by_column():
    context = laser(Velodyne, [1.0, math.inf, 0.05, 2.0, 3.0, 4.0],
                    "<max_range>3.5</max_range>", retro=[9.0, 0, 0, 0, 0, 7.0])
    context.advance(0.1)
    (cloud,) = context.published["points"]
    points = velodyne_points(cloud)
    assert (cloud.height, cloud.width, cloud.is_dense) == (1, 3, True)
    assert [(f.name, f.offset, f.datatype) for f in cloud.fields] == [
        ("x", 0, 7), ("y", 4, 7), ("z", 8, 7), ("intensity", 12, 7), ("ring", 16, 4),
        ("time", 18, 7)]
    assert (cloud.point_step, cloud.row_step) == (22, 66) and not points["time"].any()
    assert points["ring"].tolist() == [0, 1, 1] and points["intensity"].tolist() == [9.0, 0, 0]
    assert away(points) == pytest.approx([1.0, 2.0, 3.0])
    assert points["z"][1] > 0 > points["z"][0]


def test_faint_returns_are_left_out_and_noise_is_along_the_ray():
    ranges = [2.0] * 2000
    context = laser(Velodyne, ranges, "<min_intensity>0.5</min_intensity>"
                    "<gaussianNoise>0.02</gaussianNoise>", retro=[0.0, 1.0] * 1000)
    context.advance(0.1)
    points = velodyne_points(context.published["points"][0])
    ranges = away(points)
    assert len(ranges) == 1000
    assert ranges.mean() == pytest.approx(2.0, abs=0.003) and ranges.std() == pytest.approx(
        0.02, rel=0.1)


@pytest.mark.filterwarnings("error")
def test_an_organized_cloud_has_nan_and_the_ring_where_a_point_is_left_out():
    context = laser(Velodyne, [1.0, math.inf, 0.05, 2.0, 3.0, 4.0],
                    "<min_intensity>0</min_intensity><organize_cloud>true</organize_cloud>",
                    retro=[9.0, 0.0, 0.0, 0.0, 0.0, -1.0])
    context.advance(0.1)
    (cloud,) = context.published["points"]
    points = velodyne_points(cloud)
    assert (cloud.height, cloud.width, cloud.row_step, cloud.is_dense) == (3, 2, 44, False)
    assert points["ring"].tolist() == [0, 1] * 3
    assert away(points) == pytest.approx([1.0, 2.0, math.nan, 3.0, math.nan, math.nan], nan_ok=True)
    assert np.isnan(points["intensity"]).tolist() == [False, False, True, False, True, True]


def test_what_noise_moves_out_of_the_limits_is_left_out():
    context = laser(Velodyne, [2.0] * 2000, "<gaussianNoise>0.02</gaussianNoise>"
                    "<min_range>1.99</min_range><max_range>2.01</max_range>")
    context.advance(0.1)
    ranges = away(velodyne_points(context.published["points"][0]))
    assert 500 < len(ranges) < 1000 and 1.99 < ranges.min() and ranges.max() < 2.01


def test_the_namespace_of_a_velodyne_is_its_prefix():
    context = laser(Velodyne, [1.0, 1.0], "<robotNamespace>/r1</robotNamespace>")
    context.advance(0.1)
    assert context.published["r1/points"][0].header.frame_id == "r1/mast"


def test_a_single_ray_looks_ahead_and_one_that_sees_visuals_along_the_minimum():
    """As Gazebo's MultiRayShape and GpuRaySensor."""
    one, many = ScanAngles(1, 1.0, -0.5, 0.5), ScanAngles(3, 1.0, -0.5, 0.5)
    level = fan_of(Ray(many, one, 0.1, 5.0))
    assert (level.min_angle, level.max_angle) == (-0.5, 0.5)
    assert (level.rows, level.min_elevation) == (1, 0.0)
    assert fan_of(Ray(one, many, 0.1, 5.0)).min_angle == 0.0
    assert fan_of(Ray(one, one, 0.1, 5.0), visuals=True) == RayFan(
        1, -0.5, 0.5, 1, -0.5, 0.5, 0.1, 5.0)


# -- rays of any output --------------------------------------------------------------------------

def of_rays(kind, ranges, inside="", **options):
    context = laser(RaySensor, ranges, f"<outputType>sensor_msgs/{kind}</outputType>{inside}",
                    **options)
    context.advance(0.1)
    return context.published["points"][0]


def test_rays_as_points_leave_out_what_is_not_met():
    cloud = of_rays("PointCloud2", [1.0, math.inf, 0.05, 2.0], "<minIntensity>3</minIntensity>",
                    retro=[1.0, 2.0, 3.0, 4.0])
    points = velodyne_points(cloud)
    assert away(points) == pytest.approx([1.0, 2.0]) and cloud.width == 2
    assert points["intensity"].tolist() == [3.0, 4.0]
    assert cloud.header.frame_id == "mast"


def test_rays_as_a_scan_and_as_a_range():
    assert of_rays("LaserScan", [1.0, 2.0, 3.0], rows=1).ranges == [1.0, 2.0, 3.0]
    told = of_rays("Range", [1.0, 0.7, 3.0], "<radiationType>infrared</radiationType>", rows=1)
    assert (told.range, told.radiation_type) == (np.float32(0.7), 1)
    assert told.field_of_view == pytest.approx(1.0)
    assert len(of_rays("PointCloud", [1.0, 2.0]).points) == 2


def test_an_unknown_output_of_rays_is_reported():
    context = laser(RaySensor, [1.0, 2.0], "<outputType>Rays</outputType>")
    assert any("outputType" in text for text in context.log_messages)
