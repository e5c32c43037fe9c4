"""Opens pictures in the formats that worlds use, and makes textures of them."""
from __future__ import annotations

import os
from typing import IO, Any, Optional, Union

from ..reader_process import read_elsewhere

MOST_PIXELS = 64 << 20
"""Most pixels of an image: Pillow uses up to four bytes for each."""

FORMATS = ("PNG", "JPEG", "TIFF", "BMP", "GIF", "PPM", "TGA", "WEBP", "DDS")
"""Pillow knows more, among them some that it has other programs read (EPS)."""

_PLAIN_PIXELS, _PLAIN_BYTES = 4 << 20, 8 << 20


def opened(source: Union[str, IO[bytes]]) -> Any:
    """A PIL image whose header has been read.

    Raises:
        OSError, ValueError, SyntaxError, EOFError: it is none of `FORMATS`, damaged, or has too
            many pixels.
    """
    from PIL import Image

    try:
        image = Image.open(source, formats=FORMATS)
    except Image.DecompressionBombError:
        raise ValueError(f"it has more than {MOST_PIXELS} pixels") from None
    if image.width * image.height > MOST_PIXELS:
        size = image.size
        image.close()
        raise ValueError(f"it has {size[0]} x {size[1]} pixels")
    return image


def is_costly(path: str) -> bool:
    """Whether a picture that can be opened is so large that another process reads it.

    Raises as `opened`.
    """
    if os.path.getsize(path) > _PLAIN_BYTES:
        return True
    with opened(path) as image:
        return bool(image.width * image.height > _PLAIN_PIXELS)


def picture(path: str, largest: int) -> Optional[Any]:
    """uint8 (h, w, 4), the lowest row first, at most `largest` along a side; None if unreadable."""
    from ...errors import InputError

    try:
        if not is_costly(path):
            return pixels_of(path, largest)
        read, arrays = read_elsewhere("picture", path, "image-unreadable", largest=largest)
    except (OSError, ValueError, SyntaxError, EOFError, InputError):
        return None
    return arrays[0] if read else None


def pixels_of(source: Any, largest: int) -> Optional[Any]:
    """As `picture`, of a path or an open image, in this process."""
    import numpy as np
    from PIL import Image

    try:
        image = opened(source) if isinstance(source, str) else source
        if max(image.size) > largest:
            image.draft("RGB", (largest, largest))
            image = image.convert("RGBA")
            image.thumbnail((largest, largest), Image.BILINEAR)
        upwards = Image.FLIP_TOP_BOTTOM
        return np.asarray(image.convert("RGBA").transpose(upwards))
    except (OSError, ValueError, SyntaxError, EOFError):
        return None
