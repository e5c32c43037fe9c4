#!/usr/bin/env python3
"""Drives a robot from the keyboard: geometry_msgs/Twist on cmd_vel.

Keys and parameters (`~speed`, `~turn`, `~repeat_rate`, `~key_timeout`) are those that users know.
"""
from __future__ import annotations

import os
import select
import sys
import termios
import tty
from typing import Dict, Tuple

import rospy
from geometry_msgs.msg import Twist

HELP = """
Drive with
   u    i    o
   j    k    l
   m    ,    .
i/, forwards and backwards, j/l turn, k (or any other key) stops.
With Shift (holonomic robots): U I O J L M < > move sideways; t/b up and down.
q/z all speeds up/down by 10 %, w/x linear speed, e/c turning speed. Ctrl-C ends.
"""

MOVES: Dict[str, Tuple[int, int, int, int]] = {
    "i": (1, 0, 0, 0), "o": (1, 0, 0, -1), "j": (0, 0, 0, 1), "l": (0, 0, 0, -1),
    "u": (1, 0, 0, 1), ",": (-1, 0, 0, 0), ".": (-1, 0, 0, 1), "m": (-1, 0, 0, -1),
    "O": (1, -1, 0, 0), "I": (1, 0, 0, 0), "J": (0, 1, 0, 0), "L": (0, -1, 0, 0),
    "U": (1, 1, 0, 0), "<": (-1, 0, 0, 0), ">": (-1, -1, 0, 0), "M": (-1, 1, 0, 0),
    "t": (0, 0, 1, 0), "b": (0, 0, -1, 0),
}
"""Shares of the speeds along x, y, z and about z, by key."""

SPEEDS: Dict[str, Tuple[float, float]] = {
    "q": (1.1, 1.1), "z": (0.9, 0.9), "w": (1.1, 1.0), "x": (0.9, 1.0), "e": (1.0, 1.1),
    "c": (1.0, 0.9),
}
"""Factors for linear and turning speed, by key."""

ENDS = "\x03"
LOOK_SECONDS = 0.1


def key_within(seconds: float) -> str:
    """The next key, or "" when none was pressed in time."""
    if select.select([sys.stdin], [], [], seconds)[0]:
        # Not by sys.stdin, which would keep keys that came together where select does not look.
        return os.read(sys.stdin.fileno(), 1).decode("latin-1") or ENDS
    return ""


def single_keys() -> None:
    """Read keys one by one; Ctrl-C is one of them, so that the node can still stop the robot."""
    tty.setcbreak(sys.stdin.fileno())
    modes = termios.tcgetattr(sys.stdin)
    modes[3] &= ~termios.ISIG
    termios.tcsetattr(sys.stdin, termios.TCSADRAIN, modes)


def twist(move: Tuple[int, int, int, int], speed: float, turn: float) -> Twist:
    """A command, m/s and rad/s."""
    made = Twist()
    made.linear.x, made.linear.y, made.linear.z = (share * speed for share in move[:3])
    made.angular.z = move[3] * turn
    return made


def main() -> None:
    """Read keys until Ctrl-C, and publish a command for each, and again at `~repeat_rate` Hz."""
    rospy.init_node("teleop_twist_keyboard")
    publisher = rospy.Publisher("cmd_vel", Twist, queue_size=1)
    speed, turn = rospy.get_param("~speed", 0.5), rospy.get_param("~turn", 1.0)
    repeat = rospy.get_param("~repeat_rate", 0.0)
    timeout = rospy.get_param("~key_timeout", 0.0)
    wait = timeout or (1.0 / repeat if repeat > 0.0 else LOOK_SECONDS)
    before = termios.tcgetattr(sys.stdin) if sys.stdin.isatty() else None
    move = (0, 0, 0, 0)
    print(f"{HELP}\nspeed {speed:g} m/s, turn {turn:g} rad/s")  # noqa: T201
    try:
        if before is not None:
            single_keys()
        while not rospy.is_shutdown():
            key = key_within(wait)
            if key == ENDS:
                break
            if key in SPEEDS:
                speed, turn = speed * SPEEDS[key][0], turn * SPEEDS[key][1]
                print(f"speed {speed:g} m/s, turn {turn:g} rad/s")  # noqa: T201
            elif key:
                move = MOVES.get(key, (0, 0, 0, 0))
            elif timeout > 0.0:
                move = (0, 0, 0, 0)
            if key or repeat > 0.0 or timeout > 0.0:
                publisher.publish(twist(move, speed, turn))
    except KeyboardInterrupt:
        pass  # the ordinary end
    finally:
        publisher.publish(Twist())
        if before is not None:
            termios.tcsetattr(sys.stdin, termios.TCSADRAIN, before)


if __name__ == "__main__":
    main()
