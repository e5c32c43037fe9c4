"""The lens of a wide-angle camera, from its description. Source: Gazebo's CameraLens."""
from __future__ import annotations

import math
from typing import Callable, Mapping, Tuple

from ...description.sensor import Camera
from ...sensing.api import WideLens
from ..context import PluginError

WIDE_ANGLE = "wideanglecamera"
"""The type of its sensor."""

_TYPES: Mapping[str, Tuple[float, float, str]] = {
    "gnomonical": (1.0, 1.0, "tan"), "stereographic": (2.0, 2.0, "tan"),
    "equidistant": (1.0, 1.0, "id"), "equisolid_angle": (2.0, 2.0, "sin"),
    "orthographic": (1.0, 1.0, "sin")}
"""c1, c2 and fun; c3 is 0 and f is 1."""

_FUNCTIONS: Mapping[str, Callable[[float], float]] = {
    "tan": math.tan, "sin": math.sin, "id": float}


def wide_lens_of(block: Camera, hfov: float) -> WideLens:
    """Return the lens of a camera whose horizontal field of view is `hfov`, rad.

    Raises PluginError: its `<lens>` is unknown, or does not see that field of view.
    """
    lens = block.lens
    c1, c2, c3, f, fun = lens.c1, lens.c2, lens.c3, lens.f, lens.fun
    if lens.type != "custom":
        if lens.type not in _TYPES:
            raise PluginError(f"<lens><type> of camera {block.name!r} is {lens.type!r}; there are"
                              f" {', '.join((*_TYPES, 'custom'))}")
        (c1, c2, fun), c3, f = _TYPES[lens.type], 0.0, 1.0
    if fun not in _FUNCTIONS:
        raise PluginError(f"<lens><custom_function><fun> of camera {block.name!r} is {fun!r};"
                          f" there are {', '.join(_FUNCTIONS)}")
    scale = c1 * f
    if lens.scale_to_hfov and c2 > 0.0:
        edge = hfov / 2.0 / c2 + c3
        within = fun == "id" or 0.0 < edge < math.pi / 2.0
        scale = 1.0 / _FUNCTIONS[fun](edge) if within and edge > 0.0 else 0.0
    if not (c2 > 0.0 and 0.0 < scale < math.inf):
        raise PluginError(f"the <lens> of camera {block.name!r} does not see a field of view of"
                          f" {hfov:g} rad")
    return WideLens(scale, c2, c3, fun, min(lens.cutoff_angle, math.pi), lens.env_texture_size)
