"""Reads STL, OBJ and other formats of trimesh. STL and OBJ have no unit: their numbers are metres.

trimesh silently skips damaged parts of a file, and counts negative indices of OBJ from the end of
the file. Therefore the text of both formats is checked and normalised first.
"""
from __future__ import annotations

import io
import os
import re
from typing import Any, Dict, Iterator, List, Set, Tuple

from .gltf import check_gltf
from .part import MeshError, MeshPart, bounded
from .plain_text import text_of, with_newlines

_HEADER = 84
_RECORD = 50
_NEGATIVE = re.compile(rb"[ \t/]-[0-9]+(?:[/\s\\]|\Z)")  # also coordinates: which is harmless
_METRES = {"millimeter": 0.001, "millimeters": 0.001, "centimeter": 0.01, "micron": 1e-6,
           "inch": 0.0254, "foot": 0.3048}


def extensions() -> Set[str]:
    """Extensions of mesh formats of trimesh, e.g. `.ply`; some need further libraries."""
    from trimesh.exchange.load import mesh_formats

    # Archives may expand to any size.
    return {f".{name}" for name in mesh_formats()} - {".bz2", ".zip", ".zae", ".tar.gz", ".tar.bz2"}


def read_stl(data: bytes) -> List[MeshPart]:
    """The triangles of an STL file, binary or ASCII.

    Raises:
        MeshError: neither binary nor ASCII STL.
    """
    end = binary_stl_end(data, len(data))
    if end:
        return [_welded(part) for part in _read(data[:end], "stl")]
    rows: List[str] = []
    for line, row in enumerate(text_of(data).split("\n"), 1):
        words = row.split()
        if words and words[0].lower() == "vertex":
            _three(words[1:4], line)
            rows.append("vertex " + " ".join(words[1:4]))
    if len(rows) % 3:
        raise MeshError(f"{len(rows)} corners are not triangles; the file may be cut off")
    # The name of a solid may contain the word vertex, and its end may be missing.
    plain = "\n".join(["solid", *rows, "endsolid", ""])
    return [_welded(part) for part in _read(plain.encode(), "stl")]


def binary_stl_end(data: bytes, size: int) -> int:
    """Where the triangles of a binary STL file end, in bytes; 0 for an ASCII file.

    Args:
        data: the file, or its first bytes, at least 84.
        size: of the file, bytes.

    Raises:
        MeshError: neither binary nor ASCII STL.
    """
    # A binary file may begin with `solid`, too; its length identifies it.
    if size >= _HEADER:
        count = int.from_bytes(data[80:_HEADER], "little")
        end = _HEADER + _RECORD * count
        if size >= end and not (count == 0 and data[:5].lower() == b"solid"):
            return end
    if data.lstrip()[:5].lower() != b"solid":
        raise MeshError("neither a binary STL of that length nor an ASCII one")
    return 0


def read_obj(data: bytes) -> List[MeshPart]:
    """The parts of an OBJ file, by its `o` and `g` lines.

    Raises:
        MeshError: an invalid number, or an index out of range.
    """
    plain, names = _plain_obj(_joined(text_of(data)))
    return [MeshPart(names[int(part.names[0])], part.vertices, part.triangles)
            for part in _read(plain.encode(), "obj", split_groups=True)]


def _joined(text: str) -> str:
    """Lines that go on in others as one, and empty lines in place of those: line numbers stay."""
    if "\\\n" not in text:
        return text
    rows: List[str] = []
    begun: List[str] = []
    for row in text.split("\n"):
        if row.endswith("\\"):
            begun.append(row[:-1])
        else:
            rows += [" ".join((*begun, row)), *[""] * len(begun)]
            begun = []
    return "\n".join([*rows, " ".join(begun)])


def positive_obj(data: bytes) -> bytes:
    """An OBJ file as trimesh reads it: with positive indices, and no lines that go on in others.

    Raises:
        ValueError: an index is not a number.
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


def read_other(data: bytes, path: str) -> List[MeshPart]:
    """The parts of a file in another format, in its declared unit, else in metres.

    The extension of `path` gives the format; a .gltf file finds its buffers beside it.

    Raises:
        MeshError: trimesh cannot read it, or lacks a library for it.
    """
    from trimesh.resolvers import FilePathResolver

    kind = os.path.splitext(path)[1].lower().lstrip(".")
    if kind in ("gltf", "glb"):
        check_gltf(data, path)
    return _read(data, kind, resolver=FilePathResolver(path))


def _read(data: bytes, kind: str, **options: Any) -> List[MeshPart]:
    import trimesh

    try:
        scene = trimesh.load_scene(io.BytesIO(data), file_type=kind, process=False, **options)
    except ImportError as fault:
        raise MeshError(f"reading .{kind} needs a library that is not there: {fault}") from None
    except Exception as fault:  # the formats of trimesh raise various exceptions
        raise MeshError(str(fault) or type(fault).__name__) from None
    return bounded(_scene_parts(scene))


def _scene_parts(scene: Any) -> Iterator[MeshPart]:
    import numpy as np
    import trimesh

    unit = _METRES.get(scene.units or "", 1.0)
    for node in scene.graph.nodes_geometry:
        matrix, name = scene.graph[node]
        mesh = scene.geometry[name]
        if not isinstance(mesh, trimesh.Trimesh) or not len(mesh.faces):
            continue
        vertices = (np.asarray(mesh.vertices) @ matrix[:3, :3].T + matrix[:3, 3]) * unit
        triangles = np.asarray(mesh.faces, dtype=np.int64)
        if triangles.min() < 0 or triangles.max() >= len(vertices):
            raise MeshError("a face names a vertex that does not exist")
        if np.linalg.det(matrix[:3, :3]) < 0:
            triangles = triangles[:, ::-1]  # mirrored: reverse the winding
        yield MeshPart(tuple(dict.fromkeys((name, node))), vertices, triangles)


def _welded(part: MeshPart) -> MeshPart:
    """Merge corners at the same position; STL has three vertices for each triangle."""
    import numpy as np

    rows = np.ascontiguousarray(part.vertices + 0.0)  # -0.0 equals 0.0
    keys = rows.view([("", rows.dtype)] * 3).ravel()
    _, first, inverse = np.unique(keys, return_index=True, return_inverse=True)
    return MeshPart(part.names, rows[first], inverse.reshape(-1)[part.triangles])


def _plain_obj(text: str) -> Tuple[str, List[Tuple[str, ...]]]:
    """Reduce to positions and faces with positive indices, in groups 0, 1, …; their names."""
    rows: List[str] = []
    groups: Dict[Tuple[str, ...], int] = {}
    shape, group, count, current = "", "", 0, -1
    for line, row in enumerate(text.split("\n"), 1):
        words = row.partition("#")[0].split()
        key = words[0] if words else ""
        if key == "v":
            _three(words[1:4], line)
            rows.append("v " + " ".join(words[1:4]))
            count += 1
        elif key == "f" and len(words) > 3:
            names = tuple(name for name in (group, shape) if name)
            number = groups.setdefault(names, len(groups))
            if number != current:
                rows.append(f"g {number}")
                current = number
            corners = [_index(word, count, line) for word in words[1:]]
            rows += [f"f {corners[0]} {corners[k]} {corners[k + 1]}"
                     for k in range(1, len(corners) - 1)]
        elif key == "o":
            shape, group = " ".join(words[1:]), ""
        elif key == "g":
            group = " ".join(words[1:])
    return "\n".join(rows) + "\n", list(groups)


def _three(words: List[str], line: int) -> None:
    try:
        _, _, _ = (float(word) for word in words)
    except ValueError:
        raise MeshError(f"expected 3 numbers, found {' '.join(words)!r}", line) from None


def _index(word: str, count: int, line: int) -> int:
    """The vertex index of `7/1/3`, from 1; negative ones count back from the last vertex so far."""
    try:
        index = int(word.partition("/")[0])
    except ValueError:
        raise MeshError(f"expected a vertex number, found {word!r}", line) from None
    found = index if index > 0 else count + 1 + index
    if index == 0 or not 1 <= found <= count:
        raise MeshError(f"there is no vertex {index}", line)
    return found
