"""Reads mesh formats that trimesh knows, e.g. PLY and glTF."""
from __future__ import annotations

import io
import os
from typing import Any, Iterator, List, Set

from .gltf import check_gltf
from .part import MeshError, MeshPart, check_triangle_count

_METRES = {"millimeter": 0.001, "millimeters": 0.001, "centimeter": 0.01, "micron": 1e-6,
           "inch": 0.0254, "foot": 0.3048}


def extensions() -> Set[str]:
    """Extensions of mesh formats of trimesh, e.g. `.ply`; some need further libraries."""
    from trimesh.exchange.load import mesh_formats

    # Archives may expand to any size.
    return {f".{name}" for name in mesh_formats()} - {".bz2", ".zip", ".zae", ".tar.gz", ".tar.bz2"}


def read_with_trimesh(data: bytes, path: str) -> List[MeshPart]:
    """The parts of a file in another format, in its declared unit, else in metres.

    The extension of `path` gives the format; a .gltf file finds its buffers beside it. Raises
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
        raise MeshError(f"reading .{kind} needs a library that is not installed: {fault}") from None
    except Exception as fault:  # the formats of trimesh raise various exceptions
        raise MeshError(str(fault) or type(fault).__name__) from None
    return check_triangle_count(_scene_parts(scene))


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
