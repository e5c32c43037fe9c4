"""Makes the shapes of models that will be loaded, a few at a time between steps."""
from __future__ import annotations

import time
from typing import Dict, Iterator

from ..commands import ContinuePreparation, PrepareModel
from .collision_shapes import ShapeError, ShapeFactory

_SLICE_S = 0.05
"""Shapes are made until this time is over; a large one may take longer."""


class ShapePreparation:
    """The preparations under way, by their numbers.

    A shape that cannot be made ends its preparation; the load of the model reports it.
    """

    def __init__(self, shapes: ShapeFactory) -> None:
        self._shapes = shapes
        self._under_way: Dict[int, Iterator[None]] = {}

    def begin(self, command: PrepareModel) -> bool:
        """Begin with a model; returns whether there is more to do."""
        self._under_way[command.number] = self._shapes.prepare(command.model, command.meshes)
        return True

    def advance(self, command: ContinuePreparation) -> bool:
        """Make shapes for a while; returns whether there is more to do."""
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
