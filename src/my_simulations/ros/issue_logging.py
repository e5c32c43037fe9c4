"""Issues as ROS log lines."""
from __future__ import annotations

import time
from typing import Callable, List, Set

import rospy

from ..errors import Issue, Severity

ROSOUT_SECONDS = 5.0
"""Longest wait (wall seconds) for subscribers of /rosout before the node exits with an error."""


def log_issue(issue: Issue) -> None:
    """Log an issue at the level of its severity."""
    if issue.severity is Severity.ERROR:
        rospy.logerr("%s", issue)
    elif issue.severity is Severity.WARNING:
        rospy.logwarn("%s", issue)
    else:
        rospy.loginfo("%s", issue)


def log_fatal(lines: List[str], listeners: Set[str]) -> None:
    """Log why the node exits, on standard error and /rosout, and wait until it is sent.

    Args:
        lines: the reasons.
        listeners: nodes that hear /rosout. All are waited for: the node `rosout` is one of them,
            and not always the first that has connected.
    """
    from rosgraph_msgs.msg import Log

    out = rospy.Publisher("/rosout", Log, queue_size=100)
    until = time.monotonic() + ROSOUT_SECONDS
    _wait(lambda: listeners <= {one.endpoint_id for one in out.impl.connections}, until)
    # rospy sends from a thread of each connection, which ends with the process.
    due = [(one, one.stat_num_msg + len(lines)) for one in out.impl.connections]
    for line in lines:
        rospy.logfatal("%s", line)
    _wait(lambda: all(one.done or one.stat_num_msg >= count for one, count in due), until)


def _wait(condition: Callable[[], bool], until: float) -> None:
    while not condition() and time.monotonic() < until:
        time.sleep(0.02)
