"""What is to be said about a model that has just been put into a running world."""
from __future__ import annotations

from dataclasses import replace
from typing import List, Optional

from ..description.shapes import MeshTable
from ..errors import Issue
from ..formats.loading_advice import advice_issues
from .registry import UnknownEntityError
from .simulator import Simulator

NEIGHBOURS = 64
"""In a world of more models the others are not looked at: a request is not held up for advice."""


def arrival_advice(simulator: Simulator, name: str, meshes: Optional[MeshTable]) -> List[Issue]:
    """Warnings about odd inertia, shapes without thickness, and what it stands inside of."""
    if len(simulator.models.names()) > NEIGHBOURS:
        try:
            models = [replace(simulator.models.get(name),
                              pose=simulator.states.model_state(name)[0])]
        except UnknownEntityError:
            return []  # somebody has taken it out meanwhile
    else:
        entities, snapshot = simulator.states.latest()
        models = [replace(entity.model, pose=entity.state(snapshot)[0]) for entity in entities]
    return advice_issues(models, {name: meshes or {}}, only=name)
