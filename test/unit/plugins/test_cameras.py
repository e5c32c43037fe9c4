"""Plugins of cameras in a world without a renderer."""
from __future__ import annotations

import io
import math

import numpy as np
import pytest
from PIL import Image

from my_simulations.description.sensor import Camera as CameraBlock
from my_simulations.description.sensor import Lens, Noise, Sensor
from my_simulations.geometry import Pose
from my_simulations.plugins.context import PluginError
from my_simulations.plugins.sensors.camera import (
    Camera,
    MultiCamera,
    TriggeredCamera,
    TriggeredMultiCamera,
)
from my_simulations.plugins.sensors.depth_camera import DepthCamera, OpenniKinect
from my_simulations.plugins.sensors.image_messages import encode_picture
from my_simulations.plugins.sensors.realsense import RealSense
from my_simulations.plugins.sensors.thermal_camera import ThermalCamera
from my_simulations.plugins.testing import FakeContext
from my_simulations.sensing.api import DEPTH, RGB, Distortion, Pictures, WideLens

NAMES = "<cameraName>cam</cameraName><frameName>cam_optical</frameName>"
RAW, INFO = "cam/image_raw", "cam/camera_info"


def camera(inside="", block=None, kind="camera", rate=10.0, more=(), cls=Camera):
    block = block or CameraBlock(width=8, height=6)
    sensor = Sensor("s", kind, Pose((0.1, 0.0, 0.2)), update_rate=rate, cameras=[block, *more])
    context = FakeContext(f"<plugin>{NAMES}{inside}</plugin>", sensor=sensor, sensor_link="head")
    picture = np.arange(8 * 6 * 3, dtype=np.uint8).reshape(6, 8, 3)
    depth = np.full((6, 8), 2.0, np.float32)
    context.pictures = [Pictures(picture, depth)] * (1 + len(more))
    context.load(cls)
    return context


def test_a_picture_and_its_lens_have_one_stamp_and_the_sensors_rate():
    context = camera()
    context.advance(0.25)
    images, infos = context.published[RAW], context.published[INFO]
    assert [one.header.stamp.to_nsec() for one in images] == [100_000_000, 200_000_000]
    assert [one.header.stamp.to_nsec() for one in infos] == [100_000_000, 200_000_000]
    first = images[0]
    assert (first.header.frame_id, first.encoding, first.step) == ("cam_optical", "rgb8", 24)
    assert (first.height, first.width, len(first.data)) == (6, 8, 144)
    assert first.data == context.pictures[0].rgb.tobytes()


def test_who_begins_to_listen_to_a_slow_camera_gets_a_picture_at_once():
    context = camera(rate=0.5)
    context.unwanted.update((RAW, f"{RAW}/compressed"))
    context.advance(2.25)
    context.unwanted.clear()
    context.advance(4.0)
    assert [one.header.stamp.to_nsec() / 1e9 for one in context.published[RAW]] == [2.3, 4.0, 6.0]


def test_a_slow_camera_of_a_world_stepped_by_hand_keeps_to_its_rate():
    context = camera(rate=0.5)
    context.is_stepped_manually = True
    context.advance(4.5)
    assert [one.header.stamp.to_nsec() / 1e9 for one in context.published[RAW]] == [2.0, 4.0]


def test_a_triggered_camera_has_the_renderer_ready_and_publishes_nothing():
    context = camera(cls=TriggeredCamera)
    context.advance(0.35)
    assert len(context.views) == 1
    assert context.published[RAW] == []


def test_the_view_is_that_of_the_sensor_on_its_link():
    context = camera(block=CameraBlock(pose=Pose((0.0, 0.5, 0.0)), width=8, height=6, near=0.2,
                                       far=9.0, horizontal_fov=1.5))
    context.advance(0.1)
    ((view,),) = context.views
    assert (view.link, view.pose.position, view.outputs) == ("head", (0.1, 0.5, 0.2), (RGB,))
    assert (view.camera.near, view.camera.far, view.camera.hfov) == (0.2, 9.0, 1.5)


def test_camera_info_says_where_the_renderer_puts_points():
    context = camera("<hackBaseline>0.07</hackBaseline>",
                     CameraBlock(width=640, height=480, horizontal_fov=1.2))
    context.advance(0.1)
    (info,) = context.published[INFO]
    focal = 320.0 / math.tan(0.6)
    assert info.K == pytest.approx([focal, 0, 319.5, 0, focal, 239.5, 0, 0, 1])
    assert info.P[3] == pytest.approx(-focal * 0.07) and info.P[2] == 319.5
    assert (info.width, info.height, info.distortion_model) == (640, 480, "plumb_bob")
    assert info.D == [0.0] * 5


@pytest.mark.parametrize("wrong,drawn", [
    ({"horizontal_fov": 0.0}, (0.1, 0.1, 100.0)), ({"horizontal_fov": 3.2}, (3.13, 0.1, 100.0)),
    ({"near": 0.0}, (1.0, 0.01, 100.0)), ({"near": -1.0, "far": 0.0}, (1.0, 0.01, 100.01)),
    ({"near": 2.0, "far": 2.0}, (1.0, 2.0, 102.0)), ({"far": math.inf}, (1.0, 0.1, 1e4))])
def test_numbers_that_no_camera_has_are_replaced_and_told(wrong, drawn):
    context = camera(block=CameraBlock(**{"width": 8, "height": 6, "horizontal_fov": 1.0,
                                          "near": 0.1, "far": 100.0, **wrong}))
    context.advance(0.15)
    spec = context.views[0][0].camera
    assert (spec.hfov, spec.near, spec.far) == pytest.approx(drawn)
    assert len(context.log_messages) == 1 and "is drawn" in context.log_messages[0]


def test_a_lens_is_told_of_in_the_order_of_the_message():
    block = CameraBlock(width=640, height=480, k1=-0.2, k2=0.05, k3=0.01, p1=0.002, p2=0.003)
    context = camera("<borderCrop>false</borderCrop>", block)
    context.advance(0.1)
    assert context.published[INFO][0].D == [-0.2, 0.05, 0.002, 0.003, 0.01]
    assert context.views[0][0].camera.distortion == Distortion(-0.2, 0.05, 0.01, 0.002, 0.003)
    context = camera("<distortionK1>0.5</distortionK1>", block)
    context.advance(0.1)
    assert context.published[INFO][0].D == [0.5, 0.0, 0.0, 0.0, 0.0]


def test_a_cropped_barrel_lens_has_a_longer_focal_length():
    block = CameraBlock(width=640, height=480, k1=-0.2)
    plain, cropped = camera("<borderCrop>false</borderCrop>", block), camera("", block)
    for context in (plain, cropped):
        context.advance(0.1)
    assert cropped.published[INFO][0].K[0] > 1.05 * plain.published[INFO][0].K[0]


def test_nothing_is_drawn_for_nobody_and_nothing_for_who_wants_the_lens_alone():
    context = camera()
    context.unwanted = {RAW, INFO, f"{RAW}/compressed"}
    context.advance(0.1)
    assert not context.views and not context.published[INFO]
    context.unwanted = {RAW, f"{RAW}/compressed"}
    context.advance(0.1)
    assert not context.views and len(context.published[INFO]) == 1


def test_a_compressed_picture_is_decoded_to_the_raw_one():
    context = camera(block=CameraBlock(width=8, height=6))
    context.ros_parameters[f"{RAW}/compressed/format"] = "png"
    Camera(context).load()
    context.advance(0.1)
    message = context.published[f"{RAW}/compressed"][-1]
    assert message.format == "rgb8; png compressed bgr8"
    back = np.asarray(Image.open(io.BytesIO(message.data)))
    assert (back == context.pictures[0].rgb).all()
    jpeg = context.published[f"{RAW}/compressed"][0]
    assert jpeg.format == "rgb8; jpeg compressed bgr8"
    assert Image.open(io.BytesIO(jpeg.data)).size == (8, 6)


@pytest.mark.parametrize("encoding, kind, size", [
    ("rgb8", np.uint8, 9), ("bgr8", np.uint8, 9), ("mono8", np.uint8, 3), ("mono16", np.uint16, 3),
    ("rgb16", np.uint16, 9), ("bayer_rggb8", np.uint8, 3)])
def test_encodings_have_their_types_and_sizes(encoding, kind, size):
    rgb = np.zeros((4, 3, 3), np.uint8)
    rgb[:] = (255, 100, 0)
    made = encode_picture(rgb, encoding)
    assert made.dtype == kind and made[0].size == size
    assert {"bgr8": 0, "rgb16": 65535, "bayer_rggb8": 255}.get(encoding, made.flat[0]) \
        == made.flat[0]
    if encoding == "bayer_rggb8":
        assert made[:2, :2].tolist() == [[255, 100], [100, 0]]
    if encoding.startswith("mono"):
        assert made[0, 0] // (257 if encoding == "mono16" else 1) == round(0.299 * 255 + 58.7)


def test_an_unknown_format_is_told():
    context = camera(block=CameraBlock(width=8, height=6, format="YUV"))
    context.advance(0.1)
    assert "YUV" in context.log_messages[0] and context.published[RAW][0].encoding == "bgr8"


def test_the_noise_of_a_picture_belongs_to_its_moment():
    def run(skip):
        block = CameraBlock(width=8, height=6, noise=Noise("gaussian", stddev=0.1))
        context = camera(block=block)
        context.late = skip
        context.advance(0.1)
        context.late = False
        context.advance(0.1)
        return {one.header.stamp.to_nsec(): one.data for one in context.published[RAW]}

    whole, partial = run(False), run(True)
    assert whole[100_000_000] != whole[200_000_000]
    assert partial == {200_000_000: whole[200_000_000]}


def test_the_lower_rate_counts_and_a_camera_without_one_has_a_usual_one():
    for rate, said, count in ((10.0, "<updateRate>5</updateRate>", 5), (10.0, "", 10),
                              (0.0, "<updateRate>0</updateRate>", 30)):
        context = camera(said, rate=rate)
        context.is_stepped_manually = True
        context.advance(1.0)
        assert len(context.published[RAW]) == count


def test_names_are_in_the_namespace_of_the_robot():
    context = camera("<robotNamespace></robotNamespace>")
    assert "robot/cam/image_raw" in context.published
    context = camera("<robotNamespace>left</robotNamespace><imageTopicName>/view</imageTopicName>")
    assert "/view" in context.published and "left/cam/camera_info" in context.published


def test_another_calibration_can_be_set():
    context = camera()
    lens = [1.0, 0.0, 4.0, 0.0, 1.0, 3.0, 0.0, 0.0, 1.0]
    given = {"width": 8, "height": 6, "distortion_model": "none", "K": lens}
    assert context.call("cam/set_camera_info", camera_info=given).success
    context.advance(0.1)
    assert context.published[INFO][0].K == lens
    answer = context.call("cam/set_camera_info", camera_info={**given, "width": 9})
    assert not answer.success and "8x6" in answer.status_message


def test_a_camera_outside_of_a_camera_sensor_is_the_users_fault():
    with pytest.raises(PluginError, match="<camera>"):
        Camera(FakeContext(sensor=Sensor("s", "ray"))).load()


def test_a_trigger_takes_one_picture():
    context = camera(cls=TriggeredCamera)
    context.advance(0.3)
    assert not context.published[RAW]
    context.deliver("cam/image_trigger")
    context.advance(0.3)
    assert len(context.published[RAW]) == 1
    for _ in range(3):
        context.deliver("cam/image_trigger")
    context.late = True
    context.advance(0.1)
    context.late = False
    context.advance(0.5)
    assert len(context.published[RAW]) == 4


def test_a_trigger_does_not_wait_for_the_rate_of_the_sensor():
    context = camera(rate=1.0, cls=TriggeredCamera)
    context.advance(1.5)
    context.deliver("cam/image_trigger")
    context.deliver("cam/image_trigger")
    context.advance(0.01)
    assert [round(one.header.stamp.to_sec(), 2) for one in context.published[RAW]] == [1.5, 1.5]


def test_a_pair_looks_at_the_same_time_and_the_right_one_has_the_baseline():
    block = CameraBlock("left_eye", width=8, height=6)
    right = CameraBlock("right_eye", Pose((0.0, -0.07, 0.0)), width=8, height=6)
    context = camera("<hackBaseline>0.07</hackBaseline>", block, "multicamera", more=(right,),
                     cls=MultiCamera)
    context.advance(0.1)
    pairs = [context.published[f"cam/{side}/{name}"][0] for name in ("image_raw", "camera_info")
             for side in ("left", "right")]
    assert {one.header.stamp.to_nsec() for one in pairs} == {100_000_000}
    assert pairs[2].P[3] == 0.0 and pairs[3].P[3] < 0.0
    context.unwanted = {"cam/left/image_raw", "cam/left/image_raw/compressed"}
    context.advance(0.1)
    assert [view.pose.position[1] for view in context.views[1]] == [-0.07]


def test_each_camera_of_a_pair_has_a_trigger_of_its_own():
    block, right = (CameraBlock(f"{side}_eye", width=8, height=6) for side in ("left", "right"))
    context = camera("", block, "multicamera", more=(right,), cls=TriggeredMultiCamera)
    context.advance(0.3)
    context.deliver("cam/right/image_trigger")
    context.deliver("cam/right/image_trigger")
    context.deliver("cam/left/image_trigger")
    context.advance(0.3)
    assert [len(context.published[f"cam/{side}/image_raw"]) for side in ("left", "right")] == [1, 2]


def floats(message):
    return np.frombuffer(message.data, np.float32).reshape(message.height, message.width, -1)


def test_depth_is_in_metres_and_what_is_not_seen_is_nan():
    context = camera(kind="depth", cls=OpenniKinect)
    depth = np.full((6, 8), 2.0, np.float32)
    depth[0, :3] = (0.3, 6.0, math.inf)
    context.pictures = [Pictures(np.full((6, 8, 3), (10, 20, 30), np.uint8), depth)]
    context.advance(0.1)
    (image,) = context.published["cam/depth/image_raw"]
    assert (image.encoding, image.step) == ("32FC1", 32)
    seen = floats(image)[..., 0]
    assert np.isnan(seen[0, :3]).all() and (seen[1:] == 2.0).all()
    (info,) = context.published["cam/depth/camera_info"]
    assert info.K[2] == 3.5 and info.header.stamp == image.header.stamp
    assert context.views[0][0].outputs == (RGB, DEPTH)


def test_points_lie_where_pixels_look_with_their_colours():
    context = camera(kind="depth", cls=DepthCamera)
    context.pictures = [Pictures(np.full((6, 8, 3), (10, 20, 30), np.uint8),
                                 np.full((6, 8), 6.0, np.float32))]
    context.advance(0.1)
    (cloud,) = context.published["cam/points"]
    assert [(f.name, f.offset, f.datatype) for f in cloud.fields] == [
        ("x", 0, 7), ("y", 4, 7), ("z", 8, 7), ("rgb", 16, 7)]
    assert (cloud.point_step, cloud.row_step, cloud.is_dense) == (32, 256, True)
    focal = 4.0 / math.tan(1.047 / 2)
    points = floats(cloud)
    assert points[0, 7, :3] == pytest.approx([6 * 3.5 / focal, -6 * 2.5 / focal, 6.0])
    assert points.view(np.uint8)[2, 3, 16:20].tolist() == [30, 20, 10, 0]


def test_depth_in_millimetres():
    context = camera("<useDepth16UC1Format>true</useDepth16UC1Format>", kind="depth",
                     cls=DepthCamera)
    depth = np.full((6, 8), 1.2345, np.float32)
    depth[0, :2] = (math.inf, 70.0)
    context.pictures = [Pictures(np.zeros((6, 8, 3), np.uint8), depth)]
    context.advance(0.1)
    (image,) = context.published["cam/depth/image_raw"]
    values = np.frombuffer(image.data, np.uint16).reshape(6, 8)
    assert image.encoding == "16UC1" and values[0, :3].tolist() == [0, 0, 1234]


def test_only_what_is_wanted_is_drawn():
    context = camera(kind="depth", cls=OpenniKinect)
    colors = {RAW, f"{RAW}/compressed", "cam/points"}
    context.unwanted = set(colors)
    context.advance(0.1)
    context.unwanted = {"cam/depth/image_raw", "cam/points"}
    context.advance(0.1)
    context.unwanted = colors | {"cam/depth/image_raw"}
    context.advance(0.1)
    assert [view.outputs for (view,) in context.views] == [(DEPTH,), (RGB,)]
    assert len(context.published["cam/depth/camera_info"]) == 3


def realsense(inside="", names=("color", "depth", "ired1", "ired2")):
    context = FakeContext(f"<plugin name='camera'><prefix>d_</prefix>{inside}</plugin>")
    context.model_sensors = [(f"{name}_link", Sensor(
        f"d_{name}", "depth" if name == "depth" else "camera", update_rate=10.0,
        cameras=[CameraBlock(width=8, height=6, format="L8" if "ired" in name else "R8G8B8")]))
        for name in names]
    context.pictures = [Pictures(np.zeros((6, 8, 3), np.uint8), np.full((6, 8), 1.5, np.float32))]
    RealSense(context).load()
    return context


def test_a_realsense_looks_through_the_sensors_of_its_model():
    context = realsense("<pointCloud>true</pointCloud><colorUpdateRate>5</colorUpdateRate>"
                        "<depthTopicName>aligned/image_raw</depthTopicName>"
                        "<robotNamespace>/robot</robotNamespace>"
                        "<depthOpticalframeName>d_optical</depthOpticalframeName>")
    context.advance(0.2)
    assert len(context.published["camera/color/image_raw"]) == 1
    infrared = context.published["camera/infrared1/image_raw"]
    assert len(infrared) == 2 and infrared[0].encoding == "mono8"
    depth = context.published["camera/aligned/image_raw"][0]
    assert (depth.encoding, depth.header.frame_id) == ("16UC1", "d_optical")
    assert np.frombuffer(depth.data, np.uint16)[0] == 1500
    assert len(context.published["camera/depth/points"]) == 2
    assert {view.link for (view,) in context.views} == {
        "color_link", "depth_link", "ired1_link", "ired2_link"}


def test_points_of_a_realsense_have_limits_of_their_own():
    context = realsense("<pointCloud>true</pointCloud><pointCloudCutoff>1.6</pointCloudCutoff>"
                        "<pointCloudTopicName>depth/color/points</pointCloudTopicName>")
    context.advance(0.1)
    (cloud,) = context.published["camera/depth/color/points"]
    (depth,) = context.published["camera/depth/image_raw"]
    assert "camera/depth/camera_info" in context.published
    assert np.isnan(np.frombuffer(cloud.data, np.float32)[0]), "1.5 m is too near"
    assert np.frombuffer(depth.data, np.uint16)[0] == 1500


def test_a_realsense_does_without_a_camera_that_the_model_lacks():
    context = realsense(names=("depth",))
    context.advance(0.1)
    assert len(context.published["camera/depth/image_raw"]) == 1 and len(context.log_messages) == 3
    with pytest.raises(PluginError, match="d_color"):
        realsense(names=())


def wide(hfov=2.0, **lens):
    block = CameraBlock(width=8, height=6, horizontal_fov=hfov, lens=Lens(**lens))
    context = camera(block=block, kind="wideanglecamera")
    context.advance(0.15)
    return context


@pytest.mark.parametrize(("kind", "scale", "c2", "fun"), [
    ("gnomonical", 1.0 / math.tan(1.0), 1.0, "tan"),
    ("stereographic", 1.0 / math.tan(0.5), 2.0, "tan"),
    ("equidistant", 1.0, 1.0, "id"),
    ("equisolid_angle", 1.0 / math.sin(0.5), 2.0, "sin"),
    ("orthographic", 1.0 / math.sin(1.0), 1.0, "sin"),
])
def test_a_lens_is_scaled_to_the_field_of_view(kind, scale, c2, fun):
    lens = wide(type=kind).views[-1][0].camera.lens
    assert lens.scale == pytest.approx(scale)
    assert (lens.c2, lens.c3, lens.fun, lens.cutoff, lens.side) == (c2, 0.0, fun, 1.5707, 256)


def test_a_custom_lens_has_the_numbers_of_its_function():
    numbers = {"c1": 1.05, "c2": 4.0, "c3": 0.1, "f": 2.0, "fun": "tan"}
    context = wide(type="custom", scale_to_hfov=False, cutoff_angle=3.0, env_texture_size=512,
                   **numbers)
    assert context.views[-1][0].camera.lens == WideLens(2.1, 4.0, 0.1, "tan", 3.0, 512)
    scaled = wide(hfov=3.5, type="custom", **numbers).views[-1][0].camera.lens
    assert scaled.scale == pytest.approx(1.0 / math.tan(1.75 / 4.0 + 0.1))
    assert not context.log_messages
    focal = context.published[INFO][-1].K[0]
    assert focal == pytest.approx(4.0 * 2.1 / math.cos(0.1) ** 2 / 4.0)


def test_only_a_wide_angle_camera_has_a_lens():
    context = camera(block=CameraBlock(width=8, height=6, lens=Lens(type="equidistant")))
    context.advance(0.15)
    assert context.views[-1][0].camera.lens is None


@pytest.mark.parametrize(("lens", "words"), [
    ({"type": "round"}, "'round'; there are gnomonical, "),
    ({"type": "custom", "fun": "cos"}, "'cos'; there are tan, sin, id"),
    ({"type": "gnomonical", "hfov": 3.2}, "does not see a field of view of 3.2 rad"),
    ({"type": "custom", "c2": 0.0}, "does not see a field of view"),
])
def test_a_lens_that_there_is_not_is_told(lens, words):
    with pytest.raises(PluginError, match=words):
        wide(**lens)


def test_pure_red_is_hot_and_all_else_is_cold():
    context = camera(cls=ThermalCamera)
    picture = np.zeros((6, 8, 3), np.uint8)
    picture[0, 0], picture[0, 1], picture[0, 2] = (255, 0, 0), (255, 1, 0), (255, 255, 255)
    context.pictures = [Pictures(picture, None)]
    context.advance(0.15)
    told = context.published[RAW][-1]
    assert (told.encoding, told.step) == ("mono8", 8)
    assert list(told.data[:4]) == [255, 256 // 8, 3 * 255 // 8, 0]
