"""The picture of a world at the end of the run of a submission."""
from __future__ import annotations

from io import BytesIO
from typing import Tuple

import numpy as np

from ..errors import CommandError
from ..python_api import OpenWorld

PICTURE = "picture.png"
_WIDTH, _HEIGHT, _HFOV = 640, 400, 1.0
_VFOV = _HFOV * _HEIGHT / _WIDTH
_FROM = np.array([-0.55, -0.65, 0.55])   # direction to the camera
_AROUND_M = 0.7                          # around the origins of links: their shapes
_LARGEST_M = 50.0                        # what has flown farther away is not in the picture


def final_picture(world: OpenWorld) -> bytes:
    """Return a PNG picture of all models, 640 x 400, seen from one side and above.

    Raises CommandError: nothing is installed to draw with; it says what is missing.
    """
    centre, radius = _sphere(world)
    distance = radius / np.sin(_VFOV / 2.0)
    position = centre + _FROM / np.linalg.norm(_FROM) * distance
    picture = world.render(position.tolist(), look_at=centre.tolist(), width=_WIDTH,
                           height=_HEIGHT, hfov=_HFOV, far=float(distance + 4.0 * _LARGEST_M))
    try:
        from PIL import Image
    except ImportError as fault:
        raise CommandError(f"pictures need pip install my_simulations[sensors] ({fault})") from None
    stream = BytesIO()
    Image.fromarray(picture.rgb).save(stream, "PNG", optimize=True)
    return stream.getvalue()


def _sphere(world: OpenWorld) -> Tuple[np.ndarray, float]:
    """A sphere around the origins of all links: its centre and its radius, m."""
    places = world.links().pose.array[:, :3]
    near = places[np.all(np.abs(places) < _LARGEST_M, axis=1)]
    if not len(near):
        return np.zeros(3), _AROUND_M
    centre = (near.min(axis=0) + near.max(axis=0)) / 2.0
    return centre, float(np.linalg.norm(near - centre, axis=1).max()) + _AROUND_M
