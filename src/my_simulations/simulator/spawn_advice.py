"""Warnings about a model that was just spawned."""
from __future__ import annotations

from dataclasses import replace
from typing import List, Optional

from ..description.shapes import MeshTable
from ..errors import Issue
from ..formats.loading_advice import advice_issues
from .registry import UnknownEntityError
from .simulator import Simulator

NEIGHBOURS = 64
"""Most models for which overlaps are checked, so that spawning stays fast."""


def arrival_advice(simulator: Simulator, name: str, meshes: Optional[MeshTable]) -> List[Issue]:
    """Warnings about implausible inertia, thin shapes, and overlaps with other models."""
    if len(simulator.models.names()) > NEIGHBOURS:
        try:
            models = [replace(simulator.models.get(name),
                              pose=simulator.states.model_state(name)[0])]
        except UnknownEntityError:
            return []  # it was deleted meanwhile
    else:
        entities, snapshot = simulator.states.latest()
        models = [replace(entity.model, pose=entity.state(snapshot)[0]) for entity in entities]
    return advice_issues(models, {name: meshes or {}}, only=name)
