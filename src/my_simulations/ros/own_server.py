"""How a client tells our server from Gazebo's."""
from __future__ import annotations

from typing import Any, Callable

VERSION = "my_simulations/version"
"""Parameter below the node's name that only our server has."""

EDITOR_REQUESTED = "my_simulations/editor_requested"
"""Parameter by which a client requests the editor of a server without the service open_editor."""


def spawns_objects(get: Callable[[str], Any], node: str) -> bool:
    """Whether a node offers `spawn_object`: it is ours, and its extensions are on.

    Args:
        get: reads a parameter; None if it is not set.
        node: full name of the node.
    """
    base = node.rstrip("/")
    return get(f"{base}/{VERSION}") is not None and get(f"{base}/extensions") is not False
