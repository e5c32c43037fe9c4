#!/usr/bin/env python3
"""A two-joint arm by ros_control: spawner, trajectories, switches, a crash, a reset."""
import os
import signal
import subprocess
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import actionlib
import dynamic_reconfigure
import rospy
from actionlib_msgs.msg import GoalStatus
from control_msgs.msg import (
    FollowJointTrajectoryAction,
    FollowJointTrajectoryGoal,
    FollowJointTrajectoryResult,
    JointTolerance,
    JointTrajectoryControllerState,
)
from control_msgs.srv import QueryTrajectoryState
from controller_manager_msgs.srv import (
    ListControllers,
    ListControllerTypes,
    LoadController,
    SwitchController,
    UnloadController,
)
from dynamic_reconfigure.client import Client
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64
from support import SECONDS, Collected, Gazebo, run, wait_for
from trajectory_msgs.msg import JointTrajectoryPoint

MANAGER = "/arm/controller_manager"
NAMES = ["shoulder", "elbow"]
STRICT, BEST_EFFORT = 2, 1


def manager(name, kind):
    name = f"{MANAGER}/{name}"
    rospy.wait_for_service(name, timeout=SECONDS)
    return rospy.ServiceProxy(name, kind)


class Control(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.gazebo = Gazebo()
        cls.states = Collected("/arm/joint_states", JointState)
        cls.controller = Collected("/arm/trajectory/state", JointTrajectoryControllerState)
        wait_for(lambda: "arm" in cls.gazebo.names(), "the arm")
        cls.list = manager("list_controllers", ListControllers)
        cls.switch = manager("switch_controller", SwitchController)
        cls.load = manager("load_controller", LoadController)
        cls.unload = manager("unload_controller", UnloadController)
        wait_for(lambda: cls.running() >= {"joint_state_controller", "trajectory"},
                 "the spawner's controllers")
        cls.was_paused = cls.gazebo.is_paused()
        cls.gazebo.unpause_physics()
        cls.client = actionlib.SimpleActionClient("/arm/trajectory/follow_joint_trajectory",
                                                  FollowJointTrajectoryAction)
        wait_for(lambda: cls.client.wait_for_server(rospy.Duration(0.5)), "the action server")
        wait_for(cls.states.all, "joint states")

    @classmethod
    def running(cls):
        return {one.name for one in cls.list().controller if one.state == "running"}

    def setUp(self):
        if "trajectory" not in self.running():
            self.switch(["trajectory"], list({"elbow"} & self.running()), BEST_EFFORT, False, 0.0)

    def positions(self):
        last = self.states.all()[-1]
        return dict(zip(last.name, last.position))

    def efforts(self):
        last = self.states.all()[-1]
        return dict(zip(last.name, last.effort))

    def goal(self, shoulder, elbow, seconds=1.0, **more):
        goal = FollowJointTrajectoryGoal(**more)
        goal.trajectory.joint_names = list(NAMES)
        goal.trajectory.points = [JointTrajectoryPoint(
            positions=[shoulder, elbow], velocities=[0.0, 0.0], accelerations=[0.0, 0.0],
            time_from_start=rospy.Duration(seconds))]
        return goal

    def follow(self, goal):
        """Send a goal; returns once the controller follows it."""
        self.client.send_goal(goal)
        state = wait_for(lambda: self.client.get_state() or None, "an answer to the goal")
        self.assertEqual(state, GoalStatus.ACTIVE, self.client.get_goal_status_text())

    def ended(self):
        wait_for(lambda: self.client.get_state() not in (GoalStatus.PENDING, GoalStatus.ACTIVE),
                 "the end of the goal")
        # Status and result come by topics of their own.
        wait_for(lambda: self.client.get_result() is not None, "the goal's result")
        return self.client.get_state(), self.client.get_result()

    def test_controllers_were_started_while_the_world_was_paused(self):
        self.assertTrue(self.was_paused)

    def test_a_goal_is_reached(self):
        self.client.send_goal(self.goal(-0.5, 1.0))
        state, result = self.ended()
        self.assertEqual((state, result.error_code), (
            GoalStatus.SUCCEEDED, FollowJointTrajectoryResult.SUCCESSFUL), result.error_string)
        wait_for(lambda: abs(self.positions()["elbow"] - 1.0) < 0.02
                 and abs(self.positions()["shoulder"] + 0.5) < 0.02, "both joints at the goal")
        weight = 9.8 * (1.0 * 0.2 + 0.5 * 0.4)   # about the shoulder, at least
        wait_for(lambda: self.efforts()["shoulder"] < -0.5 * weight, "the effort to hold the arm")

    def test_a_path_tolerance_ends_a_goal(self):
        goal = self.goal(2.0, -2.0, 0.1)
        goal.path_tolerance = [JointTolerance(name="shoulder", position=0.01)]
        self.client.send_goal(goal)
        state, result = self.ended()
        self.assertEqual(state, GoalStatus.ABORTED)
        self.assertEqual(result.error_code, FollowJointTrajectoryResult.PATH_TOLERANCE_VIOLATED)
        self.assertIn("shoulder", result.error_string)

    def test_a_goal_can_be_cancelled(self):
        self.follow(self.goal(0.8, 0.8, 30.0))
        self.client.cancel_goal()
        self.assertEqual(self.ended()[0], GoalStatus.PREEMPTED)

    def test_the_state_can_be_asked_for(self):
        wait_for(self.controller.all, "the state of the controller")
        self.assertEqual(self.controller.all()[-1].joint_names, NAMES)
        found = rospy.ServiceProxy("/arm/trajectory/query_state", QueryTrajectoryState)(
            rospy.get_rostime())
        self.assertEqual(list(found.name), NAMES)
        self.assertEqual(len(found.position), 2)

    def test_a_new_engine_keeps_the_goal(self):
        self.follow(self.goal(0.3, -0.6, 4.0))
        os.kill(rospy.get_param("/gazebo/my_simulations/engine_pid"), signal.SIGKILL)
        state, result = self.ended()
        # A new engine continues some steps back; a goal that came later ends with a reason.
        self.assertTrue(state == GoalStatus.SUCCEEDED or result.error_string
                        or self.client.get_goal_status_text(), state)

    def test_controllers_take_over_from_each_other(self):
        self.assertTrue(self.load("elbow").ok)
        self.assertFalse(self.switch(["elbow"], [], STRICT, False, 0.0).ok)  # in conflict
        self.assertTrue(self.switch(["elbow"], ["trajectory"], STRICT, False, 0.0).ok)
        self.assertEqual(self.running(), {"joint_state_controller", "elbow"})
        command = rospy.Publisher("/arm/elbow/command", Float64, queue_size=1, latch=True)
        command.publish(0.7)
        wait_for(lambda: abs(self.positions()["elbow"] - 0.7) < 0.05, "the elbow at 0.7 rad")
        self.assertFalse(self.unload("elbow").ok)  # while it runs
        self.assertTrue(self.switch(["trajectory"], ["elbow"], STRICT, False, 0.0).ok)
        self.assertTrue(self.unload("elbow").ok)
        wait_for(lambda: not any(name == "/arm/elbow/state" for name, _ in
                                 rospy.get_published_topics("/arm/elbow")), "the end of its topic")

    def test_a_reset_of_the_world_starts_controllers_anew(self):
        self.gazebo.reset_simulation()
        self.assertIn("trajectory", self.running())
        self.client.send_goal(self.goal(0.2, 0.2))
        self.assertEqual(self.ended()[0], GoalStatus.SUCCEEDED)

    def test_types_are_listed(self):
        types = manager("list_controller_types", ListControllerTypes)().types
        self.assertIn("diff_drive_controller/DiffDriveController", types)

    def test_gains_are_seen_and_set_by_dynamic_reconfigure(self):
        gains = "/arm/trajectory/gains/shoulder"
        self.assertIn(gains, dynamic_reconfigure.find_reconfigure_services())
        client = Client(gains, timeout=SECONDS)
        self.assertEqual(client.get_configuration(timeout=SECONDS)["p"], 400.0)
        changed = client.update_configuration({"p": 350.0})
        self.assertEqual((changed["p"], changed["d"], changed["antiwindup"]), (350.0, 30.0, False))
        wait_for(lambda: client.get_configuration()["p"] == 350.0, "the new gain")
        client.update_configuration({"p": 400.0})
        client.close()

    def test_the_command_lists_controllers(self):
        done = subprocess.run(["rosrun", "controller_manager", "controller_manager", "list",
                               "__ns:=/arm"], stdout=subprocess.PIPE, timeout=SECONDS,
                              text=True, check=False)
        self.assertEqual(done.returncode, 0)
        self.assertIn("'joint_state_controller'", done.stdout)
        self.assertIn("( running )", done.stdout)


if __name__ == "__main__":
    run("control")
