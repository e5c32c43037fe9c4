#!/usr/bin/env python3
"""A robot keeps driving while plugins with faults are spawned; a plugin that is mended runs."""
import asyncio
import os
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import aiohttp
import rospy
import support  # noqa: F401  (the folder of editor_case is on the path from here on)
from editor_case import Browser
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Log
from std_msgs.msg import Int64
from support import Collected, Gazebo, box, pose, run, wait_for

from my_simulations.editor.transport import address_file

PLUGIN = '<gazebo><plugin name="written" filename="libwritten.so"/></gazebo>'
TURN = 0.5   # rad/s
HEAD = "from my_simulations.plugins.base import Plugin\nclass Written(Plugin):\n"
LOAD = HEAD + "    def load(self):\n        "
CALL = LOAD + "self.context.every(100.0, self.call)\n    def call(self):\n        "
REPLIES = [  # module, what the reply of the spawn service says
    ("def typo(:\n", "SyntaxError"),
    ("undefined_name\n", "NameError"),
    ("import sys; sys.exit(1)\n", "SystemExit: 1"),
    (LOAD + "raise KeyboardInterrupt\n", "KeyboardInterrupt"),
    (LOAD + "import os; os._exit(3)\n", "exit status 3"),
    (LOAD + "import ctypes; ctypes.string_at(0)\n", "SIGSEGV"),
    (LOAD + "bytearray(1 << 46)\n", "MemoryError"),
    (LOAD + "raise ValueError('x' * 50_000_000)\n", "more characters"),
    ("while True: pass\n", "processor time"),
]
LATER = [  # module, what the log says after a call
    (CALL + "import os; os.kill(os.getpid(), 2)\n", "KeyboardInterrupt"),
    (CALL + "1 / 0\n", "ZeroDivisionError"),
    (CALL + "while True: pass\n", "processor time"),
]
MENDED = LOAD + """self.topic = self.context.publish("/mended", "std_msgs/Int64")
        self.context.every(50.0, self.call)

    def call(self):
        message = self.context.message("std_msgs/Int64")
        message.data = self.context.step
        self.topic.publish(message)
"""


class BadPlugins(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.file = os.path.join(cls.folder.name, "module_under_test.py")
        rospy.set_param("/written_plugin/folder", cls.folder.name)
        cls.gazebo = Gazebo()
        cls.log = Collected("/rosout", Log)
        cls.odom = Collected("/odom", Odometry)
        cls.mended = Collected("/mended", Int64)
        command = Twist()
        command.angular.z = TURN
        cls.command = rospy.Publisher("/cmd_vel", Twist, queue_size=1, latch=True)
        cls.command.publish(command)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def setUp(self):
        if "written" in self.gazebo.names():
            self.gazebo.delete_model("written")
        self.keeps_turning()

    def keeps_turning(self):
        self.odom.clear()
        wait_for(lambda: [one for one in self.odom.all() if
                          abs(one.twist.twist.angular.z - TURN) < 0.1], "the robot's turn")

    def spawn(self, source):
        with open(self.file, "w") as stream:
            stream.write(source)
        answer = self.gazebo.spawn("written", box(extra=PLUGIN), pose(3.0, 0.0, 0.2))
        self.assertTrue(answer.success, answer.status_message)
        return answer.status_message

    def errors(self):
        return [one.msg for one in self.log.all()
                if one.level == Log.ERROR and "plugin 'written'" in one.msg]

    def test_the_reply_names_the_fault_and_the_robot_keeps_driving(self):
        for source, said in REPLIES:
            with self.subTest(said=said, source=source):
                self.log.clear()
                status = self.spawn(source)
                self.assertIn("plugin 'written' (libwritten.so) of model 'written'", status)
                self.assertIn(said, status)
                self.assertIn(self.file, status)
                wait_for(self.errors, "an error in the log")
                self.keeps_turning()
                self.gazebo.delete_model("written")

    def test_the_log_names_the_fault_of_a_call_and_the_robot_keeps_driving(self):
        for source, said in LATER:
            with self.subTest(said=said):
                self.log.clear()
                self.spawn(source)
                wait_for(lambda said=said: [one for one in self.errors() if said in one
                                            and self.file in one], "an error in the log")
                self.keeps_turning()
                self.gazebo.delete_model("written")

    def test_the_editor_shows_the_fault(self):
        self.spawn("undefined_name\n")
        url = address_file.with_token(self.gazebo.open_editor().url)

        async def watch():
            async with aiohttp.ClientSession() as session:
                browser = await Browser.open(session, url)
                await browser.until(lambda: [
                    push for push in browser.pushes
                    if push["type"] == "issue" and "NameError" in push["issue"]["message"]
                    and self.file in push["issue"]["message"]])

        asyncio.run(watch())

    def test_a_plugin_that_is_mended_runs_without_a_restart(self):
        self.assertIn("NameError", self.spawn("undefined_name\n"))
        self.gazebo.delete_model("written")
        self.assertNotIn("problem", self.spawn(MENDED))
        self.mended.clear()
        wait_for(self.mended.all, "a message of the plugin")
        self.gazebo.delete_model("written")
        self.keeps_turning()


if __name__ == "__main__":
    run("bad_plugins")
