"""Bullet's constraints: the one place that makes them and takes them out.

To take out one of a multibody, PyBullet 3.2 frees the last constraint of its table as well if that
one is between two rigid bodies (it looks at the place into which the last one was moved). The
next use of that one ends the process. So those between rigid bodies are lifted meanwhile.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Dict, Iterable, Mapping, Tuple

import pybullet

Number = int
"""Of a constraint in the book; PyBullet's own may change."""


@dataclass
class _Entry:
    uid: int
    is_rigid: bool
    made_with: Tuple[Any, ...]
    changed_to: Mapping[str, Any]

    def make(self) -> None:
        """Put it into the world."""
        self.uid = int(pybullet.createConstraint(*self.made_with))
        pybullet.changeConstraint(self.uid, **self.changed_to)


class ConstraintBook:
    """All constraints of a world."""

    def __init__(self) -> None:
        self._entries: Dict[Number, _Entry] = {}
        self._next = 0

    def make(self, is_rigid: bool, made_with: Tuple[Any, ...], **changed_to: Any) -> Number:
        """Make a constraint.

        Args:
            is_rigid: whether both bodies are rigid ones.
            made_with: what pybullet.createConstraint takes, in order.
            changed_to: what pybullet.changeConstraint takes.
        """
        entry = _Entry(-1, is_rigid, made_with, changed_to)
        entry.make()
        self._next += 1
        self._entries[self._next] = entry
        return self._next

    def remove(self, numbers: Iterable[Number]) -> None:
        """Take constraints out; the bodies must still be there."""
        going = [self._entries.pop(number) for number in numbers]
        lifted = [] if all(one.is_rigid for one in going) else [
            one for one in self._entries.values() if one.is_rigid]
        for one in (*lifted, *sorted(going, key=lambda entry: not entry.is_rigid)):
            pybullet.removeConstraint(one.uid)
        for one in lifted:
            one.make()

    def clear(self) -> None:
        """The world was emptied."""
        self._entries.clear()
