"""What connects and pins the models of a world."""
from __future__ import annotations

from dataclasses import dataclass
from typing import List, Tuple

from ..engine.commands import Command, PinModels
from .inter_model_joints import InterModelJoints
from .registry import Registry


@dataclass(frozen=True)
class ModelLinks:
    """Joints between models, and the models that are pinned.

    Attributes:
        between: the joints.
        attached: the names of those that `Models.attach` made.
        pinned, held: names of models, see `Models.pin` and `Models.hold`.
    """

    between: InterModelJoints
    attached: Tuple[str, ...]
    pinned: Tuple[str, ...]
    held: Tuple[str, ...]

    def commands(self, registry: Registry) -> List[Command]:
        """Commands that make the joints and pins in an engine that has loaded the models."""
        commands: List[Command] = list(self.between.commands(registry))
        pinned = dict.fromkeys((*self.pinned, *self.held))
        if pinned:
            commands.append(PinModels(tuple(registry.model(name).model_id for name in pinned
                                            if name in registry)))
        return commands
