"""Shows a world in a page of the editor, which cannot change it, at the pace of real time."""
from __future__ import annotations

import time
from typing import TYPE_CHECKING, Optional

import gymnasium

from ..python_api import OpenWorld
from ..resources.resolver import Resolver

if TYPE_CHECKING:
    from ..editor.server import EditorServer


class Viewer:
    """The page of one environment.

    Attributes:
        url: address of the page, with its token; "" before `show`.
    """

    def __init__(self) -> None:
        self.url = ""
        self._server: "Optional[EditorServer]" = None
        self._shown: object = None
        self._due = 0.0  # monotonic time of the end of the running step, s

    def show(self, world: OpenWorld) -> None:
        """Serve the page of a world, and open it in a browser if there is a display.

        Raises gymnasium.error.DependencyNotInstalled without the packages of the editor.
        """
        self._due = time.monotonic()
        if self._shown is world.simulator:
            return
        self.close()
        try:
            from ..editor.editor_options import EditorOptions
            from ..editor.server import EditorServer
            from ..editor.web_browser import show
        except ImportError as fault:
            raise gymnasium.error.DependencyNotInstalled(
                f"render_mode 'human' needs pip install my_simulations[editor] ({fault})"
            ) from fault
        self._server = EditorServer(world.simulator, Resolver.from_environment(),
                                    EditorOptions(read_only=True))
        self._shown = world.simulator
        self.url = self._server.url
        show(self.url, "gymnasium")

    def wait_for_real_time(self, period: float) -> None:
        """Wait until a step of `period` s may end; time that was lost is not made up for."""
        self._due = max(self._due + period, time.monotonic())
        time.sleep(max(0.0, self._due - time.monotonic()))

    def close(self) -> None:
        """End the server of the page."""
        if self._server is not None:
            self._server.stop("the environment is closed")
            self._server = None
        self._shown = None
