"""Write meshes to scratch files: PyBullet accepts meshes in compounds by file name only."""
from __future__ import annotations

import contextlib
import hashlib
import io
import os
import weakref
from typing import Any, Dict, List, Sequence, TextIO, Tuple

import numpy as np

from ...description.shapes import (
    SOLIDS,
    Collision,
    Geometry,
    MeshData,
    MeshTable,
    mesh_key,
)
from ...geometry import Pose, compose, transform
from ..convex.hull_points import hull_points, shrunk, triangles_of_all_points
from ..scratch_folder import Scratch

_ROWS = 10_000   # lines that are written in one operation


class HullFile:
    """A file of convex parts that is removed with the last recipe that names it."""

    def __init__(self, path: str, text: str) -> None:
        self.path = path
        with open(path, "w", encoding="ascii") as stream:
            stream.write(text)
        weakref.finalize(self, _remove, path)


def _remove(path: str) -> None:
    with contextlib.suppress(FileNotFoundError):  # the folder was removed before
        os.remove(path)


class ShapeFiles:
    """The mesh files of a world, in a folder that `close` removes."""

    def __init__(self) -> None:
        self._scratch = Scratch()
        self._paths: Dict[str, str] = {}
        self._hull_files: "weakref.WeakValueDictionary[str, HullFile]" = (
            weakref.WeakValueDictionary())

    def close(self) -> None:
        self._scratch.close()

    def mesh(self, key: str, mesh: MeshData, static: bool, margin: float = 0.0) -> str:
        """Return the path of a mesh, written once per key.

        Static meshes are written as triangles, others as convex parts shrunk by `margin`, m.
        """
        key = f"{key} {len(mesh.triangles) if static else 'pieces'} {margin}"
        if key not in self._paths:
            path = os.path.join(self._scratch.path, f"{len(self._paths) + 1}.obj")
            first = 1
            with open(path, "w", encoding="ascii") as stream:
                for piece in [mesh] if static or not mesh.parts else mesh.parts:
                    vertices, triangles = np.asarray(piece.vertices), np.asarray(piece.triangles)
                    if static and len(vertices) > triangles.size:  # a piece of a large mesh
                        used, numbers = np.unique(triangles, return_inverse=True)
                        vertices, triangles = vertices[used], numbers.reshape(-1, 3)
                    if margin:
                        vertices = shrunk(vertices, triangles, margin)
                    _write_part(stream, vertices, triangles, first)
                    first += len(vertices)
            self._paths[key] = path
        return self._paths[key]

    def hull_of(self, geometry: Geometry) -> str:
        """Return the path of a curved shape that Bullet does not have, as a hull of points."""
        points = hull_points(geometry)
        return self.mesh(repr(geometry), MeshData(points, triangles_of_all_points(len(points))),
                         True)

    def hulls(self, collisions: Sequence[Collision], meshes: MeshTable, frame: Pose) -> HullFile:
        """Write several collisions to one file of convex parts, in the body's frame.

        The path depends on the content only. So equal links have equal recipes, and reuse the
        shapes of removed links.
        """
        stream, first = io.StringIO(), 1
        for collision in collisions:
            pose = compose(frame, collision.pose)
            for points, triangles in _convex_parts(collision, meshes):
                rows: Any = points.tolist()
                moved = [transform(pose, (p[0], p[1], p[2])) for p in rows]
                _write_part(stream, np.array(moved), np.asarray(triangles), first)
                first += len(moved)
        text = stream.getvalue()
        name = hashlib.sha256(text.encode("ascii")).hexdigest()
        file = self._hull_files.get(name)
        if file is None:
            file = HullFile(os.path.join(self._scratch.path, f"{name}.obj"), text)
            self._hull_files[name] = file
        return file


def _write_part(stream: TextIO, vertices: np.ndarray, triangles: np.ndarray, first: int) -> None:
    """Write one OBJ object; `first` is the number of its first vertex in the file."""
    stream.write(f"o part{first}\n")
    for rows, line in ((vertices, "v %r %r %r\n"), (triangles + first, "f %d %d %d\n")):
        for at in range(0, len(rows), _ROWS):  # many lines in one operation: five times as fast
            some = rows[at:at + _ROWS]
            stream.write(line * len(some) % tuple(some.ravel().tolist()))


def _convex_parts(collision: Collision, meshes: MeshTable
                  ) -> List[Tuple[np.ndarray, np.ndarray]]:
    """Return the convex parts of a collision: points, and triangles that use all of them."""
    geometry = collision.geometry
    if isinstance(geometry, SOLIDS):
        mesh = meshes[mesh_key(geometry)]
        return [(np.asarray(piece.vertices), np.asarray(piece.triangles))
                for piece in mesh.parts or [mesh]]
    points = hull_points(geometry)
    return [(points, triangles_of_all_points(len(points)))]
