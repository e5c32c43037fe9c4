"""Materials of mesh files, as cameras draw them."""
from __future__ import annotations

from typing import Any, Dict, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from ...description.shapes import Color

Array = Any  # a NumPy array; its shape is documented at each use

HOLE = 0.004
"""Alpha below which a pixel of a picture is left out, unless the file says otherwise."""

_WHITE = (1.0, 1.0, 1.0)


class Paint(NamedTuple):
    """Colours, in sRGB, and picture of triangles.

    Attributes:
        color: diffuse colour, times the picture; its alpha is the opacity. None without a material.
        picture: texture: a path that may not exist, a decoded PIL image, or None.
        emission: what it glows, times the picture; None for nothing.
        blended: whether the picture's alpha makes it transparent.
        alpha_test: what of the picture has less alpha is not drawn.
        double_sided: cameras see it from behind, too. COLLADA's element of that name has no effect,
            as in Gazebo.
    """

    color: Optional[Color] = None
    picture: Any = None
    emission: Optional[Color] = None
    blended: bool = False
    alpha_test: float = HOLE
    double_sided: bool = False


def correct_opacity(opacity: float) -> float:
    """Old exporters call wholly transparent what is opaque; else it would be nothing at all."""
    return min(opacity, 1.0) if opacity > 0.0 else 1.0


def paint_of(material: Any) -> Paint:
    """Return the paint of a material of trimesh (OBJ, glTF, PLY)."""
    if material is None:
        return Paint()
    if hasattr(material, "baseColorFactor"):
        return _of_gltf(material)
    told: Dict[str, Any] = getattr(material, "kwargs", None) or {}
    emission, opacity = glow_of(told.get("ke")), _read_opacity(told)
    picture, color = getattr(material, "image", None), getattr(material, "diffuse", None)
    rgb = _WHITE if picture is not None or color is None else _rgb(color)
    return Paint((*rgb, opacity), picture, emission)


def _read_opacity(told: Dict[str, Any]) -> float:
    """The opacity of a material of an MTL file: `d`, or 1 - `Tr`."""
    try:
        if "d" in told:
            return correct_opacity(float(told["d"][-1]))
        return correct_opacity(1.0 - float(told["tr"][-1])) if "tr" in told else 1.0
    except ValueError:
        return 1.0


def _of_gltf(material: Any) -> Paint:
    """glTF tells factors in linear units, pictures in sRGB (glTF 2.0, 3.9.2)."""
    factor, picture = material.baseColorFactor, material.baseColorTexture
    rgb = _WHITE if factor is None else _srgb(_rgb(factor))
    emission = None
    if material.emissiveTexture is None or material.emissiveTexture is picture:
        glow = glow_of(tuple(material.emissiveFactor) if material.emissiveFactor is not None
                     else None)
        emission = None if glow is None else (*_srgb(glow[:3]), 1.0)
    blends = material.alphaMode == "BLEND"
    opacity = correct_opacity(float(factor[3]) / 255.0) if blends and factor is not None else 1.0
    cutoff = 0.5 if material.alphaCutoff is None else float(material.alphaCutoff)
    return Paint((*rgb, opacity), picture, emission,
                 blends and picture is not None and picture.mode not in ("RGB", "L", "1"),
                 cutoff if material.alphaMode == "MASK" else HOLE if blends else 0.0,
                 bool(material.doubleSided))


def _rgb(color: Any) -> Tuple[float, float, float]:
    return float(color[0]) / 255.0, float(color[1]) / 255.0, float(color[2]) / 255.0


def linear_to_srgb(linear: Array) -> Array:
    """Convert linear colour components to sRGB, 0 to 1."""
    found: Array = np.where(linear <= 0.0031308, 12.92 * linear,
                            1.055 * np.clip(linear, 0.0, 1.0) ** (1.0 / 2.4) - 0.055)
    return found


def _srgb(linear: Sequence[float]) -> Tuple[float, float, float]:
    red, green, blue = map(float, linear_to_srgb(np.array(linear)))
    return red, green, blue


def glow_of(parts: Any) -> Optional[Color]:
    """A colour that is not black; None for pictures."""
    if not isinstance(parts, (tuple, list)) or len(parts) < 3 or not any(parts[:3]):
        return None
    return (float(parts[0]), float(parts[1]), float(parts[2]), 1.0)
