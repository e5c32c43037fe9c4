"""An OpenGL context without a window, on EGL: Mesa draws where there is no graphics card."""
from __future__ import annotations

import ctypes
from typing import Any, Callable, Dict, Tuple

from ..api import SensingError, SensingUnavailableError

_EGL: Dict[str, Any] = {"backend": "egl"}
_PACKAGES = "libegl1 libegl-mesa0 libgl1 libgl1-mesa-dri"


def new_context() -> Any:
    """A context, current in this thread.

    Raises SensingUnavailableError: something is not installed; says what.
    """
    try:
        import moderngl
    except ImportError as fault:
        raise SensingUnavailableError("cameras need the Python package 'moderngl', which cannot be "
                                      f"imported ({fault}): pip install moderngl") from None
    try:
        context = moderngl.create_context(standalone=True, require=330, **_EGL)
    except Exception as fault:  # each of its back ends fails in its own way
        raise SensingUnavailableError(
            f"cameras need OpenGL 3.3 on EGL, which is not available ({fault}): "
            f"apt install {_PACKAGES}") from None
    return context


def draws_with_a_card(context: Any) -> bool:
    """Whether it is not the processor that draws."""
    name = str(context.info.get("GL_RENDERER", "")).lower()
    return not any(word in name for word in ("llvmpipe", "softpipe", "swrast", "software"))


def load_gl_finish() -> Callable[[], object]:
    """Return a glFinish that releases the GIL while it waits; moderngl's does not."""
    egl = ctypes.CDLL("libEGL.so.1")
    egl.eglGetProcAddress.restype = ctypes.c_void_p
    egl.eglGetProcAddress.argtypes = [ctypes.c_char_p]
    return ctypes.CFUNCTYPE(None)(egl.eglGetProcAddress(b"glFinish"))


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
