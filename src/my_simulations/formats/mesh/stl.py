"""Reads STL files, binary and ASCII. STL has no unit: its numbers are metres."""
from __future__ import annotations

from array import array
from typing import Any, List

from .part import MOST_TRIANGLES, MeshError, MeshPart
from .plain_text import numbered_lines, text_of, three_numbers

HEADER = 84
"""Bytes before the first triangle of a binary file; the last four are the number of triangles."""

_RECORD = 50  # bytes of a triangle: normal, corners, attributes


def read_stl(data: bytes) -> List[MeshPart]:
    """The triangles of an STL file, binary or ASCII, as one part; equal corners are one vertex.

    Raises MeshError: neither binary nor ASCII STL, or too many triangles.
    """
    end = binary_stl_end(data, len(data))
    return [_weld_corners(_binary_corners(data, end) if end else _ascii_corners(data))]


def binary_stl_end(data: bytes, size: int) -> int:
    """Return the end of the triangles of a binary STL file, in bytes; 0 for an ASCII file.

    Args:
        data: the file, or its first bytes, at least 84.
        size: of the file, bytes.

    Raises:
        MeshError: neither binary nor ASCII STL.
    """
    # A binary file may begin with `solid`, too; its length identifies it.
    if size >= HEADER:
        count = int.from_bytes(data[80:HEADER], "little")
        end = binary_stl_size(count)
        if size >= end and not (count == 0 and data[:5].lower() == b"solid"):
            return end
    if data.lstrip()[:5].lower() != b"solid":
        raise MeshError("neither a binary STL of that length nor an ASCII one")
    return 0


def binary_stl_size(count: int) -> int:
    """Bytes of a binary STL file of so many triangles."""
    return HEADER + _RECORD * count


def _binary_corners(data: bytes, end: int) -> Any:
    """float32 (3 m, 3): the corners of all triangles, m."""
    import numpy as np

    rows = np.frombuffer(data, [("normal", "<f4", 3), ("corners", "<f4", (3, 3)),
                                ("attributes", "<u2")], (end - HEADER) // _RECORD, HEADER)
    return rows["corners"].reshape(-1, 3)


def _ascii_corners(data: bytes) -> Any:
    """float64 (3 m, 3): the corners of all triangles, m."""
    import numpy as np

    corners: "array[float]" = array("d")
    for line, row in numbered_lines(text_of(data)):
        words = row.split(None, 4)
        if words and words[0].lower() == "vertex":
            corners.extend(three_numbers(words[1:4], line))
            if len(corners) > 9 * MOST_TRIANGLES:
                raise MeshError(f"it has more than {MOST_TRIANGLES} triangles")
    if len(corners) % 9:
        raise MeshError(f"{len(corners) // 3} corners are not triangles; the file may be cut off")
    return np.array(corners, np.float64).reshape(-1, 3)


def _weld_corners(corners: Any) -> MeshPart:
    """A part in which corners at the same position are one vertex, in order of x, y, z."""
    import numpy as np

    if not len(corners):
        return MeshPart((), np.zeros((0, 3)), np.zeros((0, 3), np.int64))
    rows = corners + corners.dtype.type(0.0)  # -0.0 equals 0.0
    order = np.lexsort(rows.T[::-1])
    rows = rows[order]
    is_first = np.ones(len(rows), dtype=bool)
    is_first[1:] = (rows[1:] != rows[:-1]).any(axis=1)
    numbers = np.empty(len(rows), np.int64)
    numbers[order] = np.cumsum(is_first) - 1
    return MeshPart((), rows[is_first].astype(np.float64), numbers.reshape(-1, 3))
