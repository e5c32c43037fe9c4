"""Ends the threads of a node of rospy, and waits for none that has nothing left to do.

`rospy.signal_shutdown` waits for the thread that registers topics, which looks every 0.5 s whether
the node has ended. The node's XML-RPC server polls its closed socket from then on, with a whole
processor for as long as the process lives.
"""
from __future__ import annotations

import socketserver
import threading
from functools import partial

import rospy.core
from rospy.impl.registration import RegManager


def end_promptly() -> None:
    """Wake that thread and end that server with the node; call it once, after `rospy.init_node`.

    rospy has no interface for this (rospy 1.14 to 1.17, the versions of the last ROS 1
    distributions, have it in the same place).
    """
    for hook in rospy.core._preshutdown_hooks:
        manager = getattr(hook, "__self__", None)
        if isinstance(manager, RegManager):
            rospy.core.add_shutdown_hook(partial(_wake, manager.cond))
    for hook in tuple(rospy.core._shutdown_hooks):
        server = getattr(getattr(hook, "__self__", None), "server", None)   # of an XmlRpcNode
        if isinstance(server, socketserver.BaseServer):
            rospy.core.add_shutdown_hook(partial(_end_server, server))


def _wake(condition: threading.Condition, _reason: str) -> None:
    with condition:
        condition.notify_all()


def _end_server(server: socketserver.BaseServer, _reason: str) -> None:
    # `shutdown` waits for the poll of the server, for up to 0.5 s.
    threading.Thread(target=server.shutdown, daemon=True).start()
