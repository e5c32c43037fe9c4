"""Convex decomposition of the meshes of moving bodies."""
from __future__ import annotations

from dataclasses import replace
from typing import Callable, Dict, Iterable, Iterator, Tuple

from ..description.model import Model
from ..description.shapes import SOLIDS, MeshData, MeshTable, mesh_key
from ..errors import Issue

_MOST_KEPT = 1000


class ConvexParts:
    """Decomposes meshes into convex parts, each mesh once."""

    def __init__(self, log: Callable[[Issue], None], progress: Callable[[str], None]) -> None:
        self._log = log
        self._progress = progress
        self._divided: Dict[int, MeshData] = {}

    def of(self, model: Model, meshes: MeshTable) -> MeshTable:
        """The collision meshes of a flattened model; those of moving links get convex parts.

        Blocks while a mesh is decomposed for the first time.
        """
        self.prepare([(model, meshes)], gently=True)
        found = dict(meshes)
        for key, mesh, _ in _moving(model, meshes):
            found[key] = self._divided[id(mesh.vertices)]
        return found

    def prepare(self, models: Iterable[Tuple[Model, MeshTable]], gently: bool = False) -> None:
        """Decompose the meshes of several flattened models in parallel; blocks until done.

        With `gently`, at low priority, for a world that is running.
        """
        wanted: Dict[int, Tuple[str, MeshData]] = {}
        for model, meshes in models:
            for _, mesh, whose in _moving(model, meshes):
                known = self._divided.get(id(mesh.vertices))
                if known is None or known.vertices is not mesh.vertices:
                    wanted.setdefault(id(mesh.vertices), (whose, mesh))
        if not wanted:
            return
        from ..engine.convex.batch import decompose_all
        from ..engine.convex.decomposition import decomposition_issues

        named = list(wanted.values())
        made = decompose_all(named, self._progress, gently=gently)
        if len(self._divided) > _MOST_KEPT:
            self._divided.clear()
        for (whose, mesh), parts in zip(named, made):
            for issue in decomposition_issues(parts):
                self._log(replace(issue, message=f"{whose}: {issue.message}"))
            self._divided[id(mesh.vertices)] = replace(mesh, parts=parts.parts)


def _moving(model: Model, meshes: MeshTable) -> Iterator[Tuple[str, MeshData, str]]:
    """Key, mesh and scoped link name of the meshes of moving links without convex parts."""
    if not meshes or model.static:
        return
    for link in model.links:
        for collision in [] if link.kinematic else link.collisions:
            if isinstance(collision.geometry, SOLIDS):
                key = mesh_key(collision.geometry)
                if key in meshes and meshes[key].parts is None:
                    yield key, meshes[key], f"{model.name}::{link.name}"
