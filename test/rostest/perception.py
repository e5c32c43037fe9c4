"""What image_proc, depth_image_proc, laser_geometry and PCL make of pictures, depth and scans.

Each case computes from our messages alone what such a program computes, by its documented formula,
and holds that against the known world. Where Debian's program is installed it runs, too, and must
find the same; where it is not, that is printed, and is a failure if the environment's
MY_SIMULATIONS_NEEDS_TOOLS is set.
"""
import glob
import math
import os
import sys
import tempfile
import unittest

import numpy as np
import roslib.packages
import rospkg
import rospy
import tf2_ros
from geometry_msgs.msg import Quaternion, TransformStamped
from sensor_msgs.msg import CameraInfo, Image, LaserScan, PointCloud2
from support import Collected, Gazebo, Program, Transforms, pose, wait_for

WIDTH, HEIGHT, HFOV = 320, 240, 1.2
FOCAL = WIDTH / 2 / math.tan(HFOV / 2)
BARREL = {"k1": -0.35, "k2": 0.12, "k3": 0.0, "p1": -0.003, "p2": 0.002}
EYE = np.array((0.0, 0.0, 1.0))       # m, of all sensors
LASER_YAW = 0.3
WALL, BOARD = 3.0, 2.0                # m, x of what is seen
SIDE = 1.2                            # m, of the board, whose middle is straight ahead
# Optical frames look along z, x right, y down (REP 103), here along the world's x.
WORLD_FROM_OPTICAL = np.array([[0, 0, 1], [-1, 0, 0], [0, -1, 0]], float)


def static_box(name, size, color):
    geometry = f"<geometry><box><size>{size}</size></box></geometry>"
    return (f'<sdf version="1.6"><model name="{name}"><static>1</static><link name="link">'
            f'<collision name="c">{geometry}</collision><visual name="v">{geometry}<material>'
            f"<ambient>{color}</ambient><diffuse>{color}</diffuse></material></visual></link>"
            "</model></sdf>")


def camera(name, kind, plugin, lens=""):
    return (f'<sensor name="{name}" type="{kind}"><update_rate>10</update_rate><camera>'
            f"<horizontal_fov>{HFOV}</horizontal_fov><image><width>{WIDTH}</width>"
            f"<height>{HEIGHT}</height></image><clip><near>0.05</near><far>20</far></clip>{lens}"
            f'</camera><plugin name="{name}" filename="{plugin}"><cameraName>{name}</cameraName>'
            "<frameName>rig_optical</frameName><pointCloudCutoff>0.1</pointCloudCutoff>"
            "<borderCrop>false</borderCrop></plugin></sensor>")


RIG = f"""<sdf version="1.6"><model name="rig"><static>1</static><link name="head">
{camera("plain", "camera", "libgazebo_ros_camera.so")}
{camera("lens", "camera", "libgazebo_ros_camera.so",
        "<distortion>" + "".join(f"<{k}>{v}</{k}>" for k, v in BARREL.items()) + "</distortion>")}
{camera("kinect", "depth", "libgazebo_ros_openni_kinect.so")}
<sensor name="laser" type="ray"><pose>0 0 0 0 0 {LASER_YAW}</pose><update_rate>10</update_rate><ray>
<scan><horizontal><samples>181</samples><min_angle>-0.9</min_angle><max_angle>0.9</max_angle>
</horizontal></scan><range><min>0.1</min><max>10</max></range></ray>
<plugin name="laser" filename="libgazebo_ros_laser.so"><topicName>rig/scan</topicName>
<frameName>rig_laser</frameName></plugin></sensor></link></model></sdf>"""


def program(package, name):
    """The program of a package of Debian, or None, which is told."""
    try:
        found = roslib.packages.find_node(package, name)
    except rospkg.ResourceNotFound:
        found = []
    return found[0] if found else told(package)


def told(package):
    assert not os.environ.get("MY_SIMULATIONS_NEEDS_TOOLS"), f"{package} is not installed"
    print(f"{package} is not installed: only the test's own computation was done", file=sys.stderr)


def nodelet(package, name):
    """Words that start a nodelet by itself, or None."""
    try:
        roslib.packages.get_pkg_dir(package)
    except roslib.packages.InvalidROSPkgException:
        return told(package)
    start = program("nodelet", "nodelet")
    return start and [start, "standalone", name]


def pixels(message):
    """The array of an image, by its encoding and step."""
    kind, channels = {"rgb8": (np.uint8, 3), "bgr8": (np.uint8, 3), "32FC1": (np.float32, 1)}[
        message.encoding]
    size = np.dtype(kind).itemsize
    assert len(message.data) == message.step * message.height
    assert message.step >= message.width * channels * size and not message.is_bigendian
    rows = np.frombuffer(message.data, np.uint8).reshape(message.height, message.step)
    found = np.ascontiguousarray(rows[:, :message.width * channels * size]).view(kind)
    found = found.reshape(message.height, message.width, channels)
    return found[..., ::-1] if message.encoding == "bgr8" else found.squeeze()


def points(cloud, *names):
    """(h, w, n) of fields of a cloud, by their offsets and the strides."""
    size = {1: "i1", 2: "u1", 3: "<i2", 4: "<u2", 5: "<i4", 6: "<u4", 7: "<f4", 8: "<f8"}
    assert cloud.row_step == cloud.point_step * cloud.width and not cloud.is_bigendian
    assert len(cloud.data) == cloud.row_step * cloud.height
    fields = {field.name: field for field in cloud.fields}
    kind = np.dtype({"names": list(names), "formats": [size[fields[n].datatype] for n in names],
                     "offsets": [fields[n].offset for n in names], "itemsize": cloud.point_step})
    table = np.frombuffer(cloud.data, kind).reshape(cloud.height, cloud.width)
    return np.stack([table[name] for name in names], axis=-1)


def colors(cloud):
    """(h, w, 3) uint8 red, green, blue, as PCL packs them into a float."""
    packed = points(cloud, "rgb").astype("<f4").view("<u4")[..., 0]
    return np.stack([packed >> shift & 255 for shift in (16, 8, 0)], axis=-1).astype(np.uint8)


def rectified(picture, info):
    """What image_proc makes: K, D and P of the camera, plumb_bob, bilinear (R is the identity)."""
    k, p = np.array(info.K).reshape(3, 3), np.array(info.P).reshape(3, 4)
    k1, k2, p1, p2, k3 = info.D
    u, v = np.meshgrid(np.arange(info.width), np.arange(info.height))
    x, y = (u - p[0, 2]) / p[0, 0], (v - p[1, 2]) / p[1, 1]
    r = x * x + y * y
    radial = 1 + r * (k1 + r * (k2 + r * k3))
    at_x = x * radial + 2 * p1 * x * y + p2 * (r + 2 * x * x)
    at_y = y * radial + p1 * (r + 2 * y * y) + 2 * p2 * x * y
    column, row = at_x * k[0, 0] + k[0, 2], at_y * k[1, 1] + k[1, 2]
    inside = (column >= 0) & (column <= info.width - 1.001) & (row >= 0) & (
        row <= info.height - 1.001)
    left, top = np.where(inside, column, 0).astype(int), np.where(inside, row, 0).astype(int)
    a, b = (column - left)[..., None], (row - top)[..., None]
    source = picture.astype(float)
    mixed = ((source[top, left] * (1 - a) + source[top, left + 1] * a) * (1 - b)
             + (source[top + 1, left] * (1 - a) + source[top + 1, left + 1] * a) * b)
    return np.where(inside[..., None], mixed, 0.0), inside


def board_corners(picture):
    """First and last column and row of the red board, by half the change of colour: (4,)."""
    picture = picture.astype(float)
    red = picture[..., 0] - picture[..., 2]
    red = np.clip(red / red[HEIGHT // 2, WIDTH // 2], 0, 1)
    across, down = red[HEIGHT // 2 - 8:HEIGHT // 2 + 8].mean(0), red[:, WIDTH // 2 - 8:
                                                                   WIDTH // 2 + 8].mean(1)
    return np.array([line for way in (across, down)
                     for line in (way[:len(way) // 2][::-1].sum(), way[len(way) // 2:].sum())])


def in_world(optical):
    return optical @ WORLD_FROM_OPTICAL.T + EYE


def surface_distance(at):
    """m from points of the world to the board's or the wall's face or the ground."""
    on_board = ((np.abs(at[..., 1]) < SIDE / 2 + 0.01)
                & (np.abs(at[..., 2] - EYE[2]) < SIDE / 2 + 0.01))
    far = np.minimum(np.abs(at[..., 0] - WALL), np.abs(at[..., 2]))
    return np.where(on_board, np.minimum(far, np.abs(at[..., 0] - BOARD)), far)


class Perception(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.gazebo = Gazebo()
        for name, size, color, x in (("board", f"0.1 {SIDE} {SIDE}", "1 0 0 1", BOARD + 0.05),
                                     ("wall", "0.1 12 6", "0.8 0.8 0.8 1", WALL + 0.05)):
            reply = cls.gazebo.spawn_sdf_model(name, static_box(name, size, color), "",
                                               pose(x, 0.0, 1.0), "")
            assert reply.success, reply.status_message
        assert cls.gazebo.spawn_sdf_model("rig", RIG, "/", pose(*EYE), "").success
        cls.frames = tf2_ros.StaticTransformBroadcaster()
        cls.frames.sendTransform([
            cls.frame("rig_optical", Quaternion(-0.5, 0.5, -0.5, 0.5)),
            cls.frame("rig_laser", Quaternion(0, 0, math.sin(LASER_YAW / 2),
                                              math.cos(LASER_YAW / 2)))])
        cls.transforms = Transforms()

    @staticmethod
    def frame(name, turn):
        made = TransformStamped(child_frame_id=name)
        made.header.frame_id = "world"
        (made.transform.translation.x, made.transform.translation.y,
         made.transform.translation.z) = EYE
        made.transform.rotation = turn
        return made

    def together(self, *topics):
        """Messages of the same stamp, of (topic, kind)."""
        heard = [Collected(topic, kind) for topic, kind in topics]

        def same():
            by_stamp = [{m.header.stamp.to_nsec(): m for m in one.all()} for one in heard]
            stamps = sorted(set(by_stamp[0]).intersection(*by_stamp[1:]))
            return [one[stamps[-1]] for one in by_stamp] if stamps else None

        found = wait_for(same, f"messages of one stamp on {[name for name, _ in topics]}")
        for one in heard:
            one.close()
        return found

    def answer(self, words, *topics):
        """What a program publishes; `topics` as for `together`."""
        with Program([*words, f"__name:=tool_{rospy.get_rostime().to_nsec()}"]) as running:
            try:
                return self.together(*topics)
            except AssertionError as fault:
                raise AssertionError(f"{fault}\n{running.text}") from None

    def test_camera_info_describes_the_drawn_pinhole(self):
        for name, lens in (("plain", [0.0] * 5),
                           ("lens", [BARREL[k] for k in ("k1", "k2", "p1", "p2", "k3")])):
            image, info = self.together((f"/{name}/image_raw", Image),
                                        (f"/{name}/camera_info", CameraInfo))
            self.assertEqual((image.header.frame_id, info.header.frame_id), ("rig_optical",) * 2)
            self.assertEqual((info.width, info.height), (image.width, image.height))
            self.assertEqual((info.distortion_model, list(info.D)), ("plumb_bob", lens))
            wanted = [FOCAL, 0, (WIDTH - 1) / 2, 0, FOCAL, (HEIGHT - 1) / 2, 0, 0, 1]
            np.testing.assert_allclose(info.K, wanted, rtol=1e-9)
            np.testing.assert_allclose(np.array(info.P).reshape(3, 4)[:, :3].ravel(), wanted)
            np.testing.assert_array_equal(np.array(info.P).reshape(3, 4)[:, 3], 0.0)
            np.testing.assert_array_equal(info.R, np.eye(3).ravel())
            self.assertEqual((info.binning_x, info.binning_y, info.roi.width), (0, 0, 0))

    def test_a_rectified_picture_is_that_of_a_camera_without_a_lens(self):
        image, info = self.together(("/lens/image_raw", Image), ("/lens/camera_info", CameraInfo))
        (plain,) = self.together(("/plain/image_raw", Image))
        straight, bent = board_corners(pixels(plain)), board_corners(pixels(image))
        mine, inside = rectified(pixels(image), info)
        np.testing.assert_allclose(board_corners(mine), straight, atol=0.5)
        self.assertGreater(np.abs(bent - straight).max(), 1.5)
        start = program("image_proc", "image_proc")
        if start:
            (made,) = self.answer(["env", "ROS_NAMESPACE=/lens", start],
                                  ("/lens/image_rect_color", Image))
            self.assertEqual(made.header.frame_id, "rig_optical")
            # Their pixels are mixed in steps of 1/32.
            apart = np.abs(pixels(made) - mine)[inside]
            self.assertLess(apart.mean(), 0.5)
            np.testing.assert_allclose(board_corners(pixels(made)), straight, atol=0.5)

    def test_points_of_depth_lie_on_what_is_seen(self):
        depth, info, cloud, image = self.together(
            ("/kinect/depth/image_raw", Image), ("/kinect/depth/camera_info", CameraInfo),
            ("/kinect/points", PointCloud2), ("/kinect/image_raw", Image))
        self.assertEqual(depth.encoding, "32FC1")
        self.assertEqual({one.header.frame_id for one in (depth, info, cloud, image)},
                         {"rig_optical"})
        z = pixels(depth)
        u, v = np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT))
        own = np.stack([(u - info.K[2]) / info.K[0] * z, (v - info.K[5]) / info.K[4] * z, z], -1)
        seen = np.isfinite(z)
        self.assertGreater(seen.mean(), 0.9)
        self.assertLess(np.quantile(surface_distance(in_world(own))[seen], 0.99), 1e-3)
        self.check_cloud(cloud, own, pixels(image))
        words = nodelet("depth_image_proc", "depth_image_proc/point_cloud_xyz")
        if words:
            (made,) = self.answer([*words, "image_rect:=/kinect/depth/image_raw",
                                   "points:=/tool/xyz"], ("/tool/xyz", PointCloud2))
            self.check_cloud(made, own, None)
            (made,) = self.answer([
                words[0], words[1], "depth_image_proc/point_cloud_xyzrgb",
                "rgb/image_rect_color:=/kinect/image_raw", "rgb/camera_info:=/kinect/camera_info",
                "depth_registered/image_rect:=/kinect/depth/image_raw",
                "depth_registered/points:=/tool/xyzrgb"], ("/tool/xyzrgb", PointCloud2))
            self.check_cloud(made, own, pixels(image))

    def check_cloud(self, cloud, wanted, picture):
        """An organized cloud: NaN where there is nothing, a row for each of the picture."""
        self.assertEqual((cloud.width, cloud.height, cloud.header.frame_id),
                         (WIDTH, HEIGHT, "rig_optical"))
        found = points(cloud, "x", "y", "z")
        finite = np.isfinite(found).all(axis=-1)
        np.testing.assert_array_equal(finite, np.isfinite(wanted[..., 2]))
        self.assertTrue(finite.all() or not cloud.is_dense)
        np.testing.assert_allclose(found[finite], wanted[finite], atol=2e-5)
        self.assertEqual({(field.count, field.datatype) for field in cloud.fields}, {(1, 7)})
        if picture is not None:
            np.testing.assert_array_equal(colors(cloud)[finite], picture[finite])

    def test_pcl_reads_the_cloud(self):
        cloud, image = self.together(("/kinect/points", PointCloud2), ("/kinect/image_raw", Image))
        np.testing.assert_array_equal(colors(cloud), pixels(image))
        start = program("pcl_ros", "convert_pointcloud_to_image")
        if start:
            (made,) = self.answer([start, "input:=/kinect/points", "output:=/tool/picture"],
                                  ("/tool/picture", Image))
            np.testing.assert_array_equal(pixels(made), pixels(image))
            with tempfile.TemporaryDirectory() as folder:
                self.check_file(program("pcl_ros", "pointcloud_to_pcd"), folder)
        words = nodelet("pcl_ros", "pcl/VoxelGrid")
        if words:
            (made,) = self.answer([
                *words, "~input:=/kinect/points", "~output:=/tool/voxels", "_leaf_size:=0.06",
                "_filter_field_name:=z", "_filter_limit_min:=1.9", "_filter_limit_max:=2.1"],
                ("/tool/voxels", PointCloud2))
            at = in_world(points(made, "x", "y", "z"))[0]
            at = at[at[:, 2] > 0.1]   # the ground is seen as well
            # A board of 1.2 m has 20 by 20 voxels of 6 cm, and those that lie over its rim.
            self.assertTrue(20 * 20 <= len(at) <= 22 * 22, len(at))
            np.testing.assert_allclose(at[:, 0], BOARD, atol=1e-3)

    def check_file(self, start, folder):
        def head():
            for path in glob.glob(f"{folder}/*.pcd"):
                with open(path, "rb") as file:
                    words, data, _ = file.read(400).partition(b"\nDATA")
                if data:   # room is made for the file before it is written
                    return dict(line.split(" ", 1) for line in words.decode().splitlines()
                                if line[:1] != "#")
            return None

        with Program([start, "input:=/kinect/points", f"_prefix:={folder}/", "_binary:=true",
                      "__name:=tool_file"]):
            words = wait_for(head, "a file of points")
        self.assertEqual((words["WIDTH"], words["HEIGHT"]), (str(WIDTH), str(HEIGHT)))
        self.assertEqual([one for one in words["FIELDS"].split() if one != "_"],
                         ["x", "y", "z", "rgb"])

    def test_a_scan_projects_onto_the_wall_in_the_frame_of_the_world(self):
        (scan,) = self.together(("/rig/scan", LaserScan))
        self.assertEqual(scan.header.frame_id, "rig_laser")
        angles = scan.angle_min + scan.angle_increment * np.arange(len(scan.ranges))
        self.assertAlmostEqual(angles[-1], scan.angle_max, places=5)
        ranges = np.array(scan.ranges)
        hit = (ranges >= scan.range_min) & (ranges <= scan.range_max)
        flat = np.stack([ranges * np.cos(angles), ranges * np.sin(angles), 0 * ranges], -1)[hit]
        self.assertGreater(len(flat), 100)
        self.check_scan(flat, scan.header)
        try:
            from laser_geometry import LaserProjection
        except ImportError:
            told("laser_geometry")
            return
        made = LaserProjection().projectLaser(scan)
        self.assertEqual(made.header, scan.header)
        found = points(made, "x", "y", "z")[0]
        np.testing.assert_allclose(found, flat, atol=1e-5)
        self.check_scan(found, made.header)

    def check_scan(self, at, header):
        """Points of a cloud, moved by tf, lie on the board and the wall within a millimetre."""
        turn = self.transforms.get("world", header.frame_id, header.stamp)
        yaw = 2 * math.atan2(turn.rotation.z, turn.rotation.w)
        x = at[:, 0] * math.cos(yaw) - at[:, 1] * math.sin(yaw) + turn.translation.x
        y = at[:, 0] * math.sin(yaw) + at[:, 1] * math.cos(yaw) + turn.translation.y
        board = np.abs(y) < SIDE / 2
        self.assertGreater(board.sum(), 10)
        np.testing.assert_allclose(x, np.where(board, BOARD, WALL), atol=1e-3)
