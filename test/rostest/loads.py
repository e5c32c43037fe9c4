#!/usr/bin/env python3
"""Wrenches and efforts, step by step in lockstep: what they do is what Newton says."""
import math
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import support
from gazebo_msgs.srv import ApplyBodyWrenchRequest, SetPhysicsPropertiesRequest
from geometry_msgs.msg import Point, Vector3
from support import box, pose

STEP = 0.001
SIZE, MASS = 0.2, 1.0
MOMENT = MASS * SIZE * SIZE / 6.0

OFF_CENTRE = ('<robot name="r"><link name="body">'
              '<inertial><origin xyz="0.5 0 0"/><mass value="1"/>'
              '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>'
              '</robot>')

WHEEL = ('<robot name="r"><link name="world"/>'
         '<link name="wheel"><inertial><mass value="1"/>'
         '<inertia ixx="2" ixy="0" ixz="0" iyy="2" iyz="0" izz="2"/></inertial></link>'
         '<joint name="axle" type="continuous"><parent link="world"/><child link="wheel"/>'
         '<axis xyz="0 0 1"/></joint></robot>')


class Loads(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.gazebo = support.Gazebo()
        physics = cls.gazebo.get_physics_properties()
        assert cls.gazebo.set_physics_properties(SetPhysicsPropertiesRequest(
            STEP, 0.0, Vector3(0.0, 0.0, 0.0), physics.ode_config)).success

    def setUp(self):
        self.gazebo.clear()

    def step(self, count):
        answer = self.gazebo.step_world(count)
        self.assertTrue(answer.success, answer.status_message)

    def spawn(self, name, where=None, xml=None):
        answer = self.gazebo.spawn(name, xml or box(SIZE, MASS), where or pose(0.0, 0.0, 5.0))
        self.assertTrue(answer.success, answer.status_message)

    def wrench(self, link, force=(0.0, 0.0, 0.0), torque=(0.0, 0.0, 0.0), seconds=-1.0, frame="",
               point=(0.0, 0.0, 0.0), start=0.0):
        request = ApplyBodyWrenchRequest(
            body_name=link, reference_frame=frame, reference_point=Point(*point))
        request.wrench.force, request.wrench.torque = Vector3(*force), Vector3(*torque)
        request.start_time = rospy.Time.from_sec(start)
        request.duration = rospy.Duration.from_sec(seconds)
        answer = self.gazebo.apply_body_wrench(request)
        self.assertTrue(answer.success, answer.status_message)

    def effort(self, joint, effort, seconds=-1.0, start=0.0):
        answer = self.gazebo.apply_joint_effort(joint, effort, rospy.Time.from_sec(start),
                                                rospy.Duration.from_sec(seconds))
        self.assertTrue(answer.success, answer.status_message)

    def linear(self, model):
        found = self.gazebo.get_model_state(model, "").twist.linear
        return (found.x, found.y, found.z)

    def angular(self, model):
        found = self.gazebo.get_model_state(model, "").twist.angular
        return (found.x, found.y, found.z)

    def rate(self, joint):
        return self.gazebo.get_joint_properties(joint).rate[0]

    def near(self, found, wanted, delta=1e-9):
        for one, other in zip(found, wanted):
            self.assertAlmostEqual(one, other, delta=delta, msg=f"{found}, not {wanted}")

    def test_a_wrench_acts_for_exactly_its_steps(self):
        self.spawn("a")
        self.wrench("a::body", force=(20.0, 0.0, 0.0), seconds=10 * STEP)
        for done in range(1, 15):
            self.step(1)
            self.near(self.linear("a"), (20.0 * STEP * min(done, 10), 0.0, 0.0))

    def test_a_wrench_of_the_future_begins_at_its_step(self):
        self.spawn("a")
        self.wrench("a::body", force=(20.0, 0.0, 0.0), seconds=5 * STEP,
                    start=self.gazebo.sim_time() + 4 * STEP)
        for done in range(1, 12):
            self.step(1)
            self.near(self.linear("a"), (20.0 * STEP * min(max(done - 4, 0), 5), 0.0, 0.0))

    def test_a_duration_below_a_step_is_a_step_and_none_is_nothing(self):
        self.spawn("a")
        self.wrench("a::body", force=(20.0, 0.0, 0.0), seconds=0.0)
        self.step(3)
        self.near(self.linear("a"), (0.0, 0.0, 0.0))
        self.wrench("a::body", force=(20.0, 0.0, 0.0), seconds=0.1 * STEP)
        self.step(3)
        self.near(self.linear("a"), (20.0 * STEP, 0.0, 0.0))

    def test_wrenches_on_one_link_add_up(self):
        self.spawn("a")
        self.wrench("a::body", force=(20.0, 0.0, 0.0), seconds=10 * STEP)
        self.wrench("body", force=(0.0, 30.0, 0.0), seconds=5 * STEP)
        self.wrench("a::body", force=(5.0, 0.0, 0.0), seconds=20 * STEP)
        self.step(30)
        self.near(self.linear("a"), (0.2 + 0.1, 0.15, 0.0))

    def test_a_torque_turns_about_the_centre_of_mass(self):
        self.spawn("a")
        self.wrench("a::body", torque=(0.0, 0.0, 0.02), seconds=10 * STEP)
        self.step(20)
        self.near(self.angular("a"), (0.0, 0.0, 0.02 * 10 * STEP / MOMENT), 1e-7)
        self.near(self.linear("a"), (0.0, 0.0, 0.0))

    def test_without_a_frame_the_axes_are_the_worlds(self):
        self.spawn("a", pose(0.0, 0.0, 5.0, math.pi / 2))
        for frame in ("", "world", "map", "/map"):
            self.wrench("a::body", force=(10.0, 0.0, 0.0), seconds=STEP, frame=frame)
            self.step(2)
        self.near(self.linear("a"), (0.04, 0.0, 0.0))
        self.near(self.angular("a"), (0.0, 0.0, 0.0))

    def test_without_a_frame_a_point_is_an_offset_from_the_centre_of_mass(self):
        self.spawn("a", xml=OFF_CENTRE)
        self.wrench("a::body", force=(0.0, 10.0, 0.0), point=(2.0, 0.0, 0.0), seconds=STEP)
        self.step(1)
        self.near(self.angular("a"), (0.0, 0.0, 0.02), 1e-7)

    def test_in_its_own_frame_a_wrench_has_the_links_axes_and_turns_with_it(self):
        self.spawn("a", pose(3.0, 0.0, 5.0, math.pi / 2))
        self.wrench("a::body", force=(10.0, 0.0, 0.0), frame="a::body")
        self.step(10)
        self.near(self.linear("a"), (0.0, 0.1, 0.0), 1e-7)
        self.gazebo.place("a", pose(3.0, 0.0, 5.0))
        self.step(10)
        self.near(self.linear("a"), (0.1, 0.0, 0.0), 1e-7)

    def test_in_its_own_frame_a_force_attacks_at_the_origin_of_the_link(self):
        self.spawn("a", xml=OFF_CENTRE)
        self.wrench("a::body", force=(0.0, 10.0, 0.0), frame="a::body", seconds=STEP)
        self.step(1)
        self.near(self.angular("a"), (0.0, 0.0, -0.5 * 10.0 * STEP), 1e-7)

    def test_in_the_frame_of_another_model_a_wrench_attacks_there(self):
        self.spawn("other", pose(1.0, 0.0, 5.0, math.pi / 2))
        self.spawn("a", pose(0.0, 0.0, 5.0))
        self.wrench("a::body", force=(0.1, 0.0, 0.0), frame="other", seconds=STEP)
        self.step(1)
        self.near(self.linear("a"), (0.0, 0.1 * STEP, 0.0), 1e-9)
        self.near(self.angular("a"), (0.0, 0.0, 1.0 * 0.1 * STEP / MOMENT), 1e-7)

    def test_a_wrench_without_end_ends_when_cleared_by_either_name(self):
        for name in ("a::body", "body"):
            self.spawn("a")
            self.wrench("a::body", force=(20.0, 0.0, 0.0))
            self.step(10)
            self.gazebo.clear_body_wrenches(name)
            self.step(10)
            self.near(self.linear("a"), (0.2, 0.0, 0.0))
            self.gazebo.delete_model("a")

    def test_clearing_leaves_other_links_alone(self):
        self.spawn("a", pose(0.0, 0.0, 5.0))
        self.spawn("b", pose(0.0, 2.0, 5.0))
        for name in ("a", "b"):
            self.wrench(f"{name}::body", force=(20.0, 0.0, 0.0))
        self.gazebo.clear_body_wrenches("a::body")
        self.gazebo.clear_body_wrenches("no_such_link")
        self.step(10)
        self.near(self.linear("a"), (0.0, 0.0, 0.0))
        self.near(self.linear("b"), (0.2, 0.0, 0.0))

    def test_efforts_on_one_joint_add_up_for_exactly_their_steps(self):
        self.spawn("a", xml=WHEEL)
        self.effort("a::axle", 4.0, 10 * STEP)
        self.effort("axle", 2.0, 5 * STEP, self.gazebo.sim_time() + 2 * STEP)
        for done in range(1, 15):
            self.step(1)
            self.near([self.rate("a::axle")],
                      [(4.0 * min(done, 10) + 2.0 * min(max(done - 2, 0), 5)) * STEP / 2.0], 1e-7)

    def test_efforts_are_cleared_by_scoped_name_or_in_all_models(self):
        for name in ("a", "b", "c"):
            self.spawn(name, pose(0.0, ord(name), 5.0), WHEEL)
            self.effort(f"{name}::axle", 2.0)
        self.gazebo.clear_joint_forces("b::axle")
        self.step(10)
        self.near([self.rate(f"{name}::axle") for name in "abc"], [0.01, 0.0, 0.01], 1e-7)
        self.gazebo.clear_joint_forces("axle")
        self.step(10)
        self.near([self.rate(f"{name}::axle") for name in "abc"], [0.01, 0.0, 0.01], 1e-7)

    def test_deleting_a_model_leaves_equally_named_joints_of_others_alone(self):
        for name in ("a", "b"):
            self.spawn(name, pose(0.0, ord(name), 5.0), WHEEL)
            self.effort(f"{name}::axle", 2.0)
        self.gazebo.delete_model("a")
        self.spawn("a", pose(0.0, 0.0, 5.0), WHEEL)
        self.step(10)
        self.near([self.rate("a::axle"), self.rate("b::axle")], [0.0, 0.01], 1e-7)

    def test_a_reset_drops_what_acts(self):
        self.spawn("a")
        self.wrench("a::body", force=(20.0, 0.0, 0.0))
        self.gazebo.reset_simulation()
        self.step(10)
        self.near(self.linear("a"), (0.0, 0.0, 0.0))

    def test_a_joint_motor_drives_at_its_rate_with_its_effort(self):
        self.spawn("a", xml=WHEEL)
        config = support.srv.SetJointPropertiesRequest(joint_name="a::axle")
        config.ode_joint_config.vel, config.ode_joint_config.fmax = [0.5], [20.0]
        self.assertTrue(self.gazebo.set_joint_properties(config).success)
        self.step(10)
        self.near([self.rate("a::axle")], [0.1], 1e-6)
        self.step(100)
        self.near([self.rate("a::axle")], [0.5], 1e-6)


if __name__ == "__main__":
    support.run("loads")
