"""A material ready for drawing."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Optional, Tuple

from ..description.shapes import Color
from .terrain_layers import TerrainLayer


@dataclass(frozen=True)
class Look:
    """A resolved material, as drawn by the editor's page and by cameras.

    Attributes:
        name: name of the material.
        ambient, diffuse, specular, emissive: r, g, b, a in 0..1; None for those of the mesh.
        texture: path of an image; "" for none.
        pattern: name of a generated image (see `gazebo_materials`); "" for none.
        scale: size of one repetition of the texture in texture coordinates, u and v.
        transparency: 0 opaque to 1 invisible.
        lit: False ignores all lights.
        alpha_test: what of the texture has less alpha, 0..1, is not drawn at all; 0 for no such
            limit.
        blended: the texture's alpha makes it transparent.
        double_sided: cameras see its faces from behind, too.
        layers: textures of a terrain, blended by height; empty for everything else. They take the
            place of colours and texture.
    """

    name: str = ""
    ambient: Optional[Color] = None
    diffuse: Optional[Color] = None
    specular: Optional[Color] = None
    emissive: Optional[Color] = None
    texture: str = ""
    pattern: str = ""
    scale: Tuple[float, float] = (1.0, 1.0)
    transparency: float = 0.0
    lit: bool = True
    alpha_test: float = 0.0
    blended: bool = False
    double_sided: bool = False
    layers: Tuple[TerrainLayer, ...] = ()
