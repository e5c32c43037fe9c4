"""Materials of COLLADA files, as Gazebo shows them."""
from __future__ import annotations

import os
from typing import Any, Dict, Optional
from urllib.parse import unquote

from ...description.shapes import Color
from .paint import Paint, correct_opacity, glow_of

_SHADERS = ("phong", "lambert", "blinn", "constant")
_LUMINANCE = 0.212671, 0.715160, 0.072169


class ColladaMaterials:
    """The materials of a document. Pictures with transparency are ignored (Gazebo behaviour)."""

    def __init__(self, root: Any) -> None:
        self._found: Dict[str, Dict[str, Any]] = {
            kind: {one.get("id"): one for one in root.iter(f"{{*}}{kind}")}
            for kind in ("material", "effect", "image")}

    def paint_of(self, url: str, folder: str) -> Paint:
        """Return the paint of a material; `folder` contains its pictures."""
        effect = self._effect_of(url)
        shader = None if effect is None else _shader_of(effect)
        if shader is None:
            return Paint()
        emission, picture = glow_of(_color_of(shader, "emission")), self.picture_of(url)
        if picture is None and shader.find("{*}diffuse") is None:
            return Paint(emission=emission)
        red, green, blue, _ = _color_of(shader, "diffuse") or (1.0, 1.0, 1.0, 1.0)
        color = (red, green, blue, _opacity_of(shader))
        if picture is None:
            return Paint(color, None, emission)
        path = unquote((picture.text or "").strip())
        path = path[len("file://"):] if path.startswith("file://") else path
        return Paint(color, os.path.join(folder, path), emission)

    def picture_of(self, url: str) -> Optional[Any]:
        """The element with the file name of a material's picture; None for no picture.

        That of its diffuse colour, else one that it has for another: a material has one picture
        (Gazebo behaviour).
        """
        effect = self._effect_of(url)
        shader = None if effect is None else _shader_of(effect)
        if effect is None or shader is None:
            return None
        kind = shader.tag.rpartition("}")[2]
        for use in ("diffuse", *(["specular"] if kind in ("phong", "blinn") else []),
                    *(["emission", "ambient"] if kind != "constant" else [])):
            texture = shader.find(f"{{*}}{use}/{{*}}texture")
            image = None if texture is None else self._sampled_image(
                effect, texture.get("texture", ""))
            source = None if image is None else image.find(".//{*}init_from")
            if source is not None:
                ref = source.find("{*}ref")
                return source if ref is None else ref
        return None

    def _effect_of(self, url: str) -> Optional[Any]:
        material = self._target("material", url)
        instance = None if material is None else material.find("{*}instance_effect")
        return None if instance is None else self._target("effect", instance.get("url", ""))

    def _target(self, kind: str, url: str) -> Optional[Any]:
        return self._found[kind].get(url.rpartition("#")[2])

    def _sampled_image(self, effect: Any, name: str) -> Optional[Any]:
        """The image of a sampler (COLLADA 1.4 or 1.5), or the image that has this id itself."""
        parameters = {one.get("sid"): one for one in effect.iter("{*}newparam")}
        images, sampler = self._found["image"], parameters.get(name)
        if sampler is None:
            return images.get(name)
        direct = sampler.find(".//{*}instance_image")
        if direct is not None:
            return self._target("image", direct.get("url", ""))
        surface = parameters.get((sampler.findtext(".//{*}source") or "").strip())
        named = None if surface is None else surface.findtext(".//{*}init_from")
        return images.get((named or "").strip())


def _shader_of(effect: Any) -> Optional[Any]:
    """The element with the colours of an effect; None if none is known."""
    found = (effect.find(f".//{{*}}technique/{{*}}{kind}") for kind in _SHADERS)
    return next((shader for shader in found if shader is not None), None)


def _color_of(shader: Any, use: str) -> Optional[Color]:
    """A colour such as "diffuse"; None where a picture or nothing valid is in its place."""
    text = shader.findtext(f"{{*}}{use}/{{*}}color")
    try:
        parts = [float(part) for part in text.split()] if text is not None else None
    except ValueError:
        return None
    if parts is None:
        return None
    red, green, blue, alpha = (*parts, *(0.0, 0.0, 0.0, 1.0)[len(parts):])[:4]
    return (red, green, blue, alpha)


def _opacity_of(shader: Any) -> float:
    """1 unless `<transparent opaque="...">` says how its colour is meant (Gazebo behaviour)."""
    color, element = _color_of(shader, "transparent"), shader.find("{*}transparent")
    if color is None:
        return 1.0
    written = shader.find("{*}transparency")
    try:
        times = 1.0 if written is None else float(written.findtext("{*}float") or "")
    except ValueError:
        return 1.0
    luminance = sum(part * weight for part, weight in zip(color, _LUMINANCE))
    found = {"A_ONE": color[3] * times, "A_ZERO": 1.0 - color[3] * times,
             "RGB_ONE": luminance * times, "RGB_ZERO": 1.0 - luminance * times}
    return correct_opacity(found.get(element.get("opaque"), 1.0))
