"""Triangles for what the page cannot read or make itself: terrains, map images, odd mesh files."""
from __future__ import annotations

import hashlib
import threading
from collections import OrderedDict
from dataclasses import replace
from typing import Dict

from ...description.shapes import Mesh, Solid, mesh_key
from ...errors import InputError
from ...formats.mesh.loading import load_solid

_KEPT = 16


class Solids:
    """Binary STL by id, made when asked for."""

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
        return f"/solid/{known}.stl"

    def stl(self, known: str) -> bytes:
        """The file; b"" for an unknown id. Raises InputError for a solid that cannot be made."""
        with self._lock:
            solid = self._known.get(known)
            made = self._made.get(known)
        if solid is None:
            return b""
        if made is None:
            made = _binary_stl(solid)
            with self._lock:
                self._made[known] = made
                while len(self._made) > _KEPT:
                    self._made.popitem(last=False)
        return made


def _binary_stl(solid: Solid) -> bytes:
    import numpy as np

    data = load_solid(solid)
    corners = np.asarray(data.vertices)[np.asarray(data.triangles)]
    if not len(corners):
        raise InputError([])
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    table = np.zeros(len(corners), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)),
                                          ("attribute", "<u2")])
    table["normal"] = normals / np.where(lengths > 0, lengths, 1.0)
    table["corners"] = corners
    return b"\0" * 80 + len(corners).to_bytes(4, "little") + table.tobytes()
