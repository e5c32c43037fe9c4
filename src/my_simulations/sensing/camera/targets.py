"""Where pictures are drawn to: one buffer for each kind and size, made once."""
from __future__ import annotations

from typing import Any, Dict, Tuple

from ..api import SensingError


class Targets:
    """The frame buffers of one context.

    Attributes:
        most: pixels a side.
    """

    def __init__(self, context: Any) -> None:
        self._context = context
        self._made: Dict[Tuple[str, int, int, int], Any] = {}
        self.most = int(min(context.info["GL_MAX_TEXTURE_SIZE"],
                            context.info["GL_MAX_RENDERBUFFER_SIZE"]))

    def get(self, kind: str, width: int, height: int, samples: int) -> Any:
        """A buffer of `range` (depth and labels) or `rgb`, that of `samples` a pixel.

        Raises SensingError where there is no memory for it.
        """
        key = (kind, width, height, samples)
        found = self._made.get(key)
        if found is None:
            import moderngl

            try:
                found = self._made[key] = self._new(kind, (width, height), samples)
            except moderngl.Error as fault:
                raise SensingError(f"a picture of {width} x {height} pixels cannot be drawn here: "
                                   f"{fault}") from None
        return found

    def _new(self, kind: str, size: Tuple[int, int], samples: int) -> Any:
        context = self._context
        if kind == "range":
            return context.framebuffer(
                [context.texture(size, 1, dtype="f4"), context.texture(size, 1, dtype="i4")],
                context.depth_renderbuffer(size))
        many = samples if samples > 1 else 0
        return context.framebuffer([context.renderbuffer(size, 4, samples=many)],
                                   context.depth_renderbuffer(size, samples=many))
