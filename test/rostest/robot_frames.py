"""robot_state_publisher has the lab robot's links where the physics has them."""
import unittest

import rospy
from geometry_msgs.msg import Twist, Vector3
from support import Gazebo, Transforms, wait_for

WHEELS = ("left_wheel", "right_wheel")
SENSORS = ("laser_link", "camera_optical_frame", "imu_link")


class RobotFrames(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.gazebo = Gazebo()
        cls.transforms = Transforms()
        wait_for(lambda: "robo" in cls.gazebo.names(), "the robot")

    def transform(self, frame):
        return self.transforms.get("base_footprint", frame)

    def test_links_are_where_the_physics_has_them(self):
        command = rospy.Publisher("/cmd_vel", Twist, queue_size=1, latch=True)
        command.publish(Twist(Vector3(0.2, 0, 0), Vector3(0, 0, 0.3)))
        wait_for(lambda: abs(self.transform("left_wheel").rotation.y) > 0.2, "a wheel that turns")
        self.gazebo.pause_physics()
        for frame in WHEELS:
            reply = self.gazebo.get_link_state(f"robo::{frame}", "robo::base_footprint")
            self.assertTrue(reply.success, reply.status_message)
            truth = reply.link_state.pose
            # They have turned by up to a period of joint_states since they were told, and that has
            # to come here first.
            wait_for(lambda frame=frame, truth=truth: 1.0 - abs(sum(
                getattr(self.transform(frame).rotation, axis) * getattr(truth.orientation, axis)
                for axis in "xyzw")) < 0.02, f"{frame} turned as far as the physics says")
            seen = self.transform(frame)
            for axis in "xyz":
                self.assertAlmostEqual(getattr(seen.translation, axis),
                                       getattr(truth.position, axis), delta=2e-3, msg=frame)

    def test_what_sensors_publish_is_in_the_frame_of_odometry(self):
        self.gazebo.unpause_physics()
        for frame in SENSORS:
            self.transforms.wait("odom", frame, f"a way from odom to {frame}")
        turn = self.transform("camera_optical_frame").rotation
        # Optical frames look along z, with y down: REP 103.
        for value, wanted in zip((turn.x, turn.y, turn.z, turn.w), (-0.5, 0.5, -0.5, 0.5)):
            self.assertAlmostEqual(abs(value), abs(wanted), delta=0.2)
