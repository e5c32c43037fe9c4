"""What pages are sent of ROS messages, by the real message classes."""
from __future__ import annotations

import io
import math

import numpy as np
import pytest
from genpy import Duration
from geometry_msgs.msg import Point, Pose, PoseStamped, TransformStamped
from nav_msgs.msg import OccupancyGrid, Odometry, Path
from PIL import Image as Picture
from sensor_msgs.msg import (
    ChannelFloat32,
    CompressedImage,
    Image,
    Imu,
    LaserScan,
    PointCloud,
    PointCloud2,
    PointField,
    Range,
)
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker, MarkerArray

from my_simulations.editor.topics.message_views import UnviewableError, Viewer
from my_simulations.editor.transport.http_pages import Pages
from my_simulations.editor.transport.protocol import Protocol

TYPES = Protocol.from_folder(Pages.own_folder()).types


def view(message, kind=None):
    """Fields and payload of a message that alone has come; checked against the protocol."""
    viewer = Viewer(kind or message._type, lambda: 0.0)
    viewer.receive(message)
    frame, stamp, (fields, payload) = viewer.view()
    TYPES.check({"topic": "/t", "frame": frame, "stamp": stamp, "view": fields}, "TopicHead", "v")
    return fields, payload


def test_a_scan_keeps_what_was_hit_and_nothing_else():
    scan = LaserScan(angle_min=-1.0, angle_increment=0.5, range_min=0.1, range_max=5.0,
                     ranges=[0.05, 1.0, math.inf, -math.inf, 4.0])
    scan.header.frame_id = "laser"
    fields, payload = view(scan)
    assert fields["count"] == 5
    found = np.frombuffer(payload, "<f4")
    assert np.isnan(found[[0, 2, 3]]).all()
    assert found[[1, 4]].tolist() == [1.0, 4.0]


def test_a_range_without_an_echo_has_none():
    near = Range(field_of_view=0.2, min_range=0.1, max_range=2.0, range=1.5)
    assert view(near)[0]["range"] == 1.5
    near.range = math.inf
    assert view(near)[0]["range"] is None


def rgb_image(encoding="rgb8", width=4, height=2):
    pixels = np.zeros((height, width, 3), "u1")
    pixels[:, :, 0 if encoding == "rgb8" else 2] = 250
    padded = np.zeros((height, width * 3 + 5), "u1")
    padded[:, :width * 3] = pixels.reshape(height, -1)
    return Image(height=height, width=width, encoding=encoding, step=width * 3 + 5,
                 data=padded.tobytes())


@pytest.mark.parametrize("encoding", ["rgb8", "bgr8"])
def test_pictures_arrive_with_their_colours_whatever_the_order_and_padding(encoding):
    fields, payload = view(rgb_image(encoding))
    assert (fields["width"], fields["height"]) == (4, 2)
    red, green, blue = Picture.open(io.BytesIO(payload)).getpixel((1, 1))
    assert red > 200 > 60 > max(green, blue)


def test_large_pictures_are_made_smaller_and_say_their_size():
    fields, payload = view(rgb_image(width=1400, height=10))
    assert fields["width"] == 1400
    assert Picture.open(io.BytesIO(payload)).size[0] <= 640


def test_depths_are_grey_from_near_to_far_and_black_where_unknown():
    depths = np.array([[1.0, 3.0], [math.nan, 2.0]], "<f4").repeat(16, 0).repeat(16, 1)
    fields, payload = view(Image(height=32, width=32, encoding="32FC1", step=128,
                                 data=depths.tobytes()))
    assert (fields["near"], fields["far"]) == (1.0, 3.0)
    grey = Picture.open(io.BytesIO(payload))
    assert [grey.getpixel(at) for at in ((8, 8), (24, 8), (8, 24), (24, 24))] == \
        pytest.approx([0, 255, 0, 127], abs=6)


def test_a_compressed_picture_goes_on_as_it_is():
    data = io.BytesIO()
    Picture.new("RGB", (7, 5)).save(data, "PNG")
    fields, payload = view(CompressedImage(format="png", data=data.getvalue()))
    assert (fields["format"], fields["width"], fields["height"]) == ("image/png", 7, 5)
    assert payload == data.getvalue()


def test_what_no_browser_can_show_is_said():
    with pytest.raises(UnviewableError, match="yuv422"):
        view(Image(height=1, width=1, encoding="yuv422", step=2, data=b"\0\0"))


@pytest.mark.parametrize("sizes", [
    {"width": 2 ** 32 - 1, "height": 0, "step": 0}, {"width": 2 ** 32 - 1, "height": 2 ** 32 - 1},
    {"width": 0, "height": 1, "step": 12}, {"width": 4, "height": 1, "step": 11},
    {"width": 4, "height": 1, "step": 12, "data": bytes(11)},
    {"width": 4, "height": 1, "step": 12, "data": bytes(13)}])
@pytest.mark.parametrize("encoding", ["rgb8", "mono8", "32FC1"])
def test_pictures_whose_sizes_do_not_fit_their_bytes_are_refused(encoding, sizes):
    with pytest.raises(UnviewableError, match="bytes for"):
        view(Image(encoding=encoding, **{"data": b"", **sizes}))


def cloud(records, fields, height=1):
    return PointCloud2(
        height=height, width=len(records) // height, point_step=records.dtype.itemsize,
        row_step=records.dtype.itemsize * (len(records) // height), data=records.tobytes(),
        fields=[PointField(name, records.dtype.fields[name][1], kind, 1)
                for name, kind in fields.items()])


def test_a_cloud_gives_points_and_colours_without_what_is_no_point():
    records = np.zeros(4, np.dtype({"names": ["x", "y", "z", "rgb"], "itemsize": 32,
                                    "formats": ["<f4"] * 4, "offsets": [0, 4, 8, 16]}))
    records["x"], records["y"] = [1, 2, math.nan, 4], 7
    records["rgb"] = np.array([0x0A0B0C] * 4, "<u4").view("<f4")
    fields, payload = view(cloud(records, {"x": 7, "y": 7, "z": 7, "rgb": 7}, height=2))
    assert (fields["count"], fields["of"], fields["colored"]) == (3, 4, True)
    points = np.frombuffer(payload, "<f4", 9).reshape(3, 3)
    assert points.tolist() == [[1, 7, 0], [2, 7, 0], [4, 7, 0]]
    assert payload[36:39] == bytes((0x0A, 0x0B, 0x0C))


def test_intensities_that_are_no_numbers_do_not_take_the_colours_of_others():
    records = np.zeros(4, np.dtype([(name, "<f4") for name in ("x", "y", "z", "intensity")]))
    records["intensity"] = [1.0, 3.0, math.nan, math.inf]
    fields, payload = view(cloud(records, {name: 7 for name in records.dtype.names}))
    assert fields["colored"] and list(payload[48::3]) == [50, 255, 50, 255]


def test_a_turn_that_no_quaternion_can_be_is_none():
    odometry = Odometry()
    odometry.pose.pose.orientation.x = 1e308
    odometry.pose.pose.orientation.w = 1e308
    assert view(odometry)[0]["pose"][3:] == [0.0, 0.0, 0.0, 1.0]


def test_of_a_large_cloud_points_are_left_out_evenly():
    records = np.zeros(200000, np.dtype([("x", "<f4"), ("y", "<f4"), ("z", "<f4")]))
    records["x"] = np.arange(200000)
    fields, payload = view(cloud(records, {"x": 7, "y": 7, "z": 7}))
    assert fields["of"] == 200000 and 40000 < fields["count"] <= 60000
    assert len(payload) == 12 * fields["count"]
    assert np.frombuffer(payload, "<f4")[-3] > 199990


def test_the_old_cloud_is_shown_by_its_intensities():
    old = PointCloud(points=[Point(0, 0, 1), Point(0, 0, 2)],
                     channels=[ChannelFloat32("intensity", [0.0, 1.0])])
    fields, payload = view(old)
    assert fields["colored"] is True
    assert payload[24] < payload[27]


def test_odometry_paths_and_maps():
    odometry = Odometry(child_frame_id="base")
    odometry.pose.pose.position.x = 2.0
    odometry.twist.twist.linear.x = 0.5
    fields, _ = view(odometry)
    # A default message has a quaternion of zeros.
    assert fields["pose"] == [2.0, 0, 0, 0, 0, 0, 1.0] and fields["linear"] == [0.5, 0, 0]
    path = Path(poses=[PoseStamped() for _ in range(5000)])
    assert 1000 <= len(view(path)[0]["poses"]) <= 2000
    grid = OccupancyGrid(data=[-1, 0, 100, 50, 0, 0])
    grid.info.width, grid.info.height, grid.info.resolution = 3, 2, 0.05
    fields, payload = view(grid)
    assert payload == bytes((255, 0, 100, 50, 0, 0))


def transform(parent, child, x):
    made = TransformStamped(child_frame_id=child)
    made.header.frame_id = parent
    made.transform.translation.x = x
    return made


def test_tf_is_told_whole_although_it_comes_in_parts():
    viewer = Viewer(TFMessage._type, lambda: 0.0)
    viewer.receive(TFMessage([transform("odom", "base", 1.0)]))
    viewer.receive(TFMessage([transform("base", "laser", 0.2)]))
    viewer.receive(TFMessage([transform("odom", "base", 2.0)]))
    fields = viewer.view()[2][0]
    assert [(one["parent"], one["child"], one["pose"][0]) for one in fields["transforms"]] == \
        [("odom", "base", 2.0), ("base", "laser", 0.2)]


def test_markers_stay_until_they_are_deleted():
    def marker(number, action=0):
        return Marker(ns="n", id=number, action=action, type=Marker.LINE_STRIP,
                      points=[Point(0, 0, 0), Point(1, 0, 0)], pose=Pose())

    viewer = Viewer(MarkerArray._type, lambda: 0.0)
    viewer.receive(MarkerArray([marker(1), marker(2)]))
    viewer.receive(MarkerArray([]))
    viewer.receive(MarkerArray([marker(1, Marker.DELETE)]))
    assert [one["id"] for one in viewer.view()[2][0]["markers"]] == ["n/2"]
    viewer.receive(MarkerArray([marker(0, 3)]))
    assert viewer.view()[2][0]["markers"] == []
    assert view(marker(1))[0]["markers"][0]["shape"] == "line_strip"


class Trail:
    """A viewer of markers, and the sim time that it is told, s."""

    def __init__(self):
        self.now = 10.0
        self._viewer = Viewer(Marker._type, lambda: self.now)

    def receive(self, number, lifetime):
        self._viewer.receive(Marker(id=number, lifetime=Duration.from_sec(lifetime)))

    def shown(self):
        """Ids of what is shown, with what is left of its lifetime, s."""
        return {one["id"]: one["lifetime"] for one in self._viewer.view()[2][0]["markers"]}


def test_markers_go_when_their_lifetime_is_over():
    trail = Trail()
    trail.receive(1, 0.0)
    trail.receive(2, 0.5)
    trail.now = 10.2
    trail.receive(3, 0.5)
    assert trail.shown() == {"/1": 0.0, "/2": pytest.approx(0.3), "/3": pytest.approx(0.5)}
    trail.now = 10.6
    assert trail.shown() == {"/1": 0.0, "/3": pytest.approx(0.1)}
    trail.now = 0.0  # sim time was reset
    assert trail.shown() == {"/1": 0.0}


def test_the_newest_markers_are_shown_however_many_came_before():
    trail = Trail()
    trail.receive(0, 0.0)
    for number in range(1, 1500):
        trail.now += 0.1
        trail.receive(number, 0.45)
    assert set(trail.shown()) == {"/0", *(f"/{n}" for n in range(1495, 1500))}
    for number in range(2000, 3500):
        trail.receive(number, 0.0)
    assert list(trail.shown()) == [f"/{n}" for n in range(2500, 3500)]


def test_other_types_are_shown_as_text_with_long_lists_cut_short():
    imu = Imu()
    imu.header.frame_id = "imu_link"
    imu.linear_acceleration.z = 9.81
    text = view(imu)[0]["text"]
    assert 'frame_id: imu_link' in text and "z: 9.81" in text
    grid = OccupancyGrid(data=[0] * 1000)
    assert "(1000)" in view(grid, "other/Type")[0]["text"]
