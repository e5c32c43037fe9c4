"""Colours of corners of triangles, drawn as a picture: what draws meshes knows pictures only."""
from __future__ import annotations

import math
from typing import Any, Optional, Tuple

import numpy as np

from .paint import Array, Paint, encoded

_MOST_KINDS = 512 * 512
"""Blocks of 2 x 2 pixels in the largest picture that cameras do not make smaller."""
_CORNERS = np.array([(0.5, 0.5), (1.5, 0.5), (0.5, 1.5)])
_MIDDLE = np.array([(1.0, 1.0)] * 3)


def colored(shape: Any, faces: Array, uv: Optional[Array], paint: Paint,
            ) -> Tuple[Optional[Array], Paint]:
    """Texture coordinates (3 m, 2) and paint of a mesh of trimesh with its corners' colours.

    `faces`: of it, in the order in which they are drawn. Colours are ignored if there is a picture.
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
    return np.rint(encoded(np.clip(parts, 0.0, 1.0)) * 255.0).astype(np.uint8)


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
