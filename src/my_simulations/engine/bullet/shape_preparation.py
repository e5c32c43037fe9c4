"""Make the shapes of models that will be loaded, a few at a time between steps."""
from __future__ import annotations

import time
from typing import Dict, Iterator

from ..commands import ContinuePreparation, PrepareModel
from .collision_shapes import ShapeError, ShapeFactory

_SLICE_S = 0.05
"""Wall seconds for which shapes are made between two steps; a large shape may take longer."""


class ShapePreparation:
    """Makes shapes of models step by step; each preparation has a number.

    A shape that cannot be made ends its preparation; the load of the model reports it.
    """

    def __init__(self, shapes: ShapeFactory) -> None:
        self._shapes = shapes
        self._under_way: Dict[int, Iterator[None]] = {}

    def begin(self, command: PrepareModel) -> bool:
        """Begin the preparation of a model; returns True, as shapes remain to be made."""
        self._under_way[command.number] = self._shapes.prepare(command.model, command.meshes)
        return True

    def advance(self, command: ContinuePreparation) -> bool:
        """Make shapes for `_SLICE_S`; returns whether shapes remain to be made."""
        steps = self._under_way.get(command.number)
        if steps is None:
            return False
        until = time.perf_counter() + _SLICE_S
        try:
            while time.perf_counter() < until:
                next(steps)
            return True
        except (StopIteration, ShapeError):
            del self._under_way[command.number]
            return False
