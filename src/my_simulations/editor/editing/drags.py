"""Bodies that somebody drags with the mouse: held, at rest, moved live; not yet a step of undo."""
from __future__ import annotations

from typing import Dict, List

from ...description.scoped_names import split_scoped
from ...errors import CommandError
from ...geometry import Pose, normalised, pose_is_finite
from ...simulator.operations import place, pose_of
from ...simulator.simulator import Simulator


class Drags:
    """Who drags what, and where it was before. For one thread at a time."""

    def __init__(self, simulator: Simulator) -> None:
        self._world = simulator
        self._before: Dict[int, Dict[str, Pose]] = {}

    def drag(self, client: int, poses: Dict[str, Pose]) -> None:
        """Move things that a client drags; what has gone meanwhile is let go of."""
        mine = self._before.setdefault(client, {})
        fresh = [name for name in poses if name not in mine]
        for name in fresh:
            try:
                mine[name] = pose_of(self._world, name)
            except CommandError:
                continue
        if fresh:
            self._hold()
        for name, pose in poses.items():
            if name not in mine or not pose_is_finite(pose):
                continue
            try:
                place(self._world, name, Pose(pose.position, normalised(pose.orientation)))
            except CommandError:
                mine.pop(name)

    def taken(self, names: List[str]) -> Dict[str, Pose]:
        """Where these were before they were dragged, as far as they are."""
        return {name: before[name] for before in self._before.values()
                for name in names if name in before}

    def moved(self, names: List[str]) -> None:
        """A move has ended the drags of these; they are let go of."""
        for before in self._before.values():
            for name in names:
                before.pop(name, None)
        self._hold()

    def end(self, client: int) -> None:
        """A client drags nothing any more; what it has not put down goes back."""
        before = self._before.pop(client, {})
        for name, pose in before.items():
            try:
                place(self._world, name, pose)
            except CommandError:
                continue
        if before:
            self._hold()

    def _hold(self) -> None:
        names = {split_scoped(name, self._world.models.has)[0]
                 for before in self._before.values() for name in before}
        self._world.models.pin(sorted(names - {""}))
