"""The editor's server: a page in the browser that shows the running world and changes it.

Nothing of it is imported before somebody wants an editor; `start` does.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Optional

from .editor_options import EditorOptions

if TYPE_CHECKING:
    from ..resources.resolver import Resolver
    from ..simulator.simulator import Simulator
    from .server import EditorServer

__all__ = ["EditorOptions", "start"]


def start(simulator: "Simulator", resolver: "Resolver",
          options: Optional[EditorOptions] = None) -> "EditorServer":
    """Serve the editor of a simulator from a thread of its own; returns once it listens.

    Raises:
        CommandError: the address cannot be listened at, or the page is not installed.
    """
    from .server import EditorServer

    return EditorServer(simulator, resolver, options or EditorOptions())
