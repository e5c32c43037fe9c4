"""Rows of the ring by model and link, for readers of whole snapshots."""
from __future__ import annotations

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
