"""Colours in linear units, and the sky by the hour, as on the editor's page."""
from __future__ import annotations

import math
from typing import Any, Dict, Sequence, Tuple

import numpy as np

from ...appearance.palette import SKY
from ...description.surroundings import Fog, Sky


def srgb_to_linear(color: Sequence[float]) -> np.ndarray:
    """Convert an sRGB colour (0 to 1) to linear components, (3,)."""
    part = np.clip(np.array(color[:3], dtype=float), 0.0, 1.0)
    return np.where(part <= 0.04045, part / 12.92, ((part + 0.055) / 1.055) ** 2.4)


def _hex(value: int) -> np.ndarray:
    return srgb_to_linear([(value >> shift & 255) / 255.0 for shift in (16, 8, 0)])


_DAY = _hex(SKY.day_zenith), _hex(SKY.day_horizon)
_NIGHT = _hex(SKY.night_zenith), _hex(SKY.night_horizon)
_DUSK = _hex(SKY.dusk)


def sky_uniforms(sky: Sky) -> Dict[str, Any]:
    """What the sky's shader wants to know: hours put the sun and its colours where they belong."""
    day = sky.sunset - sky.sunrise
    part = (sky.time - sky.sunrise) / day if day > 0 else 0.5
    elevation = math.sin(math.pi * part)
    sun = np.array([math.cos(math.pi * part), -0.25, elevation])
    light = min(max(elevation * 3 + 0.15, 0.0), 1.0)
    dusk = max(0.0, 0.6 - abs(elevation) * 2.5)
    zenith = _NIGHT[0] + (_DAY[0] - _NIGHT[0]) * light
    horizon = _NIGHT[1] + (_DAY[1] - _NIGHT[1]) * light
    return {
        "sun": tuple(sun / np.linalg.norm(sun)), "zenith": tuple(zenith),
        "horizon": tuple(horizon + (_DUSK - horizon) * dusk),
        "cloud_color": tuple(srgb_to_linear(sky.cloud_ambient) * (1.15 * light + 0.05)),
        "cover": min(max(sky.cloud_humidity, 0.0), 1.0), "size": 0.6 + sky.cloud_mean_size,
        "drift": sky.cloud_direction}


def fog_law(fog: Fog) -> Tuple[str, float]:
    """Law (as in `shaders.LitKind`) and density, 1/m, of a fog; see `Fog`."""
    if fog.type in ("linear", "exp", "exp2"):
        return fog.type, max(fog.density, 0.0)
    return "exp2", fog.density * (0.5 if fog.type == "quadratic" else 1.0) / 10.0
