"""Make and remove all constraints of Bullet.

PyBullet 3.2 has a fault: when it removes a constraint of a multibody, it also frees the last
constraint of its table if that one is between two rigid bodies (it reads the slot into which the
last one was moved). The next use of the freed constraint crashes the process. So constraints
between rigid bodies are removed first, and made again afterwards.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Dict, Iterable, Mapping, Tuple

import pybullet

Number = int
"""The number of a constraint in the book; its PyBullet number can change."""


@dataclass
class _Entry:
    uid: int
    is_rigid: bool
    made_with: Tuple[Any, ...]
    changed_to: Mapping[str, Any]

    def make(self) -> None:
        """Create the constraint in PyBullet."""
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
            made_with: the arguments of pybullet.createConstraint.
            changed_to: the keyword arguments of pybullet.changeConstraint.
        """
        entry = _Entry(-1, is_rigid, made_with, changed_to)
        entry.make()
        self._next += 1
        self._entries[self._next] = entry
        return self._next

    def remove(self, numbers: Iterable[Number]) -> None:
        """Remove constraints; their bodies must still exist."""
        going = [self._entries.pop(number) for number in numbers]
        lifted = [] if all(one.is_rigid for one in going) else [
            one for one in self._entries.values() if one.is_rigid]
        for one in (*lifted, *sorted(going, key=lambda entry: not entry.is_rigid)):
            pybullet.removeConstraint(one.uid)
        for one in lifted:
            one.make()
