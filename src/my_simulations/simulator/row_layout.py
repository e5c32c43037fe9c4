"""Rows of the ring by model and link, for readers of whole snapshots."""
from __future__ import annotations

from bisect import bisect
from dataclasses import dataclass
from typing import List, Optional, Tuple

from ..geometry import IDENTITY, Pose
from .entity import Entity

FrameLocation = Tuple[int, Optional[Pose]]
"""Row of a link and pose of the frame in it, None for identity; row -1: a fixed world pose."""


@dataclass(frozen=True)
class RowLayout:
    """Names and locations of all models, in load order, and of all their links.

    Attributes:
        revision: increases with every change.
        model_names, model_places: parallel lists.
        link_names, link_places: parallel lists; link names are scoped.
    """

    revision: int
    model_names: List[str]
    model_places: List[FrameLocation]
    link_names: List[str]
    link_places: List[FrameLocation]


def layout_of(entities: List[Entity], revision: int) -> RowLayout:
    layout = RowLayout(revision, [], [], [], [])
    for entity in entities:
        name = entity.model.name
        layout.model_names.append(name)
        if entity.link_names:
            offset = None if entity.link_from_model == IDENTITY else entity.link_from_model
            layout.model_places.append((entity.canonical_row, offset))
        else:
            layout.model_places.append((-1, entity.pose))
        for index, link in enumerate(entity.link_names):
            layout.link_names.append(f"{name}::{link}")
            layout.link_places.append((entity.first_link_row + index, None))
    return layout


class RowAllocator:
    """Allocates contiguous rows of a table, first fit. Not thread safe: its owner locks.

    Args:
        size: number of rows.
    """

    def __init__(self, size: int) -> None:
        self._free: List[Tuple[int, int]] = [(0, size)]

    def allocate(self, count: int) -> Optional[int]:
        """The first of `count` contiguous free rows; None if there are none."""
        if count == 0:
            return 0
        for n, (start, length) in enumerate(self._free):
            if length >= count:
                rest = (start + count, length - count)
                self._free[n:n + 1] = [rest] if rest[1] else []
                return start
        return None

    def claim(self, start: int, count: int) -> None:
        """Take `count` free rows from `start` on."""
        for n, (first, length) in enumerate(self._free):
            if count and first <= start and start + count <= first + length:
                around = [(first, start - first), (start + count, first + length - start - count)]
                self._free[n:n + 1] = [part for part in around if part[1]]
                return

    def free(self, start: int, count: int) -> None:
        if count == 0:
            return
        free = self._free
        n = bisect(free, (start, count))
        if n < len(free) and start + count == free[n][0]:
            count += free.pop(n)[1]
        if n and sum(free[n - 1]) == start:
            n -= 1
            start, more = free.pop(n)
            count += more
        free.insert(n, (start, count))
