"""Lights."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import List

from ..geometry import IDENTITY, Pose, Vec3
from .shapes import Color


@dataclass
class Light:
    """A light source, drawn by the editor and not simulated. Source: SDF spec 1.7, light.

    At distance d the intensity is 1 / (constant + linear d + quadratic d^2), and 0 beyond `range`.

    Attributes:
        name: unique among the models and lights of a world.
        type: `point`, `directional` or `spot`.
        pose: pose of the light frame in the world frame.
        cast_shadows: whether objects cast shadows in this light.
        diffuse: diffuse colour, r, g, b, a in 0..1.
        specular: specular colour, r, g, b, a in 0..1.
        range: distance that the light reaches, m.
        constant: constant attenuation factor, no unit.
        linear: linear attenuation factor, 1/m.
        quadratic: quadratic attenuation factor, 1/m^2.
        direction: direction of a directional or spot light, in the light frame.
        inner_angle: full angle of the bright inner cone of a spot light, rad.
        outer_angle: full angle of the outer cone of a spot light, rad.
        falloff: exponent of the decrease from the inner to the outer cone, no unit.
        extra: XML of child elements that no field holds.
    """

    name: str
    type: str = "point"
    pose: Pose = IDENTITY
    cast_shadows: bool = False
    diffuse: Color = (1.0, 1.0, 1.0, 1.0)
    specular: Color = (0.1, 0.1, 0.1, 1.0)
    range: float = 10.0
    constant: float = 1.0
    linear: float = 1.0
    quadratic: float = 0.0
    direction: Vec3 = (0.0, 0.0, -1.0)
    inner_angle: float = 0.0
    outer_angle: float = 0.0
    falloff: float = 0.0
    extra: List[str] = field(default_factory=list)
