"""Reads grey levels of images, and heights of GeoTIFF files."""
from __future__ import annotations

import math
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Iterator, Optional, Tuple

from ...errors import InputError, error
from ..reader_process import read_elsewhere
from .pixels import is_costly, open_image

_BAND = 256
_CODE = "image-unreadable"
_EARTH_M = 6371000.0
# TIFF tags of GeoTIFF and GDAL.
_PIXEL_SCALE, _TIE_POINT, _GEO_KEYS, _NO_DATA = 33550, 33922, 34735, 42113
_MODEL_TYPE, _GEOGRAPHIC = 1024, 2


@dataclass
class Levels:
    """Grey levels of an image.

    Attributes:
        values: integer array of the requested pixels, rows from the top.
        white: the value of white.
    """

    values: Any
    white: float


@dataclass
class Elevations:
    """A digital elevation model.

    Attributes:
        heights: array of the requested pixels, m, rows from the north.
        shape: rows and columns of the file.
        lowest: least height of all pixels, m.
        highest: greatest height of all pixels, m.
        extent: size from west to east and from south to north, m; None if the file has none.
    """

    heights: Any
    shape: Tuple[int, int]
    lowest: float
    highest: float
    extent: Optional[Tuple[float, float]]


def grey_levels(path: str, widest: int = 0, step: int = 1) -> Levels:
    """The brightest channel of each pixel.

    Only the requested pixels are held in memory: an image of 100 KB may have 60 million. A large
    image is read by another process.

    Args:
        path: path of the image.
        widest: greatest number of rows and columns, to which the image is sampled; 0 for all.
        step: take every `step`-th row and column, rows counted from the bottom.

    Raises:
        InputError: with one issue, `image-unreadable`.
    """
    if not _costly(path):
        return levels_of(path, widest, step)
    white, arrays = read_elsewhere("levels", path, _CODE, widest=widest, step=step)
    return Levels(arrays[0], float(white))


def levels_of(path: str, widest: int, step: int) -> Levels:
    """As `grey_levels`, in this process."""
    import numpy as np

    with _open_tiff(path) as image:
        step = max(step, _step(image, widest))
        # Pillow opens 16-bit grey images as I or I;16.
        deep = image.mode.startswith("I")
        first = 0 if widest else (image.height - 1) % step
        bands = [np.asarray(band if deep else _brightest(band))[::step, ::step]
                 for band in _bands(image, first, step)]
    return Levels(np.concatenate(bands), 65535.0 if deep else 255.0)


def read_elevations(path: str, widest: int) -> Optional[Elevations]:
    """Read the heights of a GeoTIFF or another floating-point image; None for other images.

    Pixels without data get the least height of the others. `widest` as in `grey_levels`. Raises
    InputError: with one issue, `image-unreadable`.
    """
    if not _costly(path):
        return elevations_of(path, widest)
    found, arrays = read_elsewhere("elevations", path, _CODE, widest=widest)
    if found is None:
        return None
    shape, lowest, highest, extent = found
    return Elevations(arrays[0], (int(shape[0]), int(shape[1])), float(lowest), float(highest),
                      None if extent is None else (float(extent[0]), float(extent[1])))


def elevations_of(path: str, widest: int) -> Optional[Elevations]:
    import numpy as np

    with _open_tiff(path) as image:
        tags = getattr(image, "tag_v2", {})
        if image.mode != "F" and _GEO_KEYS not in tags:
            return None
        if len(image.getbands()) > 1:
            return None  # a georeferenced photograph
        step, lowest, highest, bands = _step(image, widest), math.inf, -math.inf, []
        extent = _extent(tags, image.width, image.height)
        try:
            nothing = float(tags.get(_NO_DATA, "nan"))
        except ValueError:
            nothing = math.nan  # not a number: every pixel is a height
        if image.mode == "F":
            nothing = float(np.float32(nothing))   # as the pixels
        for band in _bands(image, 0, step):
            heights = np.asarray(band, dtype=np.float64)
            known = np.isfinite(heights) & (heights != nothing)
            lowest = float(min(lowest, heights.min(where=known, initial=math.inf)))
            highest = float(max(highest, heights.max(where=known, initial=-math.inf)))
            bands.append(np.where(known, heights, np.nan)[::step, ::step])
        shape = image.height, image.width
    if lowest > highest:
        raise _fault(path, "it holds no height")
    heights = np.concatenate(bands)
    return Elevations(np.where(np.isnan(heights), lowest, heights), shape, lowest, highest, extent)


def _brightest(image: Any) -> Any:
    from PIL import ImageChops

    if image.mode == "L":
        return image
    red, green, blue = image.convert("RGB").split()
    return ImageChops.lighter(ImageChops.lighter(red, green), blue)


def _step(image: Any, widest: int) -> int:
    """Sampling step of rows and columns."""
    return max(1, -(-(max(image.size) - 1) // (widest - 1))) if widest else 1


def _bands(image: Any, first: int, step: int) -> Iterator[Any]:
    """The image in bands of rows from `first` on; each begins with a sampled row."""
    rows = max(1, _BAND // step) * step
    for top in range(first, image.height, rows):
        yield image.crop((0, top, image.width, min(top + rows, image.height)))


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


def _costly(path: str) -> bool:
    with _as_input_error(path):
        return is_costly(path)


@contextmanager
def _open_tiff(path: str) -> Iterator[Any]:
    with _as_input_error(path), open_image(path) as image:
        yield image


@contextmanager
def _as_input_error(path: str) -> Iterator[None]:
    """Raises faults of an image as InputError."""
    from PIL import UnidentifiedImageError

    try:
        yield
    except UnidentifiedImageError:
        raise _fault(path, "it is of no known format") from None
    except (OSError, ValueError, SyntaxError, EOFError) as fault:
        raise _fault(path, str(fault)) from None


def _fault(path: str, why: str) -> InputError:
    return InputError([error(_CODE, f"the image cannot be read: {why}", file=path)])
