"""A material made ready to be drawn."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Optional, Tuple

from ..description.shapes import Color


@dataclass(frozen=True)
class Look:
    """A material after its script was read: what the editor's page and cameras draw.

    Colours are None where nothing is said, and then a mesh's own counts. `texture` is the path of a
    picture, `pattern` the name of one that is drawn (`gazebo_materials`); `scale` is the size of
    one repetition in texture coordinates, u and v. `transparency` 0 opaque to 1 invisible; `lit`
    False ignores all lights.
    """

    name: str = ""
    ambient: Optional[Color] = None
    diffuse: Optional[Color] = None
    specular: Optional[Color] = None
    emissive: Optional[Color] = None
    texture: str = ""
    pattern: str = ""
    scale: Tuple[float, float] = (1.0, 1.0)
    transparency: float = 0.0
    lit: bool = True
