"""Bodies that users drag with the mouse: held at rest, moved live; not yet a step of undo."""
from __future__ import annotations

from typing import Dict, List

from ...description.scoped_names import split_scoped
from ...errors import CommandError
from ...geometry import Pose, normalised, pose_is_finite
from ...simulator.operations import move_entity, pose_of
from ...simulator.simulator import Simulator


class Drags:
    """Who drags what, and where it was before. For one thread at a time.

    Two may hold the same body: it is where the last of them moved it, and stays where the last one
    releases it.
    """

    def __init__(self, simulator: Simulator) -> None:
        self._world = simulator
        self._before: Dict[int, Dict[str, Pose]] = {}

    def drag(self, client: int, poses: Dict[str, Pose]) -> List[str]:
        """Move things that a client drags; what has gone meanwhile is let go of.

        Returns what the client has just taken hold of.
        """
        mine = self._before.setdefault(client, {})
        fresh = [name for name in poses if name not in mine]
        for name in fresh:
            try:
                mine[name] = pose_of(self._world, name)
            except CommandError:
                continue
        if fresh:
            self._pin_dragged()
        for name, pose in poses.items():
            if name not in mine or not pose_is_finite(pose):
                continue
            try:
                move_entity(self._world, name, Pose(pose.position, normalised(pose.orientation)))
            except CommandError:
                mine.pop(name)
        return [name for name in fresh if name in mine]

    def dragged(self) -> Dict[int, List[str]]:
        """Names of what is dragged, by client."""
        return {client: sorted(before) for client, before in self._before.items() if before}

    def others(self, client: int, names: List[str]) -> Dict[int, List[str]]:
        """Return the entities among `names` that other clients drag, by client."""
        return {other: shared for other, held in self.dragged().items()
                for shared in [[name for name in names if name in held]]
                if shared and other != client}

    def start_poses(self, client: int, names: List[str]) -> Dict[str, Pose]:
        """Where these were before the client dragged them, as far as it does."""
        mine = self._before.get(client, {})
        return {name: mine[name] for name in names if name in mine}

    def moved(self, client: int, names: List[str]) -> None:
        """End the client's drags of these names after a move; those of others start again."""
        for other, before in self._before.items():
            for name in names:
                if name not in before:
                    continue
                if other == client:
                    before.pop(name)
                    continue
                try:
                    before[name] = pose_of(self._world, name)
                except CommandError:
                    before.pop(name)
        self._pin_dragged()

    def remove_deleted(self) -> Dict[int, List[str]]:
        """Return and forget the dragged names that no longer exist, by client."""
        lost: Dict[int, List[str]] = {}
        for client, before in self._before.items():
            for name in list(before):
                try:
                    pose_of(self._world, name)
                except CommandError:
                    before.pop(name)
                    lost.setdefault(client, []).append(name)
        return lost

    def end(self, client: int) -> None:
        """End all drags of a client; bodies that it has not dropped return to where they were."""
        before = self._before.pop(client, {})
        for name, pose in before.items():
            if self.others(client, [name]):
                continue  # another hand is on it
            try:
                move_entity(self._world, name, pose)
            except CommandError:
                continue
        if before:
            self._pin_dragged()

    def clear(self) -> None:
        """End all drags where the bodies are: another world was opened."""
        self._before.clear()
        self._pin_dragged()

    def _pin_dragged(self) -> None:
        names = {split_scoped(name, self._world.models.has)[0]
                 for before in self._before.values() for name in before}
        self._world.models.pin(sorted(names - {""}))
