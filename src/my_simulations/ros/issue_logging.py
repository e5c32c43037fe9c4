"""Issues as ROS log lines."""
from __future__ import annotations

import time
from typing import List

import rospy

from ..errors import Issue, Severity

ROSOUT_SECONDS = 1.0
"""Longest wait (wall seconds) for a subscriber of /rosout before the node exits with an error."""


def log_issue(issue: Issue) -> None:
    """Log an issue at the level of its severity."""
    if issue.severity is Severity.ERROR:
        rospy.logerr("%s", issue)
    elif issue.severity is Severity.WARNING:
        rospy.logwarn("%s", issue)
    else:
        rospy.loginfo("%s", issue)


def log_fatal(lines: List[str]) -> None:
    """Log why the node exits, on standard error and /rosout, and wait until it is sent."""
    from rosgraph_msgs.msg import Log

    out = rospy.Publisher("/rosout", Log, queue_size=100)
    until = time.monotonic() + ROSOUT_SECONDS
    while out.get_num_connections() == 0 and time.monotonic() < until:
        time.sleep(0.02)
    for line in lines:
        rospy.logfatal("%s", line)
    time.sleep(0.1)
