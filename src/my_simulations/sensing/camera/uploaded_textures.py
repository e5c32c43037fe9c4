"""Textures of surfaces, read or drawn once, and uploaded."""
from __future__ import annotations

import weakref
from collections import deque
from itertools import chain
from typing import Any, Callable, Deque, Dict, Optional, Tuple

import numpy as np

from ...appearance.palette import GREY
from ...appearance.terrain_layers import TerrainLayer
from ..surfaces import Surface

_SRGB = 0x8C43  # GL_SRGB8_ALPHA8


class Textures:
    """The textures of one context.

    Args:
        context: of moderngl.
        report_problem: is told of pictures that cannot be read.
    """

    def __init__(self, context: Any, trouble: Callable[[str], None]) -> None:
        self._context, self._trouble = context, trouble
        self._made: Dict[Any, Any] = {}
        self._states: Dict[str, Optional[Tuple[str, int, int]]] = {}   # of the files, by picture
        self._gone: Deque[int] = deque()   # ids of pictures that were, whose textures are to go

    def of(self, surface: Surface) -> Any:
        """The texture of a surface; None where it has none, or one that cannot be read."""
        if surface.picture is None and not surface.pattern:
            return None
        self._release_gone()
        key = surface.picture if isinstance(surface.picture, str) else (
            id(surface.picture) if surface.picture is not None else ("pattern", surface.pattern))
        if key not in self._made:
            from .pictures import draw_pattern, read_picture  # not before there is a texture

            pixels = (read_picture(surface.picture) if surface.picture is not None
                      else draw_pattern(surface.pattern))
            if pixels is None and surface.picture is not None:
                self._trouble(f"the picture {surface.picture} cannot be read: cameras see its "
                              "material without")
            self._made[key] = None if pixels is None else self._upload_pixels(pixels)
            if isinstance(key, int):
                # Another picture may get its id then; what draws it keeps the picture until then.
                weakref.finalize(surface.picture, self._gone.append, key)
        return self._made[key]

    def renew(self, surface: Surface) -> None:
        """Forget the surface's pictures whose files are others than at the last call.

        For surfaces that are made: the pictures of the others are not looked at again.
        """
        for path in (surface.picture, *chain.from_iterable((layer.texture, layer.normal)
                                                           for layer in surface.layers)):
            if not path or not isinstance(path, str):
                continue
            from .pictures import state_of

            before, now = self._states.get(path), state_of(path)
            self._states[path] = now
            if before != now:
                for key in (path, ("bumps", path)):
                    texture = self._made.pop(key, None)
                    if texture is not None:
                        texture.release()

    def _release_gone(self) -> None:
        """In the thread of the context: pictures end in any."""
        while self._gone:
            texture = self._made.pop(self._gone.popleft(), None)
            if texture is not None:
                texture.release()

    def of_layer(self, layer: TerrainLayer) -> Any:
        """The texture of a terrain's layer: grey where it has none that can be read."""
        texture = self.of(Surface(picture=layer.texture or None, pattern=layer.pattern))
        if texture is None and None not in self._made:
            grey = [round(255 * part) for part in GREY]
            self._made[None] = self._upload_pixels(np.array([[grey]], dtype=np.uint8))
        return self._made[None] if texture is None else texture

    def bumps_of(self, layer: TerrainLayer) -> Any:
        """The normal map of a terrain's layer; None where it has none that can be read."""
        if not layer.normal:
            return None
        key = ("bumps", layer.normal)
        if key not in self._made:
            from .pictures import read_picture

            pixels = read_picture(layer.normal)
            if pixels is None:
                self._trouble(f"the picture {layer.normal} cannot be read: cameras see its "
                              "terrain without")
            self._made[key] = None if pixels is None else self._upload_pixels(pixels, 0)
        return self._made[key]

    def cutting(self, surface: Surface) -> Any:
        """The texture where it has parts that the surface leaves out; else None.

        A picture that cannot have any is not read for it.
        """
        if surface.alpha_test <= 0.0 or not _may_have_holes(surface.picture):
            return None
        texture = self.of(surface)
        return texture if texture is not None and texture.extra else None

    def _upload_pixels(self, pixels: np.ndarray, form: int = _SRGB) -> Any:
        """`form`: of OpenGL; 0 for numbers as they are."""
        height, width = pixels.shape[:2]
        texture = self._context.texture((width, height), 4, np.ascontiguousarray(pixels).tobytes(),
                                        internal_format=form or None)
        texture.build_mipmaps()
        texture.filter = (self._context.LINEAR_MIPMAP_LINEAR, self._context.LINEAR)
        texture.repeat_x = texture.repeat_y = True
        texture.extra = bool((pixels[..., 3] < 255).any())  # what may be seen through
        return texture


def _may_have_holes(picture: Any) -> bool:
    """Whether a path or PIL image may have alpha; drawn patterns have none."""
    if isinstance(picture, str):
        return not picture.lower().endswith((".jpg", ".jpeg"))
    return picture is not None and (picture.mode not in ("RGB", "L", "1")
                                    or "transparency" in picture.info)
