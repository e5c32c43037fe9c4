"""Pieces of a mesh file, and what can be wrong with one."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Tuple


class MeshFault(Exception):
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
