"""Reads single values of an assignment file; faults have codes of assignments."""
from __future__ import annotations

import os
from typing import Any, Sequence

from ..objects.yaml_source import KeyPath
from ..studies.value_reader import ValueReader


class AssignmentValues(ValueReader):
    """Reads values of an assignment."""

    def fault(self, path: Sequence[str], message: str, hint: str = "",
              code: str = "grade-value") -> None:
        """Note a fault of an assignment; codes of studies become those of assignments."""
        super().fault(path, message, hint, code.replace("study-", "grade-"))

    def line_of(self, path: KeyPath) -> int:
        """The line of a key or an item of a list; 0 if unknown."""
        return self._source.lines.get(path, 0)

    def file(self, value: Any, path: KeyPath) -> str:
        """The absolute path of a file; relative ones start at the folder of the assignment."""
        name = self.text(value, path)
        found = os.path.abspath(os.path.join(self._folder, os.path.expanduser(name)))
        if name and not os.path.isfile(found):
            self.fault(path, f"there is no file {found}",
                       "paths start at the folder of the assignment", "file-not-found")
        return found
