"""Starts the world editor for the node; the function that does so is passed in by `cli`."""
from __future__ import annotations

import threading
from typing import Any, Callable, Dict, Optional, Protocol, Tuple

import rospy

from ...errors import CommandError, Issue
from ...resources.resolver import Resolver
from ...simulator.simulator import Simulator
from ..issue_logging import log_issue

URL = "~my_simulations/editor_url"
"""Parameter: URL of the editor while it runs; without its token, as others can read it."""


_PROGRESS = ("meshes", "model-download")
"""Codes of the notes about the progress of loading."""


class RunningEditor(Protocol):
    public_url: str

    def stop(self, reason: str = "") -> None:
        """Stop it; `reason` is shown on open pages."""

    def show_issue(self, issue: Issue) -> None:
        """Show an issue."""


class LoadingPage(Protocol):
    """Interface of the page before there is a world."""

    public_url: str

    def show(self, title: str, text: str = "", done: int = 0, of: int = 0) -> None:
        """Show what is under way."""

    def show_line(self, text: str) -> None:
        """Show a line about it."""

    def stop(self) -> None:
        """End it."""


StartEditor = Callable[[Simulator, Resolver, Dict[str, Any], Any], RunningEditor]
"""Starts an editor with settings as in `editor.EditorOptions`, and with the page that was there
before, or None. Raises CommandError."""

AwaitWorld = Callable[[Dict[str, Any]], LoadingPage]
"""Serves the page before there is a world, with such settings. Raises CommandError."""


class EditorLauncher:
    """Starts the editor on first use, with settings from the parameter server.

    Attributes:
        topics: makes what the editor knows of ROS topics (`ros.plugins.topic_graph`).
        plugins: returns the states of the plugins (`plugins.plugin_state`).
        world: what it shows, and what resolves URIs of models; None until they are there.

    Args:
        start: starts it.
        listen: subscribes a function to all issues, including earlier ones.
        caller: working directory of the user who started the node.
    """

    def __init__(self, start: StartEditor, listen: Callable[[Callable[[Issue], None]], None],
                 caller: str = "") -> None:
        self._start = start
        self.world: "Optional[Tuple[Simulator, Resolver]]" = None
        self._loading: Optional[LoadingPage] = None
        self._listen = listen
        self._caller = caller
        self.topics: Callable[[], Any] = lambda: None
        self.plugins: Callable[[], Any] = tuple
        self._lock = threading.Lock()
        self._editor: Optional[RunningEditor] = None
        if rospy.has_param(URL):  # left behind by a node that was killed
            rospy.delete_param(URL)

    @staticmethod
    def wanted() -> bool:
        """Parameter `~gui`: whether to start the editor with the node."""
        return rospy.get_param("~gui", False) is True

    def open_early(self, await_world: AwaitWorld) -> Optional[LoadingPage]:
        """Serve the page before there is a world; None, with a message, where that fails."""
        with self._lock:
            try:
                self._loading = await_world({**_settings(), "log": log_issue})
                self._publish(self._loading.public_url)
            except CommandError as fault:
                rospy.logerr("cannot start the world editor: %s", fault)
            except OSError as fault:
                rospy.logwarn("the ROS master does not respond: %s", fault)
            if self._loading is not None:
                self._listen(self._show_progress)
            return self._loading

    def _show_progress(self, issue: Issue) -> None:
        if self._loading is not None and issue.code in _PROGRESS:
            self._loading.show_line(issue.message)

    def open_in_background(self) -> None:
        """Start it in the background; errors are logged."""
        threading.Thread(target=self._try, name="editor start", daemon=True).start()

    def open(self) -> str:
        """Start the editor unless it runs; returns its public URL. Raises CommandError."""
        with self._lock:
            if self._editor is None:
                if self.world is None:
                    raise CommandError("the world is still being loaded")
                early, self._loading = self._loading, None
                self._editor = self._start(*self.world, {
                    **_settings(), "log": log_issue, "caller": self._caller,
                    "topics": self.topics(), "plugins": self.plugins}, early)
                self._listen(self._editor.show_issue)
                if early is None:
                    self._publish(self._editor.public_url)
            return self._editor.public_url

    def _publish(self, url: str) -> None:
        rospy.set_param(URL, url)
        rospy.loginfo("the world editor is at %s (gzclient opens it)", url)

    def announce(self) -> None:
        """Set the parameter with its URL again, if it runs."""
        with self._lock:
            if self._editor is not None:
                rospy.set_param(URL, self._editor.public_url)

    def close(self) -> None:
        with self._lock:
            if self._loading is not None:
                self._loading.stop()
            if self._editor is not None:
                self._editor.stop("the simulator is shutting down")
            if self._editor is not None or self._loading is not None:
                self._editor = self._loading = None
                try:
                    rospy.delete_param(URL)
                except (OSError, KeyError):
                    return  # the master is gone, too

    def _try(self) -> None:
        try:
            self.open()
        except CommandError as fault:
            rospy.logerr("cannot start the world editor: %s", fault)
        except OSError as fault:
            rospy.logwarn("the ROS master does not respond: %s", fault)


def _settings() -> Dict[str, Any]:
    """Settings from `~editor_…` and `~save_roots`. Raises CommandError."""
    found: Dict[str, Any] = {}
    host = rospy.get_param("~editor_host", "")
    if host:
        found["host"] = str(host)
    port = rospy.get_param("~editor_port", None)
    if port is not None:
        if isinstance(port, bool) or not isinstance(port, int) or not 0 <= port < 65536:
            raise CommandError(f"parameter {rospy.resolve_name('~editor_port')} must be a port"
                               f" number (0 for any free port), is {port!r}")
        found["port"] = port
    token = rospy.get_param("~editor_token", True)
    if not isinstance(token, bool):
        raise CommandError(f"parameter {rospy.resolve_name('~editor_token')} must be true or false"
                           ": whether the editor asks for a token")
    if not token:
        found["token"] = ""
    roots = rospy.get_param("~save_roots", None)
    if isinstance(roots, list) and all(isinstance(root, str) for root in roots):
        found["save_roots"] = roots
    return found
