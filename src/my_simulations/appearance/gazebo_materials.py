"""Gazebo's built-in materials by name.

Gazebo's texture images are not included; `pattern` names a generated replacement.
Source: the names and colours of Gazebo Classic's `gazebo.material`.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import Dict, Optional, Tuple

Rgb = Tuple[float, float, float]


@dataclass(frozen=True)
class Paint:
    """Colours of a material; `alpha` below 1 is transparent; unlit materials ignore lights."""

    ambient: Rgb
    diffuse: Rgb
    specular: Rgb = (0.1, 0.1, 0.1)
    emissive: Rgb = (0.0, 0.0, 0.0)
    alpha: float = 1.0
    lit: bool = True
    pattern: str = ""
    repeats: float = 1.0


def _grey(value: float) -> Rgb:
    return (value, value, value)


def _plain(color: Rgb, specular: Optional[Rgb] = None, alpha: float = 1.0,
           lit: bool = True) -> Paint:
    return Paint(color, color, specular or _grey(0.1), alpha=alpha, lit=lit)


def _glow(color: Rgb) -> Paint:
    return Paint(color, color, emissive=color)


def _picture(pattern: str, tint: Rgb = (1.0, 1.0, 1.0), repeats: float = 1.0,
             lit: bool = True) -> Paint:
    return Paint(tint, tint, pattern=pattern, repeats=repeats, lit=lit)


_RED, _GREEN, _BLUE = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
_WHITE, _BLACK, _YELLOW = _grey(1.0), _grey(0.0), (1.0, 1.0, 0.0)
_PURPLE, _TURQUOISE = (1.0, 0.0, 1.0), (0.0, 1.0, 1.0)
_ORANGE, _ZINC, _BRIGHT = (1.0, 0.5088, 0.0468), (0.9725, 0.9529, 0.2078), (0.87, 0.26, 0.07)
_GREY = Paint(_grey(0.3), _grey(0.7), _grey(0.01))
_DARK_GREY = Paint(_grey(0.175), _grey(0.175), _grey(0.175))

_COLORS: Dict[str, Paint] = {
    "Grey": _GREY, "Gray": _GREY, "DarkGrey": _DARK_GREY, "DarkGray": _DARK_GREY,
    "White": _plain(_WHITE), "FlatBlack": _plain(_grey(0.1), _grey(0.01)), "Black": _plain(_BLACK),
    "Red": _plain(_RED), "Green": _plain(_GREEN), "Blue": _plain(_BLUE),
    "RedBright": _plain(_BRIGHT, _BRIGHT), "SkyBlue": Paint((0.13, 0.44, 0.70), _BLUE),
    "Yellow": _plain(_YELLOW, _BLACK), "DarkYellow": _plain((0.7, 0.7, 0.0), _BLACK),
    "ZincYellow": _plain(_ZINC, _ZINC), "Purple": _plain(_PURPLE),
    "Turquoise": _plain(_TURQUOISE), "Indigo": _plain((0.33, 0.0, 0.5)),
    "Orange": _plain(_ORANGE, _grey(0.5)),
    "Gold": Paint((0.4, 0.2487, 0.0208), (0.8, 0.6487, 0.1208), _grey(0.4)),
    "Pioneer2Body": Paint((0.4812, 0.0001, 0.0001), (0.6812, 0.0009, 0.0009), _grey(0.5)),
    "WhiteGlow": _glow(_WHITE), "RedGlow": _glow(_RED), "GreenGlow": _glow(_GREEN),
    "BlueGlow": _glow(_BLUE), "YellowGlow": _glow(_YELLOW), "PurpleGlow": _glow(_PURPLE),
    "TurquoiseGlow": _glow(_TURQUOISE), "TurquoiseGlowOutline": _glow(_TURQUOISE),
    "LightOn": _glow(_GREEN), "LightOff": _glow(_RED),
    "JointAnchor": _plain(_WHITE, lit=False), "Editor": _plain(_WHITE),
    "EditorPlane": Paint(_grey(0.3), _grey(0.7), alpha=0.5),
}

_CLEAR: Dict[str, Paint] = {
    **{f"{name}Transparent": _plain(color, alpha=0.5) for name, color in (
        ("Red", _RED), ("Green", _GREEN), ("Blue", _BLUE), ("Yellow", _YELLOW),
        ("Black", _BLACK), ("Grey", _grey(0.5)), ("DarkMagenta", (0.6, 0.0, 0.6)))},
    "OrangeTransparent": _plain((1.0, 0.44, 0.0), alpha=0.4),
    "BlueLaser": _plain(_BLUE, alpha=0.4), "LightBlueLaser": _plain((0.5, 0.5, 1.0), alpha=0.4),
    **{f"{name}TransparentOverlay": _plain(color, alpha=alpha, lit=False)
       for name, color, alpha in (
        ("Red", _RED, 0.5), ("Green", _GREEN, 0.5), ("Blue", _BLUE, 0.5),
        ("Orange", _ORANGE, 0.8), ("DarkOrange", (0.6, 0.305, 0.028), 0.8))},
}

_ROADS = {"Road": "road", "Residential": "road", "Tertiary": "road", "Pedestrian": "sidewalk",
          "Footway": "sidewalk", "Motorway": "road", "Lanes_6": "road", "Trunk": "road",
          "Lanes_4": "road", "Primary": "road", "Lanes_2": "road", "Secondary": "road",
          "Lane_1": "road", "Steps": "steps"}

_PICTURES: Dict[str, Paint] = {
    "CoM": _picture("com"), "WoodFloor": _picture("wood_floor"),
    "CeilingTiled": _picture("ceiling_tiled"), "PaintedWall": _picture("painted_wall"),
    "PioneerBody": _picture("painted_wall", (0.8, 0.1, 0.1)),
    "WoodPallet": _picture("wood"), "Wood": _picture("wood"), "Bricks": _picture("bricks"),
    "BuildingFrame": _picture("concrete"), "Runway": _picture("road"),
    "Grass": _picture("grass", repeats=50.0),
    "GreyGradientSky": _plain(_grey(0.8), lit=False), "CloudySky": _plain((0.7, 0.8, 0.9),
                                                                          lit=False),
    **{name: Paint(_grey(0.1), _grey(0.8), _grey(0.01), pattern=pattern)
       for name, pattern in _ROADS.items()},
}

BUILT_IN: Dict[str, Paint] = {
    **{f"Gazebo/{name}": paint
       for table in (_COLORS, _CLEAR, _PICTURES) for name, paint in table.items()},
    "Kitchen/WoodFloor": _picture("wood_floor"), "Kitchen/Grass": _picture("grass"),
    "Kitchen/Wall": _picture("painted_wall", (0.93, 0.9, 0.8)),
    "Kitchen/CounterTop": _picture("granite"), "Kitchen/CounterTop_H": _picture("granite"),
    "Kitchen/Cabinet": _plain((0.604, 0.423, 0.0313)),
}
"""Names of all built-in materials."""
