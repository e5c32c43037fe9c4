"""Meshes for drawing: with normals, texture coordinates and the file's materials."""
from __future__ import annotations

import io
import math
import os
from dataclasses import dataclass, replace
from typing import Any, Iterator, List, Optional, Tuple

import numpy as np

from ...description.shapes import Mesh, MeshData
from .collada import ColladaDocument, Surface, is_mirrored, parse_collada, unit_of
from .collada_materials import ColladaMaterials
from .loading import load_mesh
from .paint import Array, Paint, linear_to_srgb, paint_of

_PAINTED = (".obj", ".glb", ".gltf", ".ply")


@dataclass(frozen=True)
class PaintedPart:
    """Triangles of one material, scale applied.

    Attributes:
        vertices: float64 (n, 3), m.
        normals: (n, 3), unit vectors.
        uv: texture coordinates (n, 2), v upwards.
        triangles: int32 (m, 3), vertex indices.
        paint: the file's material.
    """

    vertices: Array
    normals: Array
    uv: Array
    triangles: Array
    paint: Paint = Paint()


def painted_parts(mesh: Mesh) -> List[PaintedPart]:
    """The parts of a mesh file with their materials, or without if these cannot be read.

    The triangles are those of `load_mesh`, which reports faults of the file. Raises InputError: see
    `load_mesh`.
    """
    plain = load_mesh(mesh)
    try:
        parts = _read_parts(mesh)
    except Exception:  # of any library that reads them
        parts = []  # materials are optional; the shape was read
    if sum(len(part.triangles) for part in parts) != len(plain.triangles):
        return [shade_flat(plain)]
    return _place_parts(parts, mesh)


def shade_flat(data: MeshData) -> PaintedPart:
    """Return triangles with one normal each (flat shading), as for STL files."""
    corners = np.asarray(data.vertices)[np.asarray(data.triangles)].reshape(-1, 3)
    return _part_of_corners(corners, None, None, Paint())


def shade_smooth(data: MeshData) -> PaintedPart:
    """Return triangles that share the normals of their common corners, for terrains."""
    vertices, triangles = np.asarray(data.vertices), np.asarray(data.triangles, dtype=np.int32)
    corners = vertices[triangles]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.column_stack([np.bincount(
        triangles.ravel(), across[:, axis].repeat(3), len(vertices)) for axis in range(3)])
    return PaintedPart(vertices, _unit_rows(normals), np.zeros((len(vertices), 2)), triangles)


def _read_parts(mesh: Mesh) -> List[PaintedPart]:
    extension = os.path.splitext(mesh.path)[1].lower()
    if extension == ".dae":
        return _collada(mesh)
    if extension in _PAINTED:
        return _trimesh(mesh, extension)
    return []


def _place_parts(parts: List[PaintedPart], mesh: Mesh) -> List[PaintedPart]:
    """Apply scale and centring of the visual, as `load_mesh` does."""
    scale, shift = np.array(mesh.scale), np.zeros(3)
    if mesh.submesh and mesh.center:
        low = np.min([part.vertices.min(axis=0) for part in parts], axis=0)
        high = np.max([part.vertices.max(axis=0) for part in parts], axis=0)
        shift = (low + high) / 2
    mirrored = bool(np.prod(scale) < 0)
    placed = []
    for part in parts:
        normals = part.normals / np.where(scale == 0, 1.0, scale)
        triangles = part.triangles[:, ::-1] if mirrored else part.triangles
        placed.append(replace(part, vertices=(part.vertices - shift) * scale,
                              normals=_unit_rows(np.asarray(normals)), triangles=triangles))
    return placed


def _unit_rows(rows: Array) -> Array:
    length = np.linalg.norm(rows, axis=1, keepdims=True)
    unit: Array = rows / np.where(length > 0, length, 1.0)
    return unit


def merge_corners(corners: Array, normals: Optional[Array], uv: Optional[Array], paint: Paint,
                  sources: Optional[Array] = None) -> Tuple[PaintedPart, Array]:
    """Merge equal corners of triangles into shared vertices.

    Args:
        corners: (3 m, 3), m.
        normals: (3 m, 3) or None for those of the triangles.
        uv: (3 m, 2) or None.
        paint: of the triangles.
        sources: (3 m,), numbers; corners of different ones stay apart.

    Returns:
        The part, and for each of its vertices the number of a corner that it was made of.
    """
    if normals is None or len(normals) != len(corners):
        faces = corners.reshape(-1, 3, 3)
        normals = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0]).repeat(3, axis=0)
    if uv is None or len(uv) != len(corners):
        uv = np.zeros((len(corners), 2))
    columns = [corners, _unit_rows(np.asarray(normals)), uv[:, :2]]
    rows = np.ascontiguousarray(
        np.column_stack(columns if sources is None else [*columns, sources]).astype(np.float32)
        + 0.0
    )
    _, first, inverse = np.unique(rows.view([("", rows.dtype)] * rows.shape[1]).ravel(),
                                  return_index=True, return_inverse=True)
    kept = rows[first].astype(np.float64)
    return PaintedPart(np.asarray(corners, dtype=np.float64)[first], kept[:, 3:6], kept[:, 6:8],
                       inverse.reshape(-1, 3).astype(np.int32), paint), first


def _part_of_corners(corners: Array, normals: Optional[Array], uv: Optional[Array],
                     paint: Paint) -> PaintedPart:
    return merge_corners(corners, normals, uv, paint)[0]


def _collada(mesh: Mesh) -> List[PaintedPart]:
    with open(mesh.path, "rb") as stream:
        root = parse_collada(stream.read())
    unit, materials = unit_of(root), ColladaMaterials(root)
    folder = os.path.dirname(mesh.path)
    parts = []
    for instance in ColladaDocument(root).instances():
        if mesh.submesh and mesh.submesh not in instance.names:
            continue
        for surface in instance.surfaces:
            corners, normals, uv = corners_of(surface, instance.matrix)
            paint = materials.paint_of(instance.materials.get(surface.material, ""), folder)
            parts.append(_part_of_corners(corners * unit, normals, uv, paint))
    return parts


def corners_of(surface: Surface, matrix: Array) -> "Tuple[Array, Optional[Array], Optional[Array]]":
    """The corners of the triangles of a surface.

    Args:
        surface: the surface.
        matrix: (4, 4), where it is.

    Returns:
        Places (3 m, 3) in the file's unit, normals (3 m, 3) and texture coordinates (3 m, 2); None
        for what the file does not have.
    """
    order = slice(None, None, -1 if is_mirrored(matrix) else 1)
    corners = surface.positions[surface.triangles[:, order]].reshape(-1, 3)
    normals = surface.corner_values("NORMAL", 3)
    if normals is not None:
        normals = normals[:, order].reshape(-1, 3) @ _cofactors(matrix[:3, :3]).T
    uv = surface.corner_values("TEXCOORD", 2)
    return (corners @ matrix[:3, :3].T + matrix[:3, 3], normals,
            None if uv is None else uv[:, order].reshape(-1, 2))


def colored_corners(mesh: Mesh) -> "Optional[Tuple[Array, Array]]":
    """All corners of a file's triangles, in its own frame, with the colours that it gives them.

    Returns:
        Places (m, 3, 3), m, and uint8 (m, 3, 3), sRGB; None where some have no colour.

    Raises:
        Exception: of the library that reads it.
    """
    places: List[Array] = []
    colors: List[Array] = []
    for shape, faces, vertices, _ in _shapes(mesh, os.path.splitext(mesh.path)[1].lower()):
        told = colors_of(shape, faces)
        if told is None:
            return None
        places.append(vertices[faces])
        colors.append(told)
    return (np.concatenate(places), np.concatenate(colors)) if places else None


def _trimesh(mesh: Mesh, extension: str) -> List[PaintedPart]:
    if mesh.submesh:
        return []  # only `load_mesh` knows the selected submesh
    parts = []
    for shape, faces, vertices, normals in _shapes(mesh, extension):
        uv = getattr(shape.visual, "uv", None)
        uv = None if uv is None else np.asarray(uv)[faces].reshape(-1, 2)
        paint = paint_of(getattr(shape.visual, "material", None))
        uv, paint = paint_from_colors(shape, faces, uv, paint)
        parts.append(_part_of_corners(vertices[faces].reshape(-1, 3), normals, uv, paint))
    return parts


def _shapes(mesh: Mesh, extension: str) -> "Iterator[Tuple[Any, Array, Array, Optional[Array]]]":
    """Yield each mesh of trimesh in a file, its faces, its vertices and normals of corners."""
    import trimesh
    from trimesh.resolvers import FilePathResolver

    from .obj import positive_obj

    source: Any = mesh.path
    if extension == ".obj":
        with open(mesh.path, "rb") as stream:
            source = io.BytesIO(positive_obj(stream.read()))
    scene = trimesh.load_scene(source, file_type=extension[1:], process=False,
                               resolver=FilePathResolver(mesh.path))
    for node in scene.graph.nodes_geometry:
        matrix, name = scene.graph[node]
        shape = scene.geometry[name]
        if not isinstance(shape, trimesh.Trimesh) or not len(shape.faces):
            continue
        faces = shape.faces[:, ::-1] if np.linalg.det(matrix[:3, :3]) < 0 else shape.faces
        vertices = np.asarray(shape.vertices) @ matrix[:3, :3].T + matrix[:3, 3]
        normals = None
        if "vertex_normals" in shape._cache:
            turned = _cofactors(matrix[:3, :3])
            normals = (np.asarray(shape.vertex_normals) @ turned.T)[faces].reshape(-1, 3)
        yield shape, faces, vertices, normals


def _cofactors(matrix: Any) -> Any:
    """Return the matrix that turns normals: the transposed inverse times |det|.

    It also exists for a flat, singular matrix.
    """
    one, two, three = matrix
    found = np.array([np.cross(two, three), np.cross(three, one), np.cross(one, two)])
    return -found if np.linalg.det(matrix) < 0 else found


_MOST_KINDS = 512 * 512
"""Blocks of 2 x 2 pixels in the largest picture that cameras do not make smaller."""
_CORNERS = np.array([(0.5, 0.5), (1.5, 0.5), (0.5, 1.5)])
_MIDDLE = np.array([(1.0, 1.0)] * 3)


def paint_from_colors(shape: Any, faces: Array, uv: Optional[Array], paint: Paint,
                      ) -> Tuple[Optional[Array], Paint]:
    """Paint a mesh of trimesh with its vertex or face colours; return its texture coordinates too.

    Texture coordinates are (3 m, 2). `faces`: its triangles in the order in which they are drawn. A
    mesh with a picture keeps its texture coordinates and paint.
    """
    colors = None if paint.picture is not None else colors_of(shape, faces)
    if colors is None:
        return uv, paint
    made, picture = _picture(colors)
    return made, paint._replace(color=paint.color or (1.0, 1.0, 1.0, 1.0), picture=picture)


def colors_of(shape: Any, faces: Array) -> Optional[Array]:
    """uint8 (m, 3, 3), sRGB, of each corner; None where the file has none."""
    visual = shape.visual
    if visual.kind == "face":
        found = np.asarray(visual.face_colors)[:, None, :3].repeat(3, axis=1)
        return found if len(found) == len(faces) else None   # trimesh divides squares, not colours
    if visual.kind == "vertex":
        return np.asarray(visual.vertex_colors)[faces][..., :3]
    attributes = getattr(visual, "vertex_attributes", None)   # of glTF, beside a material
    told = None if attributes is None else attributes.get("color")
    if told is None:
        return None
    parts = np.asarray(told)[faces][..., :3]
    if parts.dtype.kind != "f":
        parts = parts / np.iinfo(parts.dtype).max
    # Those of glTF are linear.
    return np.rint(linear_to_srgb(np.clip(parts, 0.0, 1.0)) * 255.0).astype(np.uint8)


def _picture(colors: Array) -> Tuple[Array, Any]:
    """Texture coordinates (3 m, 2) and a PIL image with a block for each kind of triangle."""
    import PIL.Image

    kinds, which = np.unique(colors.reshape(-1, 9), axis=0, return_inverse=True)
    if len(kinds) > _MOST_KINDS:
        flat = colors.mean(axis=1).astype(np.uint8) & 0xF8
        kinds, which = np.unique(flat[:, None].repeat(3, axis=1).reshape(-1, 9), axis=0,
                                 return_inverse=True)
    which = which.reshape(-1)
    columns = math.ceil(math.sqrt(len(kinds)))
    rows = math.ceil(len(kinds) / columns)
    first, second, third = kinds.reshape(-1, 3, 3).astype(np.int16).swapaxes(0, 1)
    blocks = np.zeros((rows * columns, 2, 2, 3), dtype=np.uint8)
    fourth = np.clip(second + third - first, 0, 255)   # so that colours blend evenly in between
    blocks[:len(kinds)] = np.stack([first, second, third, fourth], axis=1).reshape(-1, 2, 2, 3)
    pixels = blocks.reshape(rows, columns, 2, 2, 3).swapaxes(1, 2).reshape(2 * rows, -1, 3)
    even = (first == second).all(axis=1) & (first == third).all(axis=1)
    # Triangles of one colour share their vertices with their neighbours.
    within = np.where(even[which, None, None], _MIDDLE, _CORNERS)
    at = within + 2.0 * np.stack([which % columns, which // columns], axis=1)[:, None]
    uv = at.reshape(-1, 2) / (2.0 * columns, 2.0 * rows)
    uv[:, 1] = 1.0 - uv[:, 1]
    return uv, PIL.Image.fromarray(np.ascontiguousarray(pixels))
