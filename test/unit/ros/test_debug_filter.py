"""With --verbose, the log shows debug messages of the node and none of rospy."""
from __future__ import annotations

import logging

import rospy
from rospy.impl import tcpros_base

from my_simulations.ros.lifecycle.debug_filter import RospyDebugFilter


class Kept(logging.Handler):
    def __init__(self):
        super().__init__()
        self.messages = []

    def emit(self, record):
        self.messages.append(record.getMessage())


def test_debug_messages_of_rospy_are_dropped():
    logger, kept, chosen = logging.getLogger("rosout"), Kept(), RospyDebugFilter()
    level = logger.level
    logger.addHandler(kept)
    logger.addFilter(chosen)
    logger.setLevel(logging.DEBUG)
    try:
        rospy.logdebug("of the node")
        server = tcpros_base.TCPServer(lambda socket, address: None)   # it logs its port
        server.shutdown()
        rospy.logwarn("a warning")
    finally:
        logger.removeHandler(kept)
        logger.removeFilter(chosen)
        logger.setLevel(level)
    assert kept.messages == ["of the node", "a warning"]
