"""Triangles for what the page cannot read or make itself: terrains, map images, odd mesh files.

STL, and for PLY files a PLY file, which has the colours of all corners, whatever form those had.
"""
from __future__ import annotations

import hashlib
import threading
from collections import OrderedDict
from dataclasses import replace
from typing import Any, Dict, Optional

from ...description.shapes import Mesh, Solid, mesh_key
from ...errors import InputError
from ...formats.mesh.loading import load_solid

_KEPT = 16


class Solids:
    """Binary files by id, made when asked for."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._known: Dict[str, Solid] = {}
        self._made: "OrderedDict[str, bytes]" = OrderedDict()

    def url(self, solid: Solid) -> str:
        """Where the triangles can be had; a mesh without its scale, part and centring."""
        if isinstance(solid, Mesh):
            solid = replace(solid, scale=(1.0, 1.0, 1.0), submesh="", center=False)
        known = hashlib.sha256(mesh_key(solid).encode()).hexdigest()[:16]
        with self._lock:
            self._known[known] = solid
        return f"/solid/{known}.{self.extension(solid)}"

    @staticmethod
    def extension(solid: Solid) -> str:
        """Return the extension of the file in which the page gets a solid."""
        is_ply = isinstance(solid, Mesh) and solid.path.lower().endswith(".ply")
        return "ply" if is_ply else "stl"

    def file(self, known: str) -> bytes:
        """The file; b"" for an unknown id. Raises InputError for a solid that cannot be made."""
        with self._lock:
            solid = self._known.get(known)
            made = self._made.get(known)
        if solid is None:
            return b""
        if made is None:
            made = _binary_file(solid)
            with self._lock:
                self._made[known] = made
                while len(self._made) > _KEPT:
                    self._made.popitem(last=False)
        return made


def _binary_file(solid: Solid) -> bytes:
    import numpy as np

    data = load_solid(solid)
    corners = np.asarray(data.vertices)[np.asarray(data.triangles)]
    if not len(corners):
        raise InputError([])
    if isinstance(solid, Mesh) and Solids.extension(solid) == "ply":
        return _binary_ply(solid, corners)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    table = np.zeros(len(corners), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)),
                                          ("attribute", "<u2")])
    table["normal"] = normals / np.where(lengths > 0, lengths, 1.0)
    table["corners"] = corners
    return b"\0" * 80 + len(corners).to_bytes(4, "little") + table.tobytes()


def _binary_ply(mesh: Mesh, corners: Any) -> bytes:
    """Return a binary PLY file with three vertices for each triangle, and the colours if any."""
    import numpy as np

    from ...formats.mesh.painted import colored_corners

    colors: Optional[Any] = None
    try:
        found = colored_corners(mesh)
    except Exception:  # of any library that reads them
        found = None   # colours are optional; the shape was read
    if found is not None and len(found[0]) == len(corners):
        corners, colors = found[0], found[1] / 255.0
    names = ["x", "y", "z"] + (["red", "green", "blue"] if colors is not None else [])
    rows = corners if colors is None else np.concatenate([corners, colors], axis=2)
    faces = np.zeros(len(corners), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, np.arange(3 * len(corners)).reshape(-1, 3)
    head = ["ply", "format binary_little_endian 1.0", f"element vertex {3 * len(corners)}",
            *(f"property float {name}" for name in names), f"element face {len(corners)}",
            "property list uchar int vertex_indices", "end_header", ""]
    return "\n".join(head).encode() + rows.astype("<f4").tobytes() + faces.tobytes()
