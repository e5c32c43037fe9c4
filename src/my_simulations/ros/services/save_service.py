"""The service that saves the running world."""
from __future__ import annotations

from typing import Any, List, Optional

import rospy

from ...errors import CommandError
from ...resources.resolver import Resolver
from ...simulator.simulator import Simulator

ROOTS = "~save_roots"
"""Parameter: a list of the folders below which worlds may be saved, instead of the usual ones."""


class SaveService:
    """save_world."""

    def __init__(self, simulator: Simulator, resolver: Resolver, caller: str = "") -> None:
        """`caller`: folder in which the command was typed; worlds may be saved there."""
        self._caller = caller
        self._simulator = simulator
        self._resolver = resolver

    def save(self, request: Any, response: Any) -> str:
        """The world as it is now, to a file."""
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
        without = (f" without {', '.join(left_out)}, which the launch file spawns"
                   if left_out else "")
        return f"saved to {response.path}{without}"


def _roots() -> Optional[List[str]]:
    roots = rospy.get_param(ROOTS, None)
    if roots is None:
        return None
    if not isinstance(roots, list) or not all(isinstance(root, str) and root for root in roots):
        raise CommandError(f"the parameter {rospy.resolve_name(ROOTS)} must be a list of folders,"
                           f" it is {roots!r}")
    return roots
