"""Positions in the order of models and lights, for entities that are deleted and restored."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Sequence


@dataclass(frozen=True)
class OrderSlot:
    """A position in an order: after the entity `behind`, or at `index` if that is gone.

    A neighbour stays valid when other entities are added or deleted meanwhile.

    Attributes:
        index: position, from 0.
        behind: name of the entity before it; "" for none.
    """

    index: int
    behind: str

    @classmethod
    def of(cls, names: Sequence[str], name: str) -> "OrderSlot":
        index = names.index(name)
        return cls(index, names[index - 1] if index else "")

    def among(self, names: Sequence[str]) -> int:
        """The index at which to insert it into `names`."""
        if self.behind in names:
            return names.index(self.behind) + 1
        return min(self.index, len(names))
