"""Reads single values of an assignment file; faults have codes of assignments."""
from __future__ import annotations

from typing import Sequence

from ..errors import warning
from ..objects.yaml_source import KeyPath
from ..studies.value_reader import ValueReader


class AssignmentValues(ValueReader):
    """Reads values of an assignment."""

    document = "assignment"

    def fault(self, path: Sequence[str], message: str, hint: str = "",
              code: str = "grade-value") -> None:
        """Note a fault of an assignment; codes of studies become those of assignments."""
        super().fault(path, message, hint, code.replace("study-", "grade-"))

    def advise(self, path: KeyPath, message: str, hint: str, code: str) -> None:
        """Note a warning about the value at a path of keys."""
        self.issues.append(warning(code, message, hint=hint, **self._source.where(path)))

    def line_of(self, path: KeyPath) -> int:
        """The line of a key or an item of a list; 0 if unknown."""
        return self._source.lines.get(path, 0)
