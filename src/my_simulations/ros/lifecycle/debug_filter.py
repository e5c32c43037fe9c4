"""Keeps the debug messages of rospy itself out of the log of `--verbose`."""
from __future__ import annotations

import logging
import os


class RospyDebugFilter(logging.Filter):
    """Drops debug messages of rospy: one for each connection, service and timer.

    rospy logs them by the logger of the node, so the level of the node includes them.
    """

    def __init__(self) -> None:
        import rospy

        super().__init__()
        self._folder = os.path.join(os.path.dirname(rospy.__file__), "")

    def filter(self, record: logging.LogRecord) -> bool:
        """Return whether the message is to be logged."""
        return record.levelno > logging.DEBUG or not record.pathname.startswith(self._folder)
