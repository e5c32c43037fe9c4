"""Which rows of the ring belong to whom, for who copies whole snapshots many times a second."""
from __future__ import annotations

from dataclasses import dataclass
from typing import List, Optional, Tuple

from ..geometry import IDENTITY, Pose
from .registry import Entity

Place = Tuple[int, Optional[Pose]]
"""A link's row and the frame in that link, None for the link's own; row -1: a world pose."""


@dataclass(frozen=True)
class Layout:
    """Names and places, all models in load order and all their links; see `States`.

    Attributes:
        revision: grows when anything of this changes.
        model_names, model_places: parallel.
        link_names, link_places: parallel.
    """

    revision: int
    model_names: List[str]
    model_places: List[Place]
    link_names: List[str]
    link_places: List[Place]


def lay_out(entities: List[Entity], revision: int) -> Layout:
    """The layout of these entities."""
    layout = Layout(revision, [], [], [], [])
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
