"""Checks the textures and blends of a heightmap, and finds relative ones."""
from __future__ import annotations

from typing import Any

from ...appearance.terrain_layers import substitute_pattern
from ...description.shapes import Heightmap, TerrainTexture
from ...resources.resolver import ResourceNotFoundError
from ..xml.source import Source

_PLACEHOLDER = "__default__"


def check_textures(heightmap: Heightmap, shape: Any, source: Source) -> None:
    """Report images that are missing, sizes and numbers that cannot be drawn.

    URIs that are relative to the file become absolute. Source: SDF spec 1.7, heightmap.

    Args:
        heightmap: of a visual, with its textures and blends as written.
        shape: the element `<heightmap>`.
        source: receives warnings.
    """
    for texture, element in zip(heightmap.textures, shape.iterfind("texture")):
        texture.diffuse = _found(texture.diffuse, "texture", element, source)
        texture.normal = _found(texture.normal, "normal map", element, source)
        if texture.size <= 0.0:
            usual = TerrainTexture().size
            source.warn("bad-value", f"<size> of <texture> must be greater than 0;"
                        f" {usual:g} m is used", element)
            texture.size = usual
    textures, blends = len(heightmap.textures), len(heightmap.blends)
    if textures and blends != textures - 1:
        source.warn("terrain-blends", f"a heightmap of {textures} textures needs"
                    f" {textures - 1} <blend>, not {blends}; "
                    + ("the last ones are unused" if blends >= textures else
                       "the last textures are not seen"), shape)


def _found(uri: str, what: str, element: Any, source: Source) -> str:
    """The URI, absolute where it is a path; with a warning where it leads nowhere."""
    if not uri or uri == _PLACEHOLDER:
        return ""
    try:
        path = source.resolve(uri, element)
    except ResourceNotFoundError as missing:
        if substitute_pattern(uri) is None:
            without = "grey is shown instead" if what == "texture" else "it is left out"
            text, hint = source.resolver.explain(
                missing, "check the path, GAZEBO_MODEL_PATH and GAZEBO_RESOURCE_PATH")
            source.warn("image-not-found", f"the {what} of this heightmap {text}; {without}",
                        element, hint)
        return uri
    return uri if "://" in uri else path
