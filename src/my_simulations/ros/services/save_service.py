"""Service save_world."""
from __future__ import annotations

from typing import Any, List, Optional

import rospy

from ...errors import CommandError
from ...resources.resolver import Resolver
from ...simulator.simulator import Simulator

ROOTS = "~save_roots"
"""Parameter: folders below which worlds may be saved; replaces the default list."""


class SaveService:
    """Saves the running world to a file."""

    def __init__(self, simulator: Simulator, resolver: Resolver, caller: str = "") -> None:
        """`caller`: working directory of the user who started the node; an allowed folder."""
        self._caller = caller
        self._simulator = simulator
        self._resolver = resolver

    def save(self, request: Any, response: Any) -> str:
        """Save the world in its current state.

        Raises CommandError: the path is not allowed or cannot be written.
        """
        # Imported with the first request: start-up time counts.
        from ...simulator.saving import default_roots, save_world

        roots = _roots()
        if roots is None:
            roots = default_roots(self._simulator.world.file, self._caller)
        left_out = [] if request.launched else self._simulator.models.launched()
        response.path = save_world(
            self._simulator, request.path, roots=roots, resolver=self._resolver,
            overwrite=request.overwrite, inline=request.inline, state=request.state,
            launched=request.launched)
        without = (f", without models spawned by the launch file: {', '.join(left_out)}"
                   if left_out else "")
        return f"saved to {response.path}{without}"


def _roots() -> Optional[List[str]]:
    roots = rospy.get_param(ROOTS, None)
    if roots is None:
        return None
    if not isinstance(roots, list) or not all(isinstance(root, str) and root for root in roots):
        raise CommandError(f"parameter {rospy.resolve_name(ROOTS)} must be a list of folders,"
                           f" is {roots!r}")
    return roots
