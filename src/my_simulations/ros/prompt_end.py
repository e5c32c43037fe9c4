"""Ends a node of rospy without waiting for threads that have nothing left to do.

`rospy.signal_shutdown` waits for the thread that registers topics, which looks every 0.5 s whether
the node has ended. Meanwhile the node's XML-RPC server polls a socket that is closed already, with
a whole processor.
"""
from __future__ import annotations

import threading
from functools import partial

import rospy.core
from rospy.impl.registration import RegManager


def end_promptly() -> None:
    """Wake that thread when the node ends; call it once, after `rospy.init_node`.

    rospy has no interface for this (rospy 1.14 to 1.17, the versions of the last ROS 1
    distributions, have it in the same place).
    """
    for hook in rospy.core._preshutdown_hooks:
        manager = getattr(hook, "__self__", None)
        if isinstance(manager, RegManager):
            rospy.core.add_shutdown_hook(partial(_wake, manager.cond))


def _wake(condition: threading.Condition, _reason: str) -> None:
    with condition:
        condition.notify_all()
