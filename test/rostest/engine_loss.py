#!/usr/bin/env python3
"""The engine's process is killed: the world comes back as it was, and callers get answers."""
import os
import signal
import sys
import threading

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rospy
import support
from support import pose, twist

PENDULUM = """<robot name="arm"><link name="world"/>
  <link name="base"><inertial><mass value="5"/>
    <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <link name="bob"><inertial><origin xyz="1 0 0"/><mass value="1"/>
    <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
  <joint name="foot" type="fixed"><parent link="world"/><child link="base"/></joint>
  <joint name="hinge" type="revolute"><parent link="base"/><child link="bob"/>
    <axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="10" velocity="100"/></joint></robot>"""
PID = "/gazebo/my_simulations/engine_pid"


def values(state):
    """Pose and twist of a state, flat."""
    v, w = state.twist.linear, state.twist.angular
    return (*support.numbers(state.pose), v.x, v.y, v.z, w.x, w.y, w.z)


class EngineLoss(support.GazeboCase):
    def setUp(self):
        self.gazebo.unpause_physics()
        self.gazebo.clear()

    def kill_engine(self):
        old = support.wait_for(lambda: rospy.get_param(PID, 0), "the engine's process id")
        os.kill(old, signal.SIGKILL)
        return old

    def wait_for_another(self, old):
        support.wait_for(lambda: rospy.get_param(PID, 0) not in (0, old), "another engine")

    def test_a_paused_world_comes_back_with_poses_and_time(self):
        for n in range(5):
            self.assertTrue(self.gazebo.spawn(f"box_{n}", where=pose(n, 0.0, 0.1)).success)
        self.gazebo.pause_physics()
        self.gazebo.place("box_3", pose(3.0, 4.0, 5.0, 0.5), twist((1.0, 2.0, 3.0)))
        time, names = self.gazebo.sim_time(), self.gazebo.names()
        states = {name: self.gazebo.get_model_state(name, "") for name in names}
        told = support.heard_on_rosout("engine")
        self.wait_for_another(self.kill_engine())
        told()
        self.assertEqual(self.gazebo.sim_time(), time)
        self.assertEqual(self.gazebo.names(), names)
        self.assertTrue(self.gazebo.is_paused())
        for name, before in states.items():
            after = self.gazebo.get_model_state(name, "")
            for one, other in zip(values(after), values(before)):
                self.assertAlmostEqual(one, other, delta=1e-9, msg=name)

    def test_a_swinging_joint_comes_back_where_it_was_and_as_fast(self):
        self.done(self.gazebo.spawn("arm", xml=PENDULUM, where=pose(0.0, 0.0, 3.0)))
        support.wait_for(lambda: self.bob().twist.angular.y > 1.0, "a swing")
        self.gazebo.pause_physics()
        before = self.bob()
        self.wait_for_another(self.kill_engine())
        for one, other in zip(values(self.bob()), values(before)):
            self.assertAlmostEqual(one, other, delta=1e-6)
        self.gazebo.unpause_physics()
        support.wait_for(lambda: self.bob().twist.angular.y < 0.0, "the swing back")

    def bob(self):
        return self.gazebo.get_link_state("arm::bob", "").link_state

    def test_a_running_world_goes_on_from_where_it_was(self):
        self.assertTrue(self.gazebo.spawn("box", where=pose(1.0, 2.0, 0.1)).success)
        before = self.gazebo.sim_time()
        self.wait_for_another(self.kill_engine())
        support.wait_for(lambda: self.gazebo.sim_time() > before + 0.01, "time going on")
        where = self.gazebo.get_model_state("box", "").pose.position
        self.assertAlmostEqual(where.x, 1.0, 2)
        self.assertAlmostEqual(where.y, 2.0, 2)
        self.assertGreater(where.z, 0.09)
        self.assertTrue(self.gazebo.spawn("another", where=pose(3.0, 0.0, 0.1)).success)

    def test_calls_in_flight_are_answered(self):
        self.gazebo.spawn("box", where=pose(0.0, 0.0, 0.1))
        answers, stop = [], threading.Event()

        def call():
            client = support.Gazebo()
            while not stop.is_set():
                answers.append(client.place("box", pose(1.0, 0.0, 0.1)))

        callers = [threading.Thread(target=call) for _ in range(3)]
        for caller in callers:
            caller.start()
        support.wait_for(lambda: len(answers) > 20, "answers")
        old = self.kill_engine()
        self.wait_for_another(old)
        seen = len(answers)
        support.wait_for(lambda: len(answers) > seen + 20, "answers after the loss")
        stop.set()
        for caller in callers:
            caller.join(support.SECONDS)
            self.assertFalse(caller.is_alive(), "a call was never answered")
        self.assertTrue(answers[-1].success, answers[-1].status_message)
        for answer in answers:
            self.assertTrue(answer.success or "SetModelState: " in answer.status_message)


if __name__ == "__main__":
    support.run("engine_loss")
