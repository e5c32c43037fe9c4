"""STL (binary and ASCII) and Wavefront OBJ. Neither knows a unit: their numbers are metres."""
from __future__ import annotations

from typing import Any, Dict, List, Tuple

from .mesh_part import MeshFault, MeshPart

_HEADER = 84
_RECORD = 50


def read_stl(data: bytes) -> List[MeshPart]:
    """The one piece of an STL file.

    Raises:
        MeshFault: neither binary nor ASCII STL.
    """
    import numpy as np

    # A binary file may begin with `solid` too; its length gives it away.
    if len(data) >= _HEADER:
        count = int.from_bytes(data[80:_HEADER], "little")
        if len(data) >= _HEADER + _RECORD * count and not (
                count == 0 and data[:5].lower() == b"solid"):
            record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("flags", "<u2")])
            faces = np.frombuffer(data, record, count, _HEADER)
            return [_welded(faces["corners"].reshape(-1, 3).astype(np.float64))]
    if data.lstrip()[:5].lower() != b"solid":
        raise MeshFault("neither a binary STL of that length nor an ASCII one")
    return [_welded(_ascii_corners(data))]


def _ascii_corners(data: bytes) -> Any:
    import numpy as np

    corners: List[Tuple[float, float, float]] = []
    for line, text in enumerate(data.decode("latin-1").splitlines(), 1):
        words = text.split()
        if words and words[0].lower() == "vertex":
            corners.append(_three(words[1:4], line))
    if len(corners) % 3:
        raise MeshFault(f"{len(corners)} corners are not triangles; the file may be cut off")
    return np.array(corners, dtype=np.float64).reshape(-1, 3)


def _three(words: List[str], line: int) -> Tuple[float, float, float]:
    try:
        x, y, z = (float(word) for word in words)
    except ValueError:
        raise MeshFault(f"expected 3 numbers, found {' '.join(words)!r}", line) from None
    return (x, y, z)


def _welded(corners: Any) -> MeshPart:
    """Corners at the same place made one vertex; STL has three of its own for each triangle."""
    import numpy as np

    if not len(corners):
        return MeshPart((), corners, np.zeros((0, 3), dtype=np.int64))
    rows = np.ascontiguousarray(corners + 0.0)  # -0.0 and 0.0 are one place
    keys = rows.view([("", rows.dtype)] * 3).ravel()
    _, first, inverse = np.unique(keys, return_index=True, return_inverse=True)
    return MeshPart((), rows[first], inverse.reshape(-1, 3).astype(np.int64))


def read_obj(data: bytes) -> List[MeshPart]:
    """The pieces of an OBJ file, by its `o` and `g` lines.

    Raises:
        MeshFault: a number that is none, or an index out of range.
    """
    import numpy as np

    vertices: List[Tuple[float, float, float]] = []
    faces: Dict[Tuple[str, ...], List[Tuple[int, int, int]]] = {}
    shape, group = "", ""
    for line, text in enumerate(_joined_lines(data), 1):
        words = text.split()
        if not words:
            continue
        if words[0] == "v":
            vertices.append(_three(words[1:4], line))
        elif words[0] == "f":
            corners = [_index(word, len(vertices), line) for word in words[1:]]
            into = faces.setdefault(tuple(name for name in (group, shape) if name), [])
            into += [(corners[0], corners[k], corners[k + 1]) for k in range(1, len(corners) - 1)]
        elif words[0] == "o":
            shape, group = " ".join(words[1:]), ""
        elif words[0] == "g":
            group = " ".join(words[1:])
    points = np.array(vertices, dtype=np.float64).reshape(-1, 3)
    return [MeshPart(names, points, np.array(own, dtype=np.int64).reshape(-1, 3))
            for names, own in faces.items()]


def _joined_lines(data: bytes) -> List[str]:
    text = data.decode("latin-1")
    return (text.replace("\\\r\n", " ").replace("\\\n", " ") if "\\" in text else text).splitlines()


def _index(word: str, count: int, line: int) -> int:
    """The vertex of `7/1/3`; negative ones count from the last vertex so far."""
    try:
        index = int(word.partition("/")[0])
    except ValueError:
        raise MeshFault(f"expected a vertex number, found {word!r}", line) from None
    found = index - 1 if index > 0 else count + index
    if index == 0 or not 0 <= found < count:
        raise MeshFault(f"there is no vertex {index}", line)
    return found
