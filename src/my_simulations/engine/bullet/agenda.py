"""Plan in which steps bodies or links are to be checked."""
from __future__ import annotations

from heapq import heappop, heappush
from typing import Dict, Generic, List, Tuple, TypeVar

from .contact_points import LinkKey

FAR = 1 << 30
"""More steps than any run makes in one call."""

Key = TypeVar("Key", int, LinkKey)


class Agenda(Generic[Key]):
    """The step of the next check of each body or link that is to be checked."""

    def __init__(self) -> None:
        self._steps: Dict[Key, int] = {}
        self._heap: List[Tuple[int, Key]] = []   # entries that differ from `_steps` are outdated

    def plan(self, key: Key, step: int) -> None:
        """Plan the check of a body or link in a step, instead of an earlier plan; 0: the next."""
        if self._steps.get(key) != step:
            self._steps[key] = step
            heappush(self._heap, (step, key))

    def pop(self, key: Key, _: None = None) -> None:
        """Cancel the check of a body or link; arguments as of `dict.pop` (`body_tables`)."""
        self._steps.pop(key, None)

    def at(self, key: Key) -> int:
        """Return the step of the next check of a body or link; `FAR` for none."""
        return self._steps.get(key, FAR)

    @property
    def next(self) -> int:
        """The step of the next check; `FAR` for none."""
        heap, steps = self._heap, self._steps
        while heap and steps.get(heap[0][1]) != heap[0][0]:
            heappop(heap)
        return heap[0][0] if heap else FAR

    def take(self, step: int) -> List[Key]:
        """Return the keys to check in this step, sorted, and remove their plans."""
        found: List[Key] = []
        while self.next <= step:
            key = heappop(self._heap)[1]
            del self._steps[key]
            found.append(key)
        return sorted(found)
