"""XML-RPC calls to the ROS master and to nodes, with timeouts, without rospy.

`rospy.init_node` waits for a master for ever without a helpful message, and shuts down a running
node of the same name. Both are checked here first.
"""
from __future__ import annotations

import http.client
import os
import socket
import threading
import time
import xmlrpc.client
from typing import Any, Callable, Optional, Sequence, Set, Tuple
from urllib.parse import urlparse

CALL_SECONDS = 3.0
"""Wall seconds that one call may take."""

NODE_SECONDS = 10.0
"""As CALL_SECONDS, for a node that may be busy, and would be shut down by another of its name."""

POLL_SECONDS = 0.25
REMIND_SECONDS = 4.0

DEFAULT_URI = "http://localhost:11311"


class _Transport(xmlrpc.client.Transport):
    """An XML-RPC transport with a timeout on its socket."""

    def __init__(self, seconds: float) -> None:
        super().__init__()
        self._seconds = seconds

    def make_connection(self, host: Any) -> http.client.HTTPConnection:
        connection = super().make_connection(host)
        connection.timeout = self._seconds
        return connection


def call(uri: str, method: str, *arguments: Any, seconds: float = CALL_SECONDS) -> Any:
    """Call a ROS XML-RPC method; returns the value if the status code is 1 (success), else None.

    Raises OSError: no response in time.
    """
    try:
        with xmlrpc.client.ServerProxy(uri, transport=_Transport(seconds)) as proxy:
            code, _, value = getattr(proxy, method)(*arguments)
    except (xmlrpc.client.Error, http.client.HTTPException, TypeError, ValueError) as fault:
        raise OSError(f"{uri} does not respond like a ROS master or node: {fault}") from fault
    return value if code == 1 else None


def master_uri(argv: Sequence[str] = ()) -> str:
    """URI of the master: `__master:=`, else ROS_MASTER_URI, else the default."""
    for word in argv:
        if word.startswith("__master:="):
            return word[len("__master:="):]
    return os.environ.get("ROS_MASTER_URI") or DEFAULT_URI


def fault_of(master: str, caller: str) -> str:
    """Why the master does not respond, in a few words; "" if it does."""
    try:
        found = urlparse(master)
        if not found.hostname or not found.port:
            return "ROS_MASTER_URI must have the form http://host:port"
    except ValueError as fault:
        return f"invalid ROS_MASTER_URI: {fault}"
    try:
        call(master, "getPid", caller)
    except socket.gaierror:
        return f"unknown host name {found.hostname!r}"
    except (OSError, TypeError) as fault:
        return str(fault)
    return ""


def wait_for_master(master: str, caller: str, stop: threading.Event, say: Callable[[str], None],
                    deadline: Optional[float] = None) -> bool:
    """Wait until the master responds.

    Args:
        master: its URI.
        caller: name of the calling node.
        stop: ends the wait when set.
        say: called with a message at once, and again every few seconds.
        deadline: `time.monotonic()` at which to give up; None for never.

    Returns:
        True if the master responds, False after `stop` or the deadline.
    """
    next_word = 0.0
    while True:
        fault = fault_of(master, caller)
        if not fault:
            return True
        if stop.is_set():
            return False
        now = time.monotonic()
        if deadline is not None and now >= deadline:
            return False
        if now >= next_word:
            say(f"waiting for the ROS master at {master} ({fault}); "
                "start roscore or roslaunch, or set ROS_MASTER_URI; press Ctrl-C to abort")
            next_word = now + REMIND_SECONDS
        stop.wait(POLL_SECONDS)


def other_subscribers(master: str, caller: str, topic: str) -> Set[str]:
    """Nodes that the master knows as subscribers of a topic, but the caller; none without it."""
    try:
        state = call(master, "getSystemState", caller)
    except OSError:
        return set()
    return {node for name, nodes in (state or ((), ()))[1] if name == topic for node in nodes
            if node != caller}


def node_name(argv: Sequence[str], default: str) -> str:
    """The full name of the node that `rospy.init_node(default)` creates with these arguments."""
    namespace, name = os.environ.get("ROS_NAMESPACE", "/"), default
    for word in argv:
        key, _, value = word.partition(":=")
        if key == "__ns":
            namespace = value
        elif key == "__name":
            name = value
    return "/" + "/".join(part for part in (namespace + "/" + name).split("/") if part)


def running_node(master: str, name: str) -> Optional[Tuple[str, int]]:
    """URI and process id of the running node of that name; None if there is none.

    Raises OSError: the master does not respond.
    """
    found = call(master, "lookupNode", name, name)
    if not found:
        return None
    try:
        pid = call(found, "getPid", name, seconds=NODE_SECONDS)
    except OSError:
        return None
    return found, int(pid or 0)
