"""Undo and redo: labels of the operations done, each with its inverse."""
from __future__ import annotations

import threading
from dataclasses import dataclass
from typing import List, Optional

from ..errors import CommandError
from .operations import Operation
from .registry import UnknownEntityError
from .simulator import Simulator

LONGEST = 500
"""Most steps that can be undone."""


@dataclass(frozen=True)
class Step:
    """One entry.

    Attributes:
        label: text for the history menu.
        inverse: operation that undoes it.
        number: unique id.
        author: the user; "" if it is unknown.
    """

    label: str
    inverse: Operation
    number: int
    author: str = ""


class History:
    """Operations carried out on one world through `do`. Safe from any thread.

    Reads are answered while an operation is carried out, and show the state before it.
    """

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator
        self._operating = threading.RLock()  # held while an operation is carried out
        self._lock = threading.RLock()       # held for a moment, after `_operating` if both are
        self._done: List[Step] = []
        self._undone: List[Step] = []
        self._number = 0
        self._saved: Optional[int] = 0
        self._base = 0  # number of the newest step that was forgotten
        self._forgotten = 0

    @property
    def undo_labels(self) -> List[str]:
        """Labels of steps that can be undone, newest first."""
        with self._lock:
            return [step.label for step in reversed(self._done)]

    @property
    def redo_labels(self) -> List[str]:
        """Labels of steps that can be redone, next first."""
        with self._lock:
            return [step.label for step in reversed(self._undone)]

    @property
    def undo_authors(self) -> List[str]:
        """Authors of the steps that can be undone, newest first."""
        with self._lock:
            return [step.author for step in reversed(self._done)]

    @property
    def redo_authors(self) -> List[str]:
        """Authors of the steps that can be redone, next first."""
        with self._lock:
            return [step.author for step in reversed(self._undone)]

    @property
    def dirty(self) -> bool:
        """Whether the world was edited since it was loaded or saved."""
        with self._lock:
            return self._top != self._saved

    @property
    def state(self) -> int:
        """Id of the current state of editing."""
        with self._lock:
            return self._top

    @property
    def depth(self) -> int:
        """Steps between the world as it was loaded and now, forgotten ones too."""
        with self._lock:
            return self._forgotten + len(self._done)

    @property
    def _top(self) -> int:
        return self._done[-1].number if self._done else self._base

    def do(self, label: str, operation: Operation, author: str = "") -> None:
        """Carry out an operation and record it, with its author; clears the steps to redo.

        Raises CommandError; then nothing has changed.
        """
        with self._operating:
            inverse = operation.apply(self._simulator)
            with self._lock:
                self._number += 1
                self._done.append(Step(label, inverse, self._number, author))
                self._undone.clear()
                if len(self._done) > LONGEST:
                    self._base = self._done.pop(0).number
                    self._forgotten += 1
                    if self._saved is not None and self._saved < self._base:
                        self._saved = None  # cannot be reached any more

    def undo(self, to: int = 0) -> str:
        """Undo the newest step, or all down to the `to`-th newest; returns its label.

        Raises CommandError: nothing to undo, the engine refused the step, or an entity that the
        step needs was deleted; only such a step is dropped.
        """
        return self._move(self._done, self._undone, to, "undo")

    def redo(self, to: int = 0) -> str:
        """Redo the step undone last, or all up to the `to`-th. Raises CommandError."""
        return self._move(self._undone, self._done, to, "redo")

    def mark_saved(self) -> None:
        """Record that the current state was saved to a file."""
        with self._lock:
            self._saved = self._top

    def clear(self, dirty: bool = False) -> None:
        """Forget all steps, for another world."""
        with self._operating, self._lock:
            self._done.clear()
            self._undone.clear()
            self._base = self._forgotten = 0
            self._saved = None if dirty else 0

    def _move(self, source: List[Step], target: List[Step], to: int, verb: str) -> str:
        with self._operating:
            if not 0 <= to < len(source):
                raise CommandError(f"nothing to {verb}")
            for _ in range(to + 1):
                step = source[-1]
                try:
                    inverse = step.inverse.apply(self._simulator)
                except CommandError as fault:
                    if isinstance(fault, UnknownEntityError):
                        with self._lock:
                            source.pop()
                    raise CommandError(f"cannot {verb} {step.label!r}: {fault}") from fault
                with self._lock:
                    source.pop()
                    target.append(Step(step.label, inverse, step.number, step.author))
            return step.label
