#!/usr/bin/env python3
"""Keys that are typed into teleop_twist_keyboard's terminal drive the lab robot."""
import contextlib
import os
import pty
import select
import subprocess
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

from nav_msgs.msg import Odometry
from support import SECONDS, Collected, Gazebo, run, wait_for

ROBOT = "robo"
CTRL_C = "\x03"


class Typist:
    """A program in a separate terminal, with a method that types into it."""

    def __init__(self, *command):
        self._terminal, program_end = pty.openpty()
        self.process = subprocess.Popen(command, stdin=program_end, stdout=program_end,
                                        stderr=program_end, start_new_session=True)
        os.close(program_end)
        self._seen = ""

    def type(self, keys):
        os.write(self._terminal, keys.encode())

    def seen(self):
        """What the terminal shows so far."""
        with contextlib.suppress(OSError):
            while select.select([self._terminal], [], [], 0.0)[0]:
                self._seen += os.read(self._terminal, 4096).decode(errors="replace")
        return self._seen

    def close(self):
        if self.process.poll() is None:
            self.process.kill()
        self.process.wait(SECONDS)
        os.close(self._terminal)


class Teleop(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.gazebo = Gazebo()
        cls.odom = Collected("/odom", Odometry)
        wait_for(lambda: ROBOT in cls.gazebo.names(), "the robot")
        wait_for(cls.odom.all, "odometry")

    def setUp(self):
        self.typist = Typist("rosrun", "teleop_twist_keyboard", "teleop_twist_keyboard.py",
                             "_speed:=0.2", "_turn:=0.5")
        self.addCleanup(self.typist.close)
        wait_for(lambda: "speed" in self.typist.seen(), "the keys being explained")

    def speeds(self):
        twist = self.odom.all()[-1].twist.twist
        return twist.linear.x, twist.angular.z

    def drives(self, forward, turn):
        wait_for(lambda: abs(self.speeds()[0] - forward) < 0.02
                 and abs(self.speeds()[1] - turn) < 0.05, f"{forward} m/s and {turn} rad/s")

    def press(self, key, forward, turn):
        """Press a key until the robot drives: the first keys can precede the subscription."""
        def pressed():
            self.typist.type(key)
            with contextlib.suppress(AssertionError):
                wait_for(lambda: abs(self.speeds()[0] - forward) < 0.02
                         and abs(self.speeds()[1] - turn) < 0.05, "the robot", 2.0)
                return True
            return False
        wait_for(pressed, f"'{key}' driving with {forward} m/s and {turn} rad/s")

    def test_keys_drive_turn_and_stop_and_ctrl_c_ends(self):
        self.press("i", 0.2, 0.0)
        self.press("j", 0.0, 0.5)
        self.press("l", 0.0, -0.5)
        self.press(",", -0.2, 0.0)
        self.typist.type("ik")         # in one go: the last one counts
        self.drives(0.0, 0.0)
        self.typist.type("w")          # 10 % faster
        self.press("i", 0.22, 0.0)
        self.typist.type(CTRL_C)
        self.assertEqual(self.typist.process.wait(SECONDS), 0)
        self.drives(0.0, 0.0)


if __name__ == "__main__":
    run("teleop")
