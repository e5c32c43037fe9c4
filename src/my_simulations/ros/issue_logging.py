"""Issues as ROS log lines."""
from __future__ import annotations

import rospy

from ..errors import Issue, Severity


def log_issue(issue: Issue) -> None:
    """Log an issue at the level of its severity."""
    if issue.severity is Severity.ERROR:
        rospy.logerr("%s", issue)
    elif issue.severity is Severity.WARNING:
        rospy.logwarn("%s", issue)
    else:
        rospy.loginfo("%s", issue)
