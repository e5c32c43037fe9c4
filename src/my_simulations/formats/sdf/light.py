"""SDF lights."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ...description.light import Light
from ..xml.binding import fill
from ..xml.source import FaultLevel, Source
from .model_tables import LIGHT

TYPES = ("point", "directional", "spot")


@dataclass
class LightPlacement:
    """A light, and the frame that its pose is given in ("" for the world)."""

    light: Light
    relative_to: str = ""


def read_light(element: Any, source: Source) -> LightPlacement:
    """A light. Source: SDF spec 1.7, light; its defaults are those of `Light`."""
    light = Light(element.get("name", ""))
    found = fill(light, element, LIGHT, source, light.extra)
    if not light.name:
        source.report(FaultLevel.FATAL, "name-empty", "the light has no name", element)
    if light.type not in TYPES:
        source.warn("light-type", f"{light.type!r} is not a light type; point is used", element,
                    "a light is point, directional or spot")
        light.type = "point"
    frame = next((pose.get("relative_to") or "" for pose in found.get("pose", ())), "")
    return LightPlacement(light, frame)
