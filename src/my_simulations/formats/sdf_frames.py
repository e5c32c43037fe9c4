"""Poses given in the frame of something else (`pose@relative_to`), brought to the model frame.

Source: SDF spec 1.7, pose frame semantics: `relative_to` names a sibling link, joint, frame or
nested model; without it a pose is in the frame of its parent element, a joint's in its child link.
"""
from __future__ import annotations

from typing import Any, Dict, List, NamedTuple

from ..geometry import IDENTITY, Pose, compose


class Placed(NamedTuple):
    """A named frame: its pose in the frame called `relative_to`."""

    pose: Pose
    relative_to: str
    element: Any


class FrameFault(Exception):
    """A frame that does not exist, or that is defined by itself."""


class FrameTree:
    """The frames of one model (or world); `root` names the frame of the whole."""

    def __init__(self, root: str) -> None:
        self.root = root
        self._placed: Dict[str, Placed] = {}
        self._known: Dict[str, Pose] = {root: IDENTITY}

    def add(self, name: str, pose: Pose, relative_to: str, element: Any) -> None:
        """Declare a frame; the first of two with one name stays."""
        self._placed.setdefault(name, Placed(pose, relative_to or self.root, element))

    def pose(self, name: str) -> Pose:
        """The pose of a frame in the root frame.

        Raises:
            FrameFault: unknown name, or a cycle.
        """
        chain: List[str] = []
        while name not in self._known:
            if name in chain:
                raise FrameFault(f"the frames {', '.join(map(repr, chain))} refer to each other")
            if name not in self._placed:
                raise FrameFault(f"there is no frame {name!r}")
            chain.append(name)
            name = self._placed[name].relative_to
        for inner in reversed(chain):
            placed = self._placed[inner]
            self._known[inner] = compose(self._known[placed.relative_to], placed.pose)
        return self._known[chain[0] if chain else name]
