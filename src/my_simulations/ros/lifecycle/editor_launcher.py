"""The node's door to the world editor, which is another face and is handed in by who starts us."""
from __future__ import annotations

import threading
from typing import Any, Callable, Dict, Optional, Protocol

import rospy

from ...errors import CommandError, Issue
from ...resources.resolver import Resolver
from ...simulator.simulator import Simulator
from ..issue_logging import log_issue

URL = "~my_simulations/editor_url"
"""Parameter: the editor's address, while it runs."""


class RunningEditor(Protocol):
    """What is needed of a running editor."""

    url: str

    def stop(self, reason: str = "") -> None:
        """End it."""

    def tell(self, issue: Issue) -> None:
        """Show an issue."""


StartEditor = Callable[[Simulator, Resolver, Dict[str, Any]], RunningEditor]
"""Starts an editor with settings by name (`editor.EditorOptions`). Raises CommandError."""


class EditorLauncher:
    """Starts the editor when it is first wanted, with the settings of the parameter server.

    Args:
        start: starts it.
        simulator, resolver: what it shows.
        listen: given a function that wants all issues, those of the start included.
        caller: folder in which the command was typed.
    """

    def __init__(self, start: StartEditor, simulator: Simulator, resolver: Resolver,
                 listen: Callable[[Callable[[Issue], None]], None], caller: str = "") -> None:
        self._start = start
        self._world = (simulator, resolver)
        self._listen = listen
        self._caller = caller
        self._lock = threading.Lock()
        self._editor: Optional[RunningEditor] = None
        if rospy.has_param(URL):  # of a node that was killed
            rospy.delete_param(URL)

    @staticmethod
    def wanted() -> bool:
        """Whether the launch file asks for the editor at once: parameter `~gui`."""
        return rospy.get_param("~gui", False) is True

    def open_soon(self) -> None:
        """Start it in the background; a fault is logged."""
        threading.Thread(target=self._try, name="editor start", daemon=True).start()

    def open(self) -> str:
        """The address of the editor, which runs then. Raises CommandError."""
        with self._lock:
            if self._editor is None:
                self._editor = self._start(*self._world, {
                    **_settings(), "log": log_issue, "caller": self._caller})
                self._listen(self._editor.tell)
                rospy.set_param(URL, self._editor.url)
                rospy.loginfo("the world editor is at %s", self._editor.url)
            return self._editor.url

    def announce(self) -> None:
        """Set the parameter with its address once more, if it runs."""
        with self._lock:
            if self._editor is not None:
                rospy.set_param(URL, self._editor.url)

    def close(self) -> None:
        """End it."""
        with self._lock:
            if self._editor is not None:
                self._editor.stop("the simulator ends")
                self._editor = None
                try:
                    rospy.delete_param(URL)
                except (OSError, KeyError):
                    return  # the master has gone, too

    def _try(self) -> None:
        try:
            self.open()
        except CommandError as fault:
            rospy.logerr("the world editor is not there: %s", fault)
        except OSError as fault:
            rospy.logwarn("the master does not answer: %s", fault)


def _settings() -> Dict[str, Any]:
    """Settings from `~editor_host`, `~editor_port` and `~save_roots`. Raises CommandError."""
    found: Dict[str, Any] = {}
    host = rospy.get_param("~editor_host", "")
    if host:
        found["host"] = str(host)
    port = rospy.get_param("~editor_port", None)
    if port is not None:
        if isinstance(port, bool) or not isinstance(port, int) or not 0 <= port < 65536:
            raise CommandError(f"the parameter {rospy.resolve_name('~editor_port')} must be a port"
                               f" number, 0 for any; it is {port!r}")
        found["port"] = port
    roots = rospy.get_param("~save_roots", None)
    if isinstance(roots, list) and all(isinstance(root, str) for root in roots):
        found["save_roots"] = roots
    return found
