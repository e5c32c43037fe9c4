"""Reads the shape of OBJ files. OBJ has no unit: its numbers are metres."""
from __future__ import annotations

import re
from array import array
from typing import Dict, List, Tuple

from .part import MOST_TRIANGLES, MeshError, MeshPart
from .plain_text import numbered_lines, text_of, three_numbers, with_newlines

_NEGATIVE = re.compile(rb"[ \t/]-[0-9]+(?:[/\s\\]|\Z)")  # also coordinates: which is harmless
_MORE_CORNERS = 64
"""How many more corners a face may have than there are vertices: some files repeat corners."""

_LONGEST_CORNER = 64  # characters


def read_obj(data: bytes) -> List[MeshPart]:
    """The parts of an OBJ file, by its `o` and `g` lines, in the order of their first faces.

    The parts share the array of all vertices of the file. Raises MeshError: an invalid number, an
    index out of range, or too many corners or triangles.
    """
    import numpy as np

    reader = _ObjReader()
    for line, row in numbered_lines(text_of(data), continued=True):
        reader.read(row, line)
    if not reader.groups:
        return []
    vertices = np.frombuffer(reader.vertices, np.float64).reshape(-1, 3)
    return [MeshPart(names, vertices, np.frombuffer(corners, np.int64).reshape(-1, 3))
            for names, corners in reader.groups.items()]


class _ObjReader:
    """Collects vertices and triangles line by line.

    Attributes:
        vertices: coordinates of all vertices, m.
        groups: indices of the corners of all triangles, by the names of their part.
    """

    def __init__(self) -> None:
        self.vertices: "array[float]" = array("d")
        self.groups: Dict[Tuple[str, ...], "array[int]"] = {}
        self._shape = self._group = ""
        self._count = self._triangles = 0

    def read(self, row: str, line: int) -> None:
        """Read one line. Raises MeshError."""
        if len(row) > _LONGEST_CORNER * (self._count + _MORE_CORNERS):
            row = self._shorten_line(row, line)
        words = row.partition("#")[0].split()
        key = words[0] if words else ""
        if key == "v":
            self.vertices.extend(three_numbers(words[1:4], line))
            self._count += 1
        elif key == "f" and len(words) > 3:
            self._face(words[1:], line)
        elif key == "o":
            self._shape, self._group = " ".join(words[1:]), ""
        elif key == "g":
            self._group = " ".join(words[1:])

    def _shorten_line(self, row: str, line: int) -> str:
        """A long line without its comment. Raises MeshError for a face that remains too long."""
        row = row.partition("#")[0].strip()
        if row[:2] in ("f ", "f\t") and len(row) > _LONGEST_CORNER * (self._count + _MORE_CORNERS):
            raise self._too_many(line)
        return row

    def _too_many(self, line: int) -> MeshError:
        return MeshError(f"a face has more corners than the {self._count} vertices before it", line)

    def _face(self, words: List[str], line: int) -> None:
        if len(words) > self._count + _MORE_CORNERS:
            raise self._too_many(line)
        corners = [self._index(word, line) for word in words]
        self._triangles += len(corners) - 2
        if self._triangles > MOST_TRIANGLES:
            raise MeshError(f"it has more than {MOST_TRIANGLES} triangles")
        names = tuple(name for name in (self._group, self._shape) if name)
        group = self.groups.setdefault(names, array("q"))
        for k in range(1, len(corners) - 1):
            group.extend((corners[0], corners[k], corners[k + 1]))

    def _index(self, word: str, line: int) -> int:
        """The vertex index of `7/1/3`, from 0; negative ones count back from the last vertex."""
        try:
            index = int(word.partition("/")[0])
        except ValueError:
            raise MeshError(f"expected a vertex number, found {word!r}", line) from None
        found = index - 1 if index > 0 else self._count + index
        if index == 0 or not 0 <= found < self._count:
            raise MeshError(f"there is no vertex {index}", line)
        return found


def positive_obj(data: bytes) -> bytes:
    """An OBJ file as trimesh reads it: with positive indices, and no lines that go on in others.

    Raises ValueError: an index is not a number.
    """
    data = with_newlines(data).replace(b"\\\n", b" ")
    if not _NEGATIVE.search(data):
        return data
    counts = {"v": 0, "vt": 0, "vn": 0}
    rows = []
    for row in data.decode("latin-1").split("\n"):
        words = row.partition("#")[0].split()
        key = words[0] if words else ""
        if key in counts:
            counts[key] += 1
        elif key == "f":
            row = " ".join(["f", *(_positive(word, counts) for word in words[1:])])
        rows.append(row)
    return "\n".join(rows).encode("latin-1")


def _positive(word: str, counts: Dict[str, int]) -> str:
    """The corner `-3/-2/-1` with the indices that count from the first of the file."""
    indices = zip(word.split("/"), counts.values())
    return "/".join(str(count + 1 + int(index)) if index.startswith("-") else index
                    for index, count in indices)
