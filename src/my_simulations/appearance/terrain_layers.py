"""What terrains are covered with: textures one above the other, blended by height."""
from __future__ import annotations

import posixpath
from dataclasses import dataclass
from typing import Dict, Optional, Tuple

from ..description.shapes import Heightmap, TerrainBlend, Visual
from ..resources.resolver import Resolver, ResourceNotFoundError

_DRAWN: Dict[str, str] = {"dirt_diffusespecular.png": "dirt", "grass_diffusespecular.png": "grass",
                          "fungus_diffusespecular.png": "fungus"}
"""Gazebo's own pictures of terrains: the generated images that replace them, by file name."""

_FLAT = frozenset(("flat_normal.png", "dirt_normal.png", "grass_normal.png", "fungus_normal.png"))
"""Gazebo's own normal maps; terrains do without them."""

_SHORTEST_FADE = 1e-6
"""Distance, m, in place of 0: a sharp border."""


@dataclass(frozen=True)
class TerrainLayer:
    """A texture of a terrain, ready for drawing.

    With `h` the height of a point above `Heightmap.position`, in m, a layer replaces the ones
    before it by the part clamp((h - min_height) / fade_dist, 0, 1); the first one covers all.
    A repetition of the image is `size` wide; the first begins at the corner of least x and
    greatest y of the terrain, upright as seen from above with y upwards. Source: Gazebo's
    Heightmap and Ogre's terrain component.

    Attributes:
        texture: path of the image; "" for none.
        pattern: name of a generated image (see `palette.PATTERNS`); "" for none. Without either
            the layer has the colour `palette.GREY`.
        normal: path of a normal map in tangent space, x along the image's rows; "" for none.
        size: edge length of one repetition, m.
        min_height: height from which on the layer is seen, m; without meaning for the first one.
        fade_dist: height over which it fades in, m, never 0; likewise.
    """

    texture: str = ""
    pattern: str = ""
    normal: str = ""
    size: float = 10.0
    min_height: float = 0.0
    fade_dist: float = 1.0


def substitute_pattern(uri: str) -> Optional[str]:
    """Return the name of the generated pattern that replaces an image of Gazebo's media folder.

    "" for an image that is left out, such as a flat normal map; None for any other image.
    """
    name = posixpath.basename(uri)
    return "" if name in _FLAT else _DRAWN.get(name)


def terrain_layers(visual: Visual, resolver: Resolver) -> Tuple[TerrainLayer, ...]:
    """The layers of a visual, lowest first; none for other shapes and terrains without textures.

    A material that is named covers the terrain in place of its textures (Gazebo behaviour).
    Textures without a blend of their own are not seen, save the first.
    """
    shape = visual.geometry
    if not isinstance(shape, Heightmap) or (visual.material and visual.material.script_name):
        return ()
    blends = [TerrainBlend(), *shape.blends]
    return tuple(
        TerrainLayer(_path_or_empty(one.diffuse, resolver), substitute_pattern(one.diffuse) or "",
                     _path_or_empty(one.normal, resolver), one.size, blend.min_height,
                     blend.fade_dist or _SHORTEST_FADE)
        for one, blend in zip(shape.textures, blends))


def _path_or_empty(uri: str, resolver: Resolver) -> str:
    try:
        return resolver.resolve(uri)
    except ResourceNotFoundError:
        return ""
