"""Pieces of a mesh file, and what can be wrong with one."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Iterator, List, Tuple

from ...errors import SimulationError

MOST_TRIANGLES = 10_000_000
"""Of a file, what it uses several times counted as often."""


class MeshError(SimulationError):
    """A mesh file that cannot be read.

    Attributes:
        line: 1-based, 0 where unknown.
        code: of the issue it becomes.
    """

    def __init__(self, message: str, line: int = 0, code: str = "mesh-unreadable") -> None:
        super().__init__(message)
        self.line = line
        self.code = code


@dataclass(frozen=True)
class MeshPart:
    """One named piece.

    Attributes:
        names: what a `<submesh>` may call it, the closest name first.
        vertices: float64 array (n, 3), metres, in the frame of the file.
        triangles: int64 array (m, 3) of vertex indices.
    """

    names: Tuple[str, ...]
    vertices: Any
    triangles: Any


def bounded(parts: Iterator[MeshPart]) -> List[MeshPart]:
    """The parts of a file, which may be small itself and use one piece a million times.

    Raises:
        MeshFault: they have more than `MOST_TRIANGLES`.
    """
    found: List[MeshPart] = []
    count = 0
    for part in parts:
        found.append(part)
        count += max(len(part.triangles), len(part.vertices) // 3)
        if count > MOST_TRIANGLES:
            raise MeshError(f"it has more than {MOST_TRIANGLES} triangles")
    return found
