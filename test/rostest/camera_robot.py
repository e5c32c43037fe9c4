#!/usr/bin/env python3
"""Colours, depth, points, scans and motion of robots as ROS programs get them."""
import io
import math
import os
import signal
import subprocess
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import numpy as np
import rospy
from PIL import Image as Picture
from sensor_msgs.msg import CameraInfo, CompressedImage, Image, Imu, LaserScan, PointCloud2
from sensor_msgs.point_cloud2 import read_points
from sensor_msgs.srv import SetCameraInfo
from support import SECONDS, Collected, Gazebo, pose, run, wait_for

ROBO = "robo"
WIDTH, HEIGHT, HFOV = 160, 120, 1.2
FOCAL = WIDTH / 2 / math.tan(HFOV / 2)
BOX = """<sdf version="1.6"><model name="wall"><static>1</static><link name="link">
<collision name="c"><geometry><box><size>0.2 1 1</size></box></geometry></collision>
<visual name="v"><geometry><box><size>0.2 1 1</size></box></geometry>
<material><script><name>Gazebo/Red</name></script></material></visual></link></model></sdf>"""
EYES = f"""<sdf version="1.6"><model name="eyes"><static>1</static><link name="head">
<sensor name="kinect" type="depth"><update_rate>10</update_rate>
<camera><horizontal_fov>{HFOV}</horizontal_fov>
<image><width>{WIDTH}</width><height>{HEIGHT}</height></image>
<clip><near>0.05</near><far>20</far></clip></camera>
<plugin name="kinect" filename="libgazebo_ros_openni_kinect.so"><cameraName>kinect</cameraName>
<frameName>kinect_optical</frameName></plugin></sensor></link></model></sdf>"""


def sensing_children():
    """Process numbers of the sensing processes of the simulator."""
    found = subprocess.run(["ps", "-eo", "pid=,ppid=,args="], stdout=subprocess.PIPE, text=True,
                           check=True).stdout
    node = rospy.get_param("/gazebo/my_simulations/engine_pid")
    parents = {int(line.split()[0]): int(line.split()[1]) for line in found.splitlines()}
    return [int(line.split()[0]) for line in found.splitlines()
            if "my_simulations.sensing" in line and int(line.split()[1]) == parents.get(node)]


class CameraRobot(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.gazebo = Gazebo()
        wait_for(lambda: ROBO in cls.gazebo.names(), "the robot")
        cls.before = sensing_children()
        assert cls.gazebo.spawn_sdf_model("wall", BOX, "", pose(2.1, 5.0, 0.5), "").success
        assert cls.gazebo.spawn_sdf_model("eyes", EYES, "/", pose(0.0, 5.0, 0.5), "").success

    def test_0_nothing_looks_before_somebody_listens(self):
        self.assertEqual(self.before, [])

    def first(self, topic, kind):
        found = Collected(topic, kind)
        return wait_for(found.all, f"a message on {topic}")[0]

    def test_colours(self):
        image = self.first("/kinect/image_raw", Image)
        self.assertEqual((image.width, image.height, image.encoding), (WIDTH, HEIGHT, "rgb8"))
        self.assertEqual(image.header.frame_id, "kinect_optical")
        seen = np.frombuffer(image.data, np.uint8).reshape(HEIGHT, WIDTH, 3)
        red, green, blue = seen[HEIGHT // 2, WIDTH // 2].tolist()
        self.assertGreater(red, 60)
        self.assertEqual((green, blue), (0, 0))

    def test_compressed(self):
        message = self.first("/kinect/image_raw/compressed", CompressedImage)
        self.assertEqual(message.format, "rgb8; jpeg compressed bgr8")
        self.assertEqual(Picture.open(io.BytesIO(message.data)).size, (WIDTH, HEIGHT))

    def test_depth_with_its_lens(self):
        depth, info = (Collected("/kinect/depth/image_raw", Image),
                       Collected("/kinect/depth/camera_info", CameraInfo))
        both = wait_for(lambda: [(a, b) for a in depth.all() for b in info.all()
                                 if a.header.stamp == b.header.stamp], "a pair")
        image, lens = both[0]
        self.assertEqual((image.encoding, lens.distortion_model), ("32FC1", "plumb_bob"))
        self.assertAlmostEqual(lens.K[0], FOCAL)
        seen = np.frombuffer(image.data, np.float32).reshape(HEIGHT, WIDTH)
        self.assertAlmostEqual(float(seen[HEIGHT // 2, WIDTH // 2]), 2.0, delta=2e-4)
        self.assertTrue(np.isnan(seen[0, 0]))

    def test_points(self):
        cloud = self.first("/kinect/points", PointCloud2)
        self.assertEqual((cloud.width, cloud.height, cloud.is_dense), (WIDTH, HEIGHT, False))
        wall = np.array([point for point in read_points(cloud, ("x", "y", "z"), skip_nans=True)
                         if abs(point[2] - 2.0) < 1e-3])
        self.assertGreater(len(wall), 1000)
        for axis in (0, 1):
            self.assertAlmostEqual(wall[:, axis].max(), 0.5, delta=2.0 / FOCAL)
            self.assertAlmostEqual(wall[:, axis].min(), -0.5, delta=2.0 / FOCAL)

    def test_a_lens_can_be_set(self):
        rospy.wait_for_service("/kinect/set_camera_info", SECONDS)
        service = rospy.ServiceProxy("/kinect/set_camera_info", SetCameraInfo)
        lenses = Collected("/kinect/camera_info", CameraInfo)
        (own, *_) = wait_for(lenses.all, "the lens that is drawn")
        self.assertTrue(service(CameraInfo(width=WIDTH, height=HEIGHT, K=[7.0] * 9)).success)
        wait_for(lambda: lenses.all()[-1].K[0] == 7.0, "the lens that was set")
        self.assertFalse(service(CameraInfo(width=9, height=9)).success)
        self.assertTrue(service(own).success)
        wait_for(lambda: lenses.all()[-1].K[0] == own.K[0], "the lens that is drawn, again")

    def test_the_lab_robot_has_eyes_and_an_inner_ear(self):
        image = self.first("/camera/image_raw", Image)
        self.assertEqual((image.width, image.header.frame_id), (320, "camera_optical_frame"))
        scan = self.first("/scan", LaserScan)
        self.assertEqual((len(scan.ranges), scan.header.frame_id), (360, "laser_link"))
        heard = Collected("/imu", Imu)
        wait_for(lambda: heard.all() and abs(heard.all()[-1].linear_acceleration.z - 9.8) < 0.1,
                 "the weight of a robot at rest")
        self.assertEqual(heard.all()[-1].header.frame_id, "imu_link")

    def test_the_laser_sees_the_wall(self):
        self.gazebo.spawn_sdf_model("near", BOX.replace("wall", "near"), "", pose(1.28, 0, 0.5), "")
        scans = Collected("/scan", LaserScan)

        def seen():
            return [one.ranges[180] for one in scans.all() if one.ranges[180] < 10.0]

        wait_for(lambda: len(seen()) >= 20, "something ahead")  # the noise of few is too much
        ahead = seen()
        # The laser is 0.08 m ahead of the robot's middle, the wall's face 1.18 m.
        self.assertAlmostEqual(sum(ahead) / len(ahead), 1.1, delta=0.02)

    def test_a_killed_sensing_process_is_replaced(self):
        images = Collected("/kinect/image_raw", Image)
        wait_for(images.all, "a picture")
        (victim,) = wait_for(sensing_children, "the sensing process")
        os.kill(victim, signal.SIGKILL)
        wait_for(lambda: sensing_children() not in ([], [victim]), "another sensing process")
        images.clear()
        wait_for(images.all, "a picture of the new process")


if __name__ == "__main__":
    run("camera_robot")
