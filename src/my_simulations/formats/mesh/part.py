"""Parts of a mesh file, and the error of an unreadable one."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Iterator, List, Tuple

from ...errors import SimulationError

MOST_TRIANGLES = 10_000_000
"""Most triangles of a file; instances count separately."""


class MeshError(SimulationError):
    """A mesh file that cannot be read.

    Attributes:
        line: 1-based; 0 if unknown.
        code: code of the issue to report.
    """

    def __init__(self, message: str, line: int = 0, code: str = "mesh-unreadable") -> None:
        super().__init__(message)
        self.line = line
        self.code = code


@dataclass(frozen=True)
class MeshPart:
    """One named part of a mesh file.

    Attributes:
        names: names by which a `<submesh>` may refer to it, the most specific first.
        vertices: float64 array (n, 3), metres, in the frame of the file.
        triangles: int64 array (m, 3) of vertex indices.
    """

    names: Tuple[str, ...]
    vertices: Any
    triangles: Any


def check_triangle_count(parts: Iterator[MeshPart]) -> List[MeshPart]:
    """Return the parts if there are not too many triangles: a small file may have many instances.

    Raises MeshError: they have more than `MOST_TRIANGLES`.
    """
    found: List[MeshPart] = []
    count = 0
    for part in parts:
        found.append(part)
        count += max(len(part.triangles), len(part.vertices) // 3)
        if count > MOST_TRIANGLES:
            raise MeshError(f"it has more than {MOST_TRIANGLES} triangles")
    return found
