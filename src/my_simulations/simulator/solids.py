"""Meshes of bodies that move, divided into convex parts before the engine sees them."""
from __future__ import annotations

from dataclasses import replace
from typing import Callable, Dict, List

from ..description.model import Model
from ..description.shapes import SOLIDS, MeshData, MeshTable, mesh_key
from ..errors import Issue


class ConvexParts:
    """Divides meshes, each once."""

    def __init__(self, log: Callable[[Issue], None], progress: Callable[[str], None]) -> None:
        self._log = log
        self._progress = progress
        self._divided: Dict[int, MeshData] = {}

    def of(self, model: Model, meshes: MeshTable) -> MeshTable:
        """The meshes that a flattened model needs, those of moving links with their parts.

        Blocks while a mesh is divided for the first time.
        """
        if not meshes or model.static:
            return meshes
        found = dict(meshes)
        for link in model.links:
            for collision in [] if link.kinematic else link.collisions:
                if isinstance(collision.geometry, SOLIDS):
                    key = mesh_key(collision.geometry)
                    if key in found and found[key].parts is None:
                        found[key] = self._parts(found[key], f"{model.name}::{link.name}")
        return found

    def _parts(self, mesh: MeshData, whose: str) -> MeshData:
        known = self._divided.get(id(mesh.vertices))
        if known is not None and known.vertices is mesh.vertices:
            return known
        from ..engine.decompose import convex_parts

        issues: List[Issue] = []
        parts = convex_parts(mesh, issues=issues,
                             progress=lambda text: self._progress(f"{whose}: {text}"))
        for issue in issues:
            self._log(replace(issue, message=f"{whose}: {issue.message}"))
        divided = replace(mesh, parts=parts)
        if len(self._divided) > 200:
            self._divided.clear()
        self._divided[id(mesh.vertices)] = divided
        return divided
