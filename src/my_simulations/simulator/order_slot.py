"""Places in an order of names, for what goes and comes back."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Sequence


@dataclass(frozen=True)
class OrderSlot:
    """A place in an order: behind a neighbour, "" for none, or at `index` when that has gone.

    A neighbour says it better than a number does when others came or went meanwhile.
    """

    index: int
    behind: str

    @classmethod
    def of(cls, names: Sequence[str], name: str) -> "OrderSlot":
        """The place of a name that is among `names`."""
        index = names.index(name)
        return cls(index, names[index - 1] if index else "")

    def among(self, names: Sequence[str]) -> int:
        """The index at which it belongs into `names`, where it is not."""
        if self.behind in names:
            return names.index(self.behind) + 1
        return min(self.index, len(names))
