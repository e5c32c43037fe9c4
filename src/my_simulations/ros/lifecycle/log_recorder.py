"""Records the state log of `--record`; the function that starts it is passed in by `cli`."""
from __future__ import annotations

from typing import Any, Callable, Optional, Protocol

import rospy

from ...errors import CommandError, Issue
from ...resources.resolver import Resolver
from ...simulator.simulator import Simulator
from ..issue_logging import log_issue
from .server_options import Recording


class RunningRecorder(Protocol):
    """Interface of a log that is being written."""

    path: str

    def stop(self) -> None:
        """Close the log. Raises CommandError: it could not be completed."""


StartRecording = Callable[[Simulator, Resolver, Recording, Callable[[Issue], None], Any],
                          RunningRecorder]
"""Starts a log; the function receives an issue if it stops early. The last argument is the
`TopicGraph`, or None. Raises CommandError.
"""


def start_log(start: StartRecording, simulator: Simulator, resolver: Resolver,
              wanted: Recording, topics: Any) -> Optional[RunningRecorder]:
    """Start the state log; log an error and return None if it cannot be written."""
    try:
        recorder = start(simulator, resolver, wanted, log_issue, topics)
    except CommandError as fault:
        rospy.logerr("cannot record a state log: %s", fault)
        return None
    rospy.loginfo("recording state log: %s", recorder.path)
    return recorder


def close_log(recorder: RunningRecorder) -> None:
    """Close the state log; log an error if it is incomplete."""
    try:
        recorder.stop()
    except CommandError as fault:
        rospy.logerr("state log is incomplete: %s", fault)
