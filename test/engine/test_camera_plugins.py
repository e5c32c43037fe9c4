"""Cameras and lasers of robots with the real sensing process: what they publish, and its loss."""
from __future__ import annotations

import math
import os
import signal

import numpy as np
import pytest
from kinematic_backend import KinematicBackend
from plugin_case import PluginCase, kept
from waiting import until
from walking_figures import rod

from my_simulations.description.world import World
from my_simulations.formats.reading import read_any
from my_simulations.resources.resolver import Resolver

WORLD = """<sdf version="1.7"><world name="w">
<scene><ambient>1 1 1 1</ambient><background>0 0 0 1</background><shadows>0</shadows></scene>
<model name="wall"><static>1</static><pose>2.1 0 0 0 0 0</pose><link name="link">
  <collision name="c"><geometry><box><size>0.2 1 1</size></box></geometry></collision>
  <visual name="v"><geometry><box><size>0.2 1 1</size></box></geometry>
    <material><script><name>Gazebo/Red</name></script></material></visual>
</link></model>
<model name="eyes"><static>1</static><link name="head">{sensors}</link></model>{more}
</world></sdf>"""
CAMERA = """<sensor name="cam" type="depth"><update_rate>{rate}</update_rate>
<camera><horizontal_fov>1.2</horizontal_fov><image><width>160</width><height>120</height></image>
<clip><near>0.05</near><far>20</far></clip></camera>
<plugin name="p" filename="libgazebo_ros_openni_kinect.so"><cameraName>cam</cameraName>
<frameName>optical</frameName></plugin></sensor>"""
LASER = """<sensor name="laser" type="ray"><update_rate>10</update_rate><ray><scan><horizontal>
<samples>21</samples><min_angle>-0.2</min_angle><max_angle>0.2</max_angle></horizontal></scan>
<range><min>0.1</min><max>10</max></range></ray>
<plugin name="l" filename="libgazebo_ros_laser.so"><topicName>scan</topicName></plugin></sensor>"""
FOCAL = 80.0 / math.tan(0.6)


class Case(PluginCase):
    def __init__(self, sensors, more=""):
        world, _ = read_any(WORLD.format(sensors=sensors, more=more), Resolver(), "test.world")
        assert isinstance(world, World)
        super().__init__(world, KinematicBackend)

    def after(self, steps, topic, count):
        self.sim.clock.advance(steps)
        until(lambda: len(self.graph.on(topic)) >= count, f"{topic} is not published")
        return self.graph.on(topic)

    @property
    def sensing(self):
        processes = self.host._scene._processes   # for rays and for pictures
        return processes and processes[1]


@pytest.fixture
def case():
    yield from kept(Case)


def pixels(message, kind):
    return np.frombuffer(message.data, kind).reshape(message.height, message.width, -1)


def test_a_depth_camera_publishes_the_world(case):
    one = case(CAMERA.format(rate=10))
    one.after(100, "cam/points", 1)
    rgb = pixels(one.graph.on("cam/image_raw")[0], np.uint8)
    red = rgb[60, 80].tolist()
    assert red[0] > 200 and red[1:] == [0, 0] and rgb[0, 0].tolist() == [0, 0, 0]
    depth = pixels(one.graph.on("cam/depth/image_raw")[0], np.float32)[..., 0]
    assert depth[60, 80] == pytest.approx(2.0, abs=2e-4) and math.isnan(depth[0, 0])
    cloud = pixels(one.graph.on("cam/points")[0], np.float32)
    seen = np.isfinite(cloud[..., 2])
    assert cloud[seen][:, 0].max() == pytest.approx(0.5, abs=2.0 / FOCAL)
    assert cloud[seen][:, 2] == pytest.approx(2.0, abs=2e-4)
    assert cloud.view(np.uint8)[60, 80, 16:19].tolist() == red[::-1]
    stamps = {one.graph.on(f"cam/{name}")[0].header.stamp for name in (
        "image_raw", "camera_info", "depth/image_raw", "depth/camera_info", "points")}
    assert stamps == {100_000_000}


def test_edges_of_the_wall_lie_where_camera_info_says(case):
    one = case(CAMERA.format(rate=10))
    one.after(100, "cam/depth/image_raw", 1)
    info = one.graph.on("cam/depth/camera_info")[0]
    seen = np.isfinite(pixels(one.graph.on("cam/depth/image_raw")[0], np.float32)[60, :, 0])
    fx, cx = info.K[0], info.K[2]
    assert fx == pytest.approx(FOCAL)
    # A pixel is seen where its centre is on the wall, 1 m wide and 2 m away.
    expected = np.abs(np.arange(160) - cx) < fx * 0.5 / 2.0
    assert (seen == expected).all()


def test_a_world_stepped_by_hand_gets_each_picture_and_the_same_ones_again(case):
    def run():
        one = case(CAMERA.format(rate=50))
        images = one.after(400, "cam/image_raw", 20)
        until(lambda: len(one.graph.on("cam/depth/image_raw")) == 20, "depth")
        return ([(m.header.stamp, m.data) for m in images],
                [(m.header.stamp, m.data) for m in one.graph.on("cam/depth/image_raw")])

    first = run()
    assert [stamp for stamp, _ in first[0]] == [20_000_000 * n for n in range(1, 21)]
    assert first == run()


def test_a_running_world_leaves_late_pictures_out_and_goes_on(case):
    large = CAMERA.replace("<width>160</width>", "<width>1600</width>")
    one = case(large.replace("<height>120</height>", "<height>1200</height>").format(rate=1000))
    one.sim.clock.unpause()
    begun = one.sim.clock.sim_ns
    until(lambda: one.sim.clock.sim_ns - begun > 10 ** 9, "the world stands")
    assert len(one.graph.on("cam/image_raw")) < 500     # of 1000 that were due
    until(lambda: one.graph.on("cam/image_raw"), "a picture")
    late = [issue for issue in one.issues if "late" in issue.message]
    assert len(late) == 1 and "left out" in late[0].message
    assert "sensor 'cam'" in late[0].message


def test_three_depth_cameras_that_are_late_are_named_while_the_world_goes_on(case):
    large = CAMERA.replace("<width>160</width>", "<width>1600</width>").replace(
        "<height>120</height>", "<height>1200</height>").format(rate=1000)
    names = [f"cam{n}" for n in range(3)]
    one = case("".join(large.replace("cam<", f"{name}<").replace('"cam"', f'"{name}"')
                       for name in names))
    one.sim.clock.unpause()
    begun = one.sim.clock.sim_ns
    until(lambda: all(any(f"sensor '{name}' are late" in issue.message for issue in one.issues)
                      for name in names), "the late cameras are not named")
    until(lambda: one.sim.clock.sim_ns - begun > 10 ** 9, "the world stands")
    for name in names:
        until(lambda topic=f"{name}/points": one.graph.on(topic), f"{name}: a cloud")


def test_a_killed_sensing_process_costs_what_was_asked_and_nothing_else(case):
    one = case(CAMERA.format(rate=10) + LASER)
    one.after(100, "cam/image_raw", 1)
    one.after(0, "scan", 1)
    before = one.sensing.pid
    os.kill(before, signal.SIGKILL)
    one.after(500, "cam/image_raw", 3)
    scans = one.after(0, "scan", 3)
    assert one.sensing.pid not in (0, before)
    assert scans[-1].ranges[10] == pytest.approx(2.0, abs=1e-4)
    assert one.sim.clock.step == 600
    told = [issue.message for issue in one.issues]
    assert any("killed by SIGKILL" in text for text in told)
    assert not any("switched off" in text for text in told)


def test_nobody_who_looks_is_no_process(case):
    one = case(CAMERA.format(rate=10) + LASER)
    for name in ("image_raw", "image_raw/compressed", "depth/image_raw", "points"):
        one.graph.listen(f"cam/{name}", wanted=False)
    one.graph.listen("scan", wanted=False)
    one.after(300, "cam/camera_info", 3)
    assert one.sensing is None


def test_what_is_painted_anew_is_seen_anew(case):
    one = case(CAMERA.format(rate=10))
    one.after(100, "cam/image_raw", 1)
    one.sim.models.delete("wall")
    one.host.wait_until_loaded()
    seen = one.after(100, "cam/image_raw", 2)[1]
    assert pixels(seen, np.uint8)[60, 80].tolist() == [0, 0, 0]


GPU_LASER = LASER.replace('name="laser" type="ray"', 'name="sight" type="gpu_ray"').replace(
    "libgazebo_ros_laser.so", "libgazebo_ros_gpu_laser.so").replace("scan<", "sight<")
WALK = """<road name="road"><width>0.4</width><point>0 -1 -0.5</point><point>9 -1 -0.5</point>
<material><script><name>Gazebo/GreenGlow</name></script></material></road>
<actor name="man"><skin><filename>{skin}</filename></skin><script><loop>0</loop>
<trajectory id="0" type="walk"><waypoint><time>0</time><pose>1.1 0 -0.5 0 0 0</pose></waypoint>
<waypoint><time>0.6</time><pose>1.7 0 -0.5 0 0 0</pose></waypoint></trajectory></script></actor>"""


def test_cameras_and_gpu_lasers_see_an_actor_where_it_is_at_their_stamp_and_lasers_see_none(
        case, tmp_path):
    (tmp_path / "rod.dae").write_text(rod())
    one = case(CAMERA.format(rate=10) + LASER + GPU_LASER, WALK.format(skin=tmp_path / "rod.dae"))
    for n in range(1, 5):
        one.after(100, "sight", n)
        stamp = n * 100_000_000
        u = n / 6.0
        # Of a rod of 20 cm, along Gazebo's spline through two points 0.6 m apart.
        near = 1.0 + 0.6 * (0.5 * u + 1.5 * u ** 2 - u ** 3)
        assert one.last("sight", stamp).ranges[10] == pytest.approx(near, abs=1e-4)
        assert one.last("scan", stamp).ranges[10] == pytest.approx(2.0, abs=1e-4)
        depth = pixels(one.last("cam/depth/image_raw", stamp), np.float32)[..., 0]
        assert depth[60, 80] == pytest.approx(near, abs=2e-4)
    rgb = pixels(one.graph.on("cam/image_raw")[0], np.uint8)
    assert rgb[60, 80].tolist() == [255, 0, 0]
    # 2 m ahead, 1 m to the right, 0.49 m down
    at = round(59.5 + FOCAL * 0.49 / 2.0), round(79.5 + FOCAL * 1.0 / 2.0)
    assert rgb[at][1] > 150 > 100 > max(rgb[at][0], rgb[at][2])
