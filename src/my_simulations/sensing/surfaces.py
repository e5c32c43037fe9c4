"""Visuals as what is drawn: triangles with a surface each."""
from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, List, Optional, Tuple

import numpy as np

from ..appearance.looks import Look
from ..appearance.palette import DULLEST, GREY, GROUND
from ..appearance.terrain_layers import TerrainLayer
from ..description.picture_size import picture_size_of
from ..description.shapes import SOLIDS, Box, Color, Heightmap, Mesh, Plane, Visual
from .tessellation import repeated_uv, triangles_of

_OF_MESH: Color = (0.784, 0.784, 0.784, 1.0)
_DULL: Color = (0.0, 0.0, 0.0, 1.0)
_SIDES = 48


@dataclass(frozen=True)
class Surface:
    """How triangles look; colours sRGB.

    `picture`: a path, a PIL image, or None; `pattern`: a drawn one; `brightness`: times the
    diffuse colour in linear units; `alpha_test`: what of the picture has less alpha is not drawn;
    `blended`: the picture's alpha makes it transparent; `double_sided`: its faces are seen from
    behind, too; `layers`: of a terrain, instead of a
    picture and colours: texture coordinates are m from its corner of least x and greatest y then,
    and `base` is the height, m, from which those of the layers count.
    """

    diffuse: Color = GREY
    specular: Color = _DULL
    emissive: Color = _DULL
    picture: Any = None
    pattern: str = ""
    repeats: Tuple[float, float] = (1.0, 1.0)
    opacity: float = 1.0
    lit: bool = True
    brightness: float = 1.0
    alpha_test: float = 0.0
    blended: bool = False
    double_sided: bool = False
    layers: Tuple[TerrainLayer, ...] = ()
    base: float = 0.0

    @property
    def clear(self) -> bool:
        """Whether what is behind may be seen through it."""
        return self.opacity < 1.0 or self.blended


@dataclass(frozen=True)
class Piece:
    """Triangles to be drawn: float32 rows of place, normal and uv (n, 8), and int32 (m, 3)."""

    rows: np.ndarray
    triangles: np.ndarray
    surface: Surface


def pieces_of(visual: Visual, look: Optional[Look]) -> List[Piece]:
    """What a visual is drawn as, in its own frame.

    Raises InputError: a mesh or its like cannot be read.
    """
    opacity = 1.0 - visual.transparency
    shape = visual.geometry
    speaks = look is not None and bool(look.diffuse or look.ambient or look.emissive
                                       or look.texture or look.pattern)
    if isinstance(shape, SOLIDS):
        # A world without a mesh has its first picture earlier.
        from ..formats.mesh.loading import load_solid
        from ..formats.mesh.painted import painted_parts, shade_flat, shade_smooth

        parts = (painted_parts(shape) if isinstance(shape, Mesh)
                 else [shade_smooth(load_solid(shape))] if isinstance(shape, Heightmap)
                 else [shade_flat(load_solid(shape))])
        if look is not None and look.layers and isinstance(shape, Heightmap):
            return [_terrain(parts[0], look.layers, shape.position[2], opacity)]
        return [piece_of(part.vertices, part.normals, part.uv, part.triangles,
                         surface_of(look, opacity) if speaks else own_surface(part, opacity))
                for part in parts]
    made = triangles_of(shape, _SIDES)
    if made is None or made.normals is None or made.uv is None:
        return []
    surface = surface_of(look, opacity)
    if isinstance(shape, Plane):
        surface = replace(surface, brightness=GROUND)
    size = picture_size_of(visual) if isinstance(shape, Box) else None
    uv = made.uv if size is None else repeated_uv(made.vertices, made.normals, visual.pose, size)
    return [piece_of(made.vertices, made.normals, uv, made.triangles, surface)]


def _terrain(part: Any, layers: Tuple[TerrainLayer, ...], base: float, opacity: float) -> Piece:
    corner = part.vertices[:, 0].min(), part.vertices[:, 1].max()
    return piece_of(part.vertices, part.normals, part.vertices[:, :2] - corner, part.triangles,
                    Surface(layers=layers, base=base, opacity=opacity))


def own_surface(part: Any, opacity: float) -> Surface:
    """Return the surface of a part of a mesh (`formats.mesh.painted`) by its file."""
    paint = part.paint
    color = paint.color or _OF_MESH
    return Surface(color, emissive=paint.emission or _DULL, picture=paint.picture,
                   opacity=opacity * color[3], alpha_test=paint.alpha_test, blended=paint.blended,
                   double_sided=paint.double_sided)


def piece_of(vertices: np.ndarray, normals: np.ndarray, uv: np.ndarray, triangles: np.ndarray,
             surface: Surface) -> Piece:
    """Vertices, normals and texture coordinates of each corner, in the renderer's form."""
    rows = np.column_stack([vertices, normals, uv]).astype(np.float32)
    return Piece(np.ascontiguousarray(rows), np.ascontiguousarray(triangles, dtype=np.int32),
                 surface)


def surface_of(look: Optional[Look], opacity: float) -> Surface:
    """A material as the editor's page reads it."""
    if look is None:
        return Surface(opacity=opacity)
    textured = bool(look.texture or look.pattern)
    white: Color = (1.0, 1.0, 1.0, 1.0)
    diffuse = look.diffuse or look.ambient or (white if textured else GREY)
    specular = look.specular or _DULL
    if max(specular[:3]) <= DULLEST:
        specular = _DULL
    return Surface(diffuse, specular, look.emissive or _DULL, look.texture or None,
                   look.pattern, (1.0 / (look.scale[0] or 1.0), 1.0 / (look.scale[1] or 1.0)),
                   (1.0 - look.transparency) * opacity, look.lit,
                   alpha_test=look.alpha_test, blended=look.blended, double_sided=look.double_sided)
