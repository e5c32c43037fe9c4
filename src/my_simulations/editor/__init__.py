"""The editor's server: a page in the browser that shows the running world and changes it.

Its modules are imported by `start`, when an editor is requested.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Optional

from .editor_options import EditorOptions

if TYPE_CHECKING:
    from ..resources.resolver import Resolver
    from ..simulator.simulator import Simulator
    from .loading_server import LoadingServer
    from .server import EditorServer

__all__ = ["EditorOptions", "start", "start_loading"]


def start(simulator: "Simulator", resolver: "Resolver",
          options: Optional[EditorOptions] = None,
          loading: "Optional[LoadingServer]" = None) -> "EditorServer":
    """Serve the editor of a simulator from a thread of its own; returns once it listens.

    With `loading`, it takes over the address and the pages of that server. Raises CommandError: the
    address cannot be listened at, or the page is not installed.
    """
    from .server import EditorServer

    return EditorServer(simulator, resolver, options or EditorOptions(), loading)


def start_loading(options: Optional[EditorOptions] = None) -> "LoadingServer":
    """Serve the page before there is a world; it shows what is under way.

    Raises CommandError: the address cannot be listened at, or the page is not installed.
    """
    from .loading_server import LoadingServer

    return LoadingServer(options or EditorOptions())
