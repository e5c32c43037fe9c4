"""The state log of `--record`, which is another face's and is handed in by who starts us."""
from __future__ import annotations

from typing import Callable, Optional, Protocol

import rospy

from ...errors import CommandError, Issue
from ...resources.resolver import Resolver
from ...simulator.simulator import Simulator
from ..issue_logging import log_issue
from .server_options import Recording


class RunningRecorder(Protocol):
    """What is needed of a log that is being written."""

    path: str

    def stop(self) -> None:
        """Finish it. Raises CommandError."""


StartRecording = Callable[[Simulator, Resolver, Recording, Callable[[Issue], None]],
                          RunningRecorder]
"""Begins a log; the function hears when it ends early. Raises CommandError."""


def begin(start: StartRecording, simulator: Simulator, resolver: Resolver,
          wanted: Recording) -> Optional[RunningRecorder]:
    """The log, begun; None, with an error said, when there can be none."""
    try:
        recorder = start(simulator, resolver, wanted, log_issue)
    except CommandError as fault:
        rospy.logerr("no state log is recorded: %s", fault)
        return None
    rospy.loginfo("the state log is %s", recorder.path)
    return recorder


def finish(recorder: RunningRecorder) -> None:
    """End it; a fault is said."""
    try:
        recorder.stop()
    except CommandError as fault:
        rospy.logerr("the state log ends early: %s", fault)
