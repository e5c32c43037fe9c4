"""Where pictures are drawn to: one buffer for each kind and size, made once."""
from __future__ import annotations

from typing import Any, Dict, Tuple


class Targets:
    """The frame buffers of one context."""

    def __init__(self, context: Any) -> None:
        self._context = context
        self._made: Dict[Tuple[str, int, int, int], Any] = {}

    def get(self, kind: str, width: int, height: int, samples: int) -> Any:
        """A buffer of `range` (depth and labels) or `rgb`, that of `samples` a pixel."""
        key = (kind, width, height, samples)
        found = self._made.get(key)
        if found is None:
            context, size = self._context, (width, height)
            if kind == "range":
                found = context.framebuffer(
                    [context.texture(size, 1, dtype="f4"), context.texture(size, 1, dtype="i4")],
                    context.depth_renderbuffer(size))
            else:
                many = samples if samples > 1 else 0
                found = context.framebuffer([context.renderbuffer(size, 4, samples=many)],
                                            context.depth_renderbuffer(size, samples=many))
            self._made[key] = found
        return found
