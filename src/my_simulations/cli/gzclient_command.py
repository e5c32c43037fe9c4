"""`gzclient`: opens the world editor of a running server."""
from __future__ import annotations

import signal
import sys
import threading
from typing import Any, List, Optional

from ..editor.web_browser import show
from ..program_end import exit_cleanly
from ..ros.lifecycle import master_api
from ..ros.own_server import EDITOR_REQUESTED

PROGRAM = "gzclient"
SERVER_SECONDS = 60.0
"""Longest wait for the server, wall seconds."""

POLL_SECONDS = 0.25
WATCH_SECONDS = 5.0

OK, FAILED = 0, 1

USAGE = """usage: gzclient [-h] [options of Gazebo's client, ignored] [name:=value ...]

Open the world editor of the running node `gazebo` in a browser, or print its URL if there is no
display. Exits when the node exits."""


@exit_cleanly
def main(argv: Optional[List[str]] = None) -> int:
    """Open the editor of the node `gazebo`, and wait until that node or this program ends.

    Options of Gazebo's client are accepted and ignored.

    Returns:
        0 after a signal or the end of the server, 1 without a server or editor.
    """
    words = sys.argv if argv is None else argv
    if "-h" in words[1:] or "--help" in words[1:]:
        print(USAGE)
        return OK
    client = _Client(words)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda _number, _frame: client.ended.set())
    return client.run()


class _Client:
    """Finds the editor through the master, without a node of its own."""

    def __init__(self, words: List[str]) -> None:
        self.ended = threading.Event()
        self._master = master_api.master_uri(words)
        self._name = master_api.node_name(words, "gazebo_gui")
        namespace = self._name.rpartition("/")[0]
        self._server = f"{namespace}/gazebo"

    def run(self) -> int:
        try:
            url = self._find()
            if url is None:
                return OK if self.ended.is_set() else FAILED
            show(url, PROGRAM)
            self._stay()
        except OSError as fault:
            if not self.ended.is_set():
                _complain(f"the ROS master at {self._master} stopped responding: {fault}")
        return OK

    def _find(self) -> Optional[str]:
        """URL of the editor; None, with a printed reason, if there is none."""
        import time

        until = time.monotonic() + SERVER_SECONDS
        if not master_api.wait_for_master(self._master, self._name, self.ended, _complain, until):
            return None
        told = False
        while not self.ended.is_set():
            server = master_api.running_node(self._master, self._server)
            if server is not None:
                url = self._parameter() or self._open_editor()
                if url:
                    return url
            if time.monotonic() > until:
                _complain(f"no world editor: the node {self._server} on {self._master} "
                          + ("did not open one" if server is not None else "is not running"))
                return None
            if not told:
                told = True
                _complain(f"waiting for the node {self._server} on {self._master}")
            self.ended.wait(POLL_SECONDS)
        return None

    def _parameter(self) -> str:
        found: Any = master_api.call(self._master, "getParam", self._name,
                                 f"{self._server}/my_simulations/editor_url")
        return found if isinstance(found, str) else ""

    def _open_editor(self) -> str:
        """Have the server start its editor, if it supports that; returns the URL."""
        service = f"{self._server}/open_editor"
        if not master_api.call(self._master, "lookupService", self._name, service):
            # Without extensions there is no such service: the server reads this parameter.
            master_api.call(self._master, "setParam", self._name,
                            f"{self._server}/{EDITOR_REQUESTED}", True)
            return ""
        import rospy
        from my_simulations_msgs.srv import OpenEditor

        try:
            answer = rospy.ServiceProxy(service, OpenEditor)()
        except rospy.ServiceException:
            return ""  # it is shutting down, or restarting
        if not answer.success:
            _complain(answer.status_message)
        return str(answer.url)

    def _stay(self) -> None:
        """Wait for a signal or the end of the server: launch files may set `required`."""
        while not self.ended.wait(WATCH_SECONDS):
            if master_api.running_node(self._master, self._server) is None:
                return


def _complain(line: str) -> None:
    print(f"{PROGRAM}: {line}", file=sys.stderr, flush=True)
