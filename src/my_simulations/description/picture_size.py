"""The size of a texture on a box, which the texture then covers again and again.

Gazebo stretches one picture over each face of a box. Bricks on a wall would be as many on its ends
as on its sides. The element `<my_simulations:picture_size>`, among the kept XML of a visual, gives
the edge of the picture in m. Gazebo and libsdformat ignore elements with a prefix.
"""
from __future__ import annotations

import re
from typing import Optional

from .shapes import Visual

_SIZE = re.compile(r"<my_simulations:picture_size(?:\s[^<>]*)?>([^<]*)"
                   r"</my_simulations:picture_size\s*>")


def picture_size_of(visual: Visual) -> Optional[float]:
    """Return the edge of the texture of a visual, m; None to stretch it over each face."""
    for xml in visual.extra:
        found = _SIZE.fullmatch(xml.strip())
        if found:
            try:
                size = float(found.group(1))
            except ValueError:
                return None
            return size if 0.0 < size < float("inf") else None
    return None


def picture_size_xml(size: float) -> str:
    """Return the element for the kept XML of a visual."""
    return (f'<my_simulations:picture_size xmlns:my_simulations="urn:my_simulations">{size:g}'
            "</my_simulations:picture_size>")
