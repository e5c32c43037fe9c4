"""Numbers of looks that the editor's page and the cameras share.

The page gets them as a module: tools/generate/page_palette.py writes web/js/palette.ts, and a
test compares it.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import Dict, NamedTuple, Tuple

GREY = (0.7, 0.7, 0.7, 1.0)
"""Of what has no material."""

SHAPE_COLORS: Dict[str, Tuple[float, float, float, float]] = {
    "box": (0.93, 0.62, 0.33, 1.0), "sphere": (0.36, 0.62, 0.87, 1.0),
    "cylinder": (0.45, 0.73, 0.51, 1.0), "capsule": (0.66, 0.56, 0.83, 1.0),
    "cone": (0.85, 0.47, 0.50, 1.0), "ellipsoid": (0.35, 0.70, 0.72, 1.0),
}
"""Of the shapes that the editor inserts, by type. They are easier to tell apart than grey ones."""

GROUND = 0.8
"""How bright planes are: on a ground of the same grey, objects would have no outlines."""

DULLEST = 0.02
"""Highlights weaker than this are not worth their computing."""

SHININESS = 30.0
"""Exponent of highlights."""


class Sky(NamedTuple):
    """Colours of the sky, sRGB as 0xrrggbb."""

    day_zenith: int = 0x3F78C0
    day_horizon: int = 0xC9DCEC
    night_zenith: int = 0x05070F
    night_horizon: int = 0x141A28
    dusk: int = 0xE8A468


SKY = Sky()

SKY_COLOR = """uniform vec3 sun, zenith, horizon, cloud_color;
uniform float cover, size, drift;
float hash(vec2 p) { return fract(sin(dot(p, vec2(127.1, 311.7))) * 43758.5453); }
float noise(vec2 p) {
  vec2 i = floor(p), f = fract(p);
  f = f * f * (3.0 - 2.0 * f);
  return mix(mix(hash(i), hash(i + vec2(1, 0)), f.x),
             mix(hash(i + vec2(0, 1)), hash(i + vec2(1, 1)), f.x), f.y);
}
vec3 sky(vec3 way) {
  vec3 color = mix(horizon, zenith, pow(max(way.z, 0.0), 0.45));
  float glow = max(dot(way, sun), 0.0);
  color += vec3(1.0, 0.85, 0.6) * (pow(glow, 900.0) + 0.18 * pow(glow, 12.0)) * step(-0.05, sun.z);
  if (way.z > 0.01) {
    vec2 at = way.xy / (way.z + 0.12) / size + vec2(drift, 0.0);
    float density = 0.0, part = 0.55;
    for (int octave = 0; octave < 5; octave++) {
      density += part * noise(at);
      at *= 2.1;
      part *= 0.5;
    }
    float cloud = smoothstep(1.0 - cover, 1.15 - 0.3 * cover, density);
    cloud *= smoothstep(0.01, 0.2, way.z);
    color = mix(color, cloud_color, cloud * 0.85);
  }
  return color;
}
"""
"""GLSL: linear colour of the sky in a direction: a gradient, the sun's disc, clouds of noise."""


@dataclass(frozen=True)
class Pattern:
    """A picture that is drawn.

    Attributes:
        painter: plain, planks, bricks, tiles, road or checker.
        colors: sRGB as 0xrrggbb; the first is the ground's, save of tiles and planks.
        count: of planks, rows of bricks, tiles along a side, or lanes.
        grain: strength of the noise put over it, of 255.
    """

    painter: str
    colors: Tuple[int, ...]
    count: int = 1
    grain: int = 0


PATTERNS: Dict[str, Pattern] = {
    "wood": Pattern("planks", (0xA9743F, 0x9E6A37), 4, 14),
    "wood_floor": Pattern("planks", (0xB98A54, 0xA97B47, 0xC2935C), 8, 12),
    "bricks": Pattern("bricks", (0xB9B2A6, 0x964A38), 8, 22),
    "ceiling_tiled": Pattern("tiles", (0xE9E8E2, 0xA5A39B), 2, 16),
    "painted_wall": Pattern("plain", (0xE6E0CF,), 1, 8),
    "concrete": Pattern("tiles", (0x8FA9BD, 0xD8D4C8), 4, 6),
    "road": Pattern("road", (0x4B4B4D, 0xE9E7DD), 2, 16),
    "sidewalk": Pattern("tiles", (0xB5B1A8, 0x8F8B83), 4, 18),
    "steps": Pattern("tiles", (0xA8A39A, 0x7C7870), 3, 18),
    "grass": Pattern("plain", (0x5F8A3A,), 1, 60),
    "dirt": Pattern("plain", (0x8F7760,), 1, 60),
    "fungus": Pattern("plain", (0x828169,), 1, 90),
    "granite": Pattern("plain", (0x77726D,), 1, 90),
    "com": Pattern("checker", (0xF4D616, 0x111111)),
}
"""By the names that `gazebo_materials` uses."""
