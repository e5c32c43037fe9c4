"""Image files as grey levels, and GeoTIFF files as heights."""
from __future__ import annotations

import math
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Iterator, Optional, Tuple

from ..errors import InputError, error

_MOST_PIXELS = 64 << 20
_EARTH_M = 6371000.0
# TIFF tags of GeoTIFF and GDAL.
_PIXEL_SCALE, _TIE_POINT, _GEO_KEYS, _NO_DATA = 33550, 33922, 34735, 42113
_MODEL_TYPE, _GEOGRAPHIC = 1024, 2


@dataclass
class Elevations:
    """A digital elevation model.

    Attributes:
        heights: array of metres, rows from the north.
        extent: metres from west to east and from south to north; None where the file does not say.
    """

    heights: Any
    extent: Optional[Tuple[float, float]]


def grey_levels(path: str) -> Any:
    """The brightest channel of each pixel, 0 to 1, as an array of rows from the top.

    Raises:
        InputError: with one issue, `image-unreadable`.
    """
    import numpy as np

    with _opened(path) as image:
        deep = image.mode.startswith("I")
        data = np.asarray(image if deep else image.convert("RGB"), dtype=np.float64)
    # Pillow opens 16-bit grey images as I or I;16.
    return data / 65535.0 if deep else data.max(axis=-1) / 255.0


def elevations(path: str) -> Optional[Elevations]:
    """The heights in a GeoTIFF, or another image of real numbers; None for other images.

    Where the file says that a pixel has no height, it has the lowest of the others.

    Raises:
        InputError: with one issue, `image-unreadable`.
    """
    import numpy as np

    with _opened(path) as image:
        tags = getattr(image, "tag_v2", {})
        if image.mode != "F" and _GEO_KEYS not in tags:
            return None
        if len(image.getbands()) > 1:
            return None  # a georeferenced photograph
        heights = np.asarray(image, dtype=np.float64)
        extent = _extent(tags, image.width, image.height)
        known = np.isfinite(heights)
        try:
            known &= heights != float(tags.get(_NO_DATA, "nan"))
        except ValueError:
            pass  # some other words; every number is a height then
    if not known.any():
        raise _fault(path, "it holds no height")
    return Elevations(np.where(known, heights, heights[known].min()), extent)


def _extent(tags: Any, columns: int, rows: int) -> Optional[Tuple[float, float]]:
    scale = tags.get(_PIXEL_SCALE, ())
    if len(scale) < 2 or not (scale[0] > 0 and scale[1] > 0):
        return None
    x, y = float(scale[0]) * columns, float(scale[1]) * rows
    keys = tags.get(_GEO_KEYS, ())
    kinds = {keys[n]: keys[n + 3] for n in range(4, len(keys) - 3, 4)}
    if kinds.get(_MODEL_TYPE) != _GEOGRAPHIC:
        return x, y
    tie = tags.get(_TIE_POINT, ())
    north = float(tie[4]) if len(tie) > 4 else 0.0  # degrees
    metres = math.radians(1.0) * _EARTH_M
    return x * metres * max(math.cos(math.radians(north)), 1e-6), y * metres


@contextmanager
def _opened(path: str) -> Iterator[Any]:
    from PIL import Image, UnidentifiedImageError

    try:
        with Image.open(path) as image:
            if image.width * image.height > _MOST_PIXELS:
                raise _fault(path, f"it has {image.width} x {image.height} pixels")
            yield image
    except UnidentifiedImageError:
        raise _fault(path, "it is of no known format") from None
    except (OSError, ValueError, SyntaxError, EOFError, Image.DecompressionBombError) as fault:
        raise _fault(path, str(fault)) from None


def _fault(path: str, why: str) -> InputError:
    return InputError([error("image-unreadable", f"the image cannot be read: {why}", file=path)])
