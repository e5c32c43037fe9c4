"""Resolves poses in named frames (`pose@relative_to`) to the model frame.

Source: SDF spec 1.7, pose frame semantics: `relative_to` names a sibling link, joint, frame or
nested model; without it a pose is in the frame of its parent element, a joint's in its child link.
A frame moves with the link it is attached to, directly or through other frames.
"""
from __future__ import annotations

from typing import Any, Dict, Iterator, List, NamedTuple, Optional, Tuple

from ...errors import SimulationError
from ...geometry import IDENTITY, Pose, compose


class Placed(NamedTuple):
    """A named frame: its pose in the frame `relative_to`, and the frame it is attached to."""

    pose: Pose
    relative_to: str
    element: Any
    attached_to: str


class FrameError(SimulationError):
    """A frame that does not exist, or whose definition is circular."""


class FrameTree:
    """The frames of one model (or world).

    Attributes:
        root: name of the root frame.
        body: link that the root frame is attached to; "" for none.
    """

    def __init__(self, root: str) -> None:
        self.root = root
        self.body = ""
        self._placed: Dict[str, Placed] = {}
        self._known: Dict[str, Pose] = {root: IDENTITY}

    def __contains__(self, name: str) -> bool:
        return name == self.root or name in self._placed

    def add(self, name: str, pose: Pose, relative_to: str, element: Any,
            attached_to: str = "") -> None:
        """Declare a frame; the first of two with one name is kept. A link is attached to itself."""
        if name not in self._placed:
            self._placed[name] = Placed(pose, relative_to or self.root, element,
                                        attached_to or self.root)

    def include(self, scope: str, inner: "FrameTree", element: Any) -> None:
        """Declare the frames of a nested model, scoped by `scope`, the name of its model frame."""
        self.add(f"{scope}::{inner.root}", IDENTITY, scope, element, scope)
        for name, pose, body in inner._iterate_resolved():
            self.add(f"{scope}::{name}", pose, scope, element, f"{scope}::{body}")

    def merge(self, base: str, inner: "FrameTree", element: Any) -> None:
        """Declare the frames of a merged model under their own names; its model frame is `base`."""
        for name, pose, body in inner._iterate_resolved():
            self.add(name, pose, base, element, body)

    def _iterate_resolved(self) -> Iterator[Tuple[str, Pose, str]]:
        """(name, pose in the root frame, link) of all frames without a fault."""
        for name in self._placed:
            try:
                yield name, self.pose(name), self.body_of(name)
            except FrameError:
                continue  # reported by its own model

    def pose(self, name: str) -> Pose:
        """The pose of a frame in the root frame. Raises FrameError: unknown name, or a cycle."""
        chain: List[str] = []
        while name not in self._known:
            placed = self._step(name, chain)
            chain.append(name)
            name = placed.relative_to
        for inner in reversed(chain):
            placed = self._placed[inner]
            self._known[inner] = compose(self._known[placed.relative_to], placed.pose)
        return self._known[chain[0] if chain else name]

    def body_of(self, name: str) -> str:
        """The link a frame moves with; "" if the root frame has none.

        Raises FrameError: unknown name, or a cycle.
        """
        chain: List[str] = []
        while name != self.root:
            placed = self._step(name, chain)
            if placed.attached_to == name:
                return name
            chain.append(name)
            name = placed.attached_to
        return self.body

    def _step(self, name: str, chain: List[str]) -> Placed:
        placed: Optional[Placed] = self._placed.get(name)
        if name in chain:
            raise FrameError(f"the frames {', '.join(map(repr, chain))} refer to each other")
        if placed is None:
            raise FrameError(f"there is no frame {name!r}")
        return placed
