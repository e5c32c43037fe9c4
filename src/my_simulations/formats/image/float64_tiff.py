"""Reads TIFF images of 64-bit floating-point numbers, which Pillow does not read.

Elevation models from GDAL and Blender GIS have them. Source: TIFF 6.0, and Adobe's technical note 3
(2005) for the floating-point predictor.
"""
from __future__ import annotations

import io
import zlib
from typing import IO, Any, Optional

_WIDTH, _HEIGHT, _BITS, _COMPRESSION, _STRIPS, _SAMPLES = 256, 257, 258, 259, 273, 277
_STRIP_ROWS, _STRIP_BYTES, _PREDICTOR, _TILE_WIDTH, _TILE_HEIGHT = 278, 279, 317, 322, 323
_TILES, _TILE_BYTES, _SAMPLE_FORMAT = 324, 325, 339
_PLAIN, _DEFLATED = 1, (8, 32946)
_FLOATS, _FLOAT_PREDICTOR = 3, 3
_BYTES = 8   # of a number


def pixels_in(content: bytes) -> int:
    """How many pixels such an image has; 0 for any other file."""
    tags = _tags(io.BytesIO(content))
    return 0 if tags is None else int(tags[_WIDTH]) * int(tags[_HEIGHT])


def image_of(stream: IO[bytes], most_pixels: int) -> Optional[Any]:
    """A PIL image of mode F with its TIFF tags as `tag_v2`; None for any other file.

    Raises ValueError: it has more than `most_pixels`, is damaged, or compressed in another way than
    by Deflate.
    """
    import numpy as np
    from PIL import Image

    tags = _tags(stream)
    if tags is None:
        return None
    width, height = int(tags[_WIDTH]), int(tags[_HEIGHT])
    if width * height > most_pixels:
        raise ValueError(f"it has {width} x {height} pixels")
    # Pillow has no type for 64 bits; heights of 10 km are exact to a millimetre in 32.
    image: Any = Image.fromarray(_numbers(stream, tags, width, height).astype(np.float32))
    image.tag_v2, image.format = tags, "TIFF"
    return image


def _tags(stream: IO[bytes]) -> Optional[Any]:
    """The tags of such an image; None for any other file."""
    from PIL import TiffImagePlugin

    stream.seek(0)
    head = stream.read(8)
    if head[:4] not in (b"II*\0", b"MM\0*") or len(head) < 8:
        return None
    tags: Any = TiffImagePlugin.ImageFileDirectory_v2(head)
    stream.seek(tags.next)
    try:
        tags.load(stream)
        numbers = _first(tags, _BITS), _first(tags, _SAMPLE_FORMAT), _first(tags, _SAMPLES, 1)
        is_known = numbers == (8 * _BYTES, _FLOATS, 1) and _WIDTH in tags and _HEIGHT in tags
    except (SyntaxError, OSError, TypeError, ValueError, LookupError):
        return None   # Pillow says what is wrong with it
    return tags if is_known else None


def _first(tags: Any, tag: int, otherwise: int = 0) -> int:
    found = tags.get(tag, otherwise)
    return int(found[0] if isinstance(found, tuple) else found)


def _numbers(stream: IO[bytes], tags: Any, width: int, height: int) -> Any:
    """float64 (height, width)."""
    import numpy as np

    if _TILES in tags:
        columns, rows = int(tags[_TILE_WIDTH]), int(tags[_TILE_HEIGHT])
        places, sizes = tags[_TILES], tags[_TILE_BYTES]
    else:
        columns, rows = width, min(height, _first(tags, _STRIP_ROWS, height))
        places, sizes = tags[_STRIPS], tags[_STRIP_BYTES]
    across, down = -(-width // max(columns, 1)), -(-height // max(rows, 1))
    if len(places) < across * down or len(sizes) < across * down:
        raise ValueError("it is cut off")
    found = np.empty((height, width))
    for number in range(across * down):
        top, left = number // across * rows, number % across * columns
        high = rows if _TILES in tags else min(rows, height - top)
        stream.seek(places[number])
        block = _block(stream.read(sizes[number]), tags, columns, high)
        part = found[top:top + high, left:left + columns]
        part[:] = block[:part.shape[0], :part.shape[1]]
    return found


def _block(data: bytes, tags: Any, columns: int, rows: int) -> Any:
    """The numbers of a strip or tile."""
    import numpy as np

    kind, size = _first(tags, _COMPRESSION, _PLAIN), rows * columns * _BYTES
    predictor = _first(tags, _PREDICTOR, 1)
    if kind in _DEFLATED:
        try:
            data = zlib.decompressobj().decompress(data, size)
        except zlib.error as fault:
            raise ValueError(f"it is damaged: {fault}") from None
    elif kind != _PLAIN:
        raise ValueError(f"64-bit numbers with compression {kind} are not read; convert it with"
                         " gdal_translate -ot Float32")
    if len(data) < size:
        raise ValueError("it is cut off")
    if kind in _DEFLATED and predictor == _FLOAT_PREDICTOR:
        rest = np.frombuffer(data, np.uint8, size).reshape(rows, columns * _BYTES)
        planes = np.cumsum(rest, axis=1, dtype=np.uint8).reshape(rows, _BYTES, columns)
        return np.ascontiguousarray(planes.transpose(0, 2, 1)).view(">f8")[..., 0]
    if kind in _DEFLATED and predictor != 1:
        raise ValueError(f"64-bit numbers with predictor {predictor} are not read")
    order = "<" if tags.prefix == b"II" else ">"
    return np.frombuffer(data, f"{order}f8", rows * columns).reshape(rows, columns)
