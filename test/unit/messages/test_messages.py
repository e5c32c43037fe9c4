"""Messages as dataclasses: types from definitions, copies with the values that ROS would send."""
from __future__ import annotations

import numpy as np
import pytest

from my_simulations.messages import (
    Duration,
    MessageFieldError,
    MessageTypes,
    Time,
    UnknownTypeError,
    geometry_msgs,
    pixels,
    points,
    sensor_msgs,
)
from my_simulations.messages.conversion import Converter
from my_simulations.messages.definitions import (
    DefinitionError,
    parse_definition,
    standard_definitions,
    statements_of,
)
from my_simulations.messages.message_types import standard_type


@pytest.fixture
def user():
    return Converter(MessageTypes().message, numpy_arrays=True)


@pytest.fixture
def plugin():
    return Converter(MessageTypes().message, numpy_arrays=False)


def test_all_standard_types_can_be_made():
    assert len(standard_definitions()) > 100
    for kind in standard_definitions():
        made = standard_type(kind)
        assert made.KIND == kind and made() == made()


def test_fields_have_the_types_of_the_definition():
    scan = sensor_msgs.LaserScan()
    assert scan.ranges.dtype == np.float32 and scan.ranges.shape == (0,)
    assert sensor_msgs.Imu().orientation_covariance.shape == (9,)
    assert (scan.header.stamp, scan.header.frame_id, scan.angle_min) == (Time(), "", 0.0)
    assert sensor_msgs.PointField.FLOAT32 == 7


def test_a_copy_has_the_precision_of_its_type(user):
    scan = user.convert({"range_max": 0.1, "ranges": [0.1, 2]}, "sensor_msgs/LaserScan")
    assert scan.range_max == float(np.float32(0.1)) != 0.1
    assert scan.ranges.dtype == np.float32 and scan.ranges[0] == np.float32(0.1)


def test_a_copy_shares_nothing(user):
    first = sensor_msgs.JointState(name=["a"], position=np.array([1.0]))
    copy = user.convert(first, "sensor_msgs/JointState")
    assert copy == first
    first.position[0], first.header.frame_id = 2.0, "x"
    first.name.append("b")
    assert copy.position[0] == 1.0 and copy.header.frame_id == "" and copy.name == ["a"]
    assert copy != first


def test_plugins_receive_lists_and_bytes_as_from_rospy(plugin):
    image = plugin.convert({"data": np.arange(3, dtype=np.uint8)}, "sensor_msgs/Image")
    assert image.data == b"\x00\x01\x02"
    state = plugin.convert({"position": np.array([1.0])}, "sensor_msgs/JointState")
    assert state.position == [1.0]
    blank = plugin.blank("nav_msgs/Odometry")
    assert blank.pose.covariance == [0.0] * 36


@pytest.mark.parametrize("fields, text", [
    ({"liner": {"x": 1.0}}, "no field 'liner'"),
    ({"linear": {"x": "fast"}}, "Vector3.x cannot be 'fast'"),
    ({"linear": [1.0, 0.0, 0.0]}, "not a geometry_msgs/Vector3"),
    ({"linear": geometry_msgs.Point()}, "must be a geometry_msgs/Vector3"),
    (3.0, "not a geometry_msgs/Twist"),
])
def test_fields_that_do_not_fit_are_named(user, fields, text):
    with pytest.raises(MessageFieldError, match=text):
        user.convert(fields, "geometry_msgs/Twist")


def test_a_misspelt_attribute_is_found(user):
    twist = geometry_msgs.Twist()
    twist.liner = 1.0
    with pytest.raises(MessageFieldError, match="no field 'liner'"):
        user.convert(twist, "geometry_msgs/Twist")


@pytest.mark.parametrize("kind, fields", [
    ("std_msgs/UInt8", {"data": 256}), ("std_msgs/Int32", {"data": 1.5}),
    ("sensor_msgs/Imu", {"orientation_covariance": [0.0] * 8}),
    ("std_msgs/String", {"data": 3}), ("sensor_msgs/JointState", {"name": "joint"}),
    ("std_msgs/Float64", {"data": "1.5"}), ("std_msgs/Bool", {"data": "False"}),
    ("std_msgs/Float64", None), ("sensor_msgs/JointState", {"position": "12"}),
])
def test_values_that_ros_cannot_send_are_refused(user, kind, fields):
    with pytest.raises(MessageFieldError):
        user.convert(fields, kind)


def test_times():
    time = Time.of_ns(1_500_000_000)
    assert (time.secs, time.nsecs, time.to_nsec(), time.to_sec()) == (1, 5 * 10 ** 8,
                                                                     1_500_000_000, 1.5)
    point = Converter(standard_type, True).convert({"time_from_start": 0.25},
                                                   "trajectory_msgs/JointTrajectoryPoint")
    assert point.time_from_start == Duration(0, 250_000_000)


def test_types_of_packages_are_read_from_their_files(tmp_path):
    (tmp_path / "msg").mkdir()
    (tmp_path / "srv").mkdir()
    (tmp_path / "msg/Wheel.msg").write_text(
        "# a wheel\nuint8 LEFT=1 # one\nstring NAME = a # b\nHeader header\nSpoke[2] spokes\n")
    (tmp_path / "msg/Spoke.msg").write_text("float32 length  # m\n")
    (tmp_path / "srv/Turn.srv").write_text("geometry_msgs/Twist twist\n---\nbool ok\n")
    types = MessageTypes({"robot_msgs": str(tmp_path)}.get)
    wheel = types.message("robot_msgs/Wheel")
    assert (wheel.LEFT, wheel.NAME) == (1, "a # b") and len(wheel().spokes) == 2
    request, response = types.service("robot_msgs/Turn")
    assert request().twist.linear.x == 0.0 and response().ok is False
    for kind in ("robot_msgs/Lost", "other_msgs/Wheel", "nonsense"):
        with pytest.raises(UnknownTypeError):
            types.message(kind)


def test_statements_that_cannot_be_read():
    for text in ("float32", "uint8 A=x", "a b c"):
        with pytest.raises(DefinitionError):
            parse_definition("a/B", statements_of(text))


def test_pixels_and_points():
    rgb = np.arange(24, dtype=np.uint8).reshape(2, 4, 3)
    image = sensor_msgs.Image(height=2, width=4, encoding="rgb8", step=12, data=rgb.ravel())
    assert np.array_equal(pixels(image), rgb)
    depth = np.arange(8, dtype=np.float32).reshape(2, 4)
    image = sensor_msgs.Image(height=2, width=4, encoding="32FC1", step=16,
                              data=depth.ravel().view(np.uint8))
    assert np.array_equal(pixels(image), depth)
    fields = [sensor_msgs.PointField(name=name, offset=4 * n, datatype=7, count=1)
              for n, name in enumerate("xyz")]
    data = np.arange(6, dtype=np.float32)
    cloud = sensor_msgs.PointCloud2(height=1, width=2, fields=fields, point_step=12, row_step=24,
                                    data=data.view(np.uint8))
    assert points(cloud)["y"].tolist() == [[1.0, 4.0]]
