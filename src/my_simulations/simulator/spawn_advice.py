"""Warnings about a model that was just spawned."""
from __future__ import annotations

from dataclasses import replace
from typing import List, Optional

from ..description.model import Model
from ..description.shapes import MeshTable
from ..engine.ring import Snapshot
from ..errors import Issue
from ..formats.loading_advice import advice_issues
from ..geometry import IDENTITY
from .registry import Entity
from .simulator import Simulator

NEIGHBOURS = 64
"""Most models for which overlaps are checked, so that spawning stays fast."""


def _as_it_stands(entity: Entity, snapshot: Snapshot) -> Model:
    """The model with its links where they are: joints may have been put elsewhere, or have moved
    since, and of a robot that has folded its legs only the base is lower.
    """
    links = [replace(link, pose=snapshot.link(entity.first_link_row + n)[0])
             for n, link in enumerate(entity.model.links)]
    return replace(entity.model, pose=IDENTITY, links=links)


def arrival_advice(simulator: Simulator, name: str, meshes: Optional[MeshTable]) -> List[Issue]:
    """Warnings about implausible inertia, thin shapes, and overlaps with other models."""
    entities, snapshot = simulator.states.latest()
    if len(entities) > NEIGHBOURS:
        entities = [entity for entity in entities if entity.model.name == name]
    models = [_as_it_stands(entity, snapshot) for entity in entities]
    return advice_issues(models, {name: meshes or {}}, only=name)
