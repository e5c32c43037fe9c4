"""Image files as grey levels."""
from __future__ import annotations

from typing import Any

from ..errors import InputError, error

_MOST_PIXELS = 64 << 20


def grey_levels(path: str) -> Any:
    """The brightest channel of each pixel, 0 to 1, as an array of rows from the top.

    Raises:
        InputError: with one issue, `image-unreadable`.
    """
    import numpy as np
    from PIL import Image, UnidentifiedImageError

    try:
        with Image.open(path) as image:
            if image.width * image.height > _MOST_PIXELS:
                raise _fault(path, f"it has {image.width} x {image.height} pixels")
            deep = image.mode.startswith("I")
            data = np.asarray(image if deep else image.convert("RGB"), dtype=np.float64)
    except UnidentifiedImageError:
        raise _fault(path, "it is of no known format") from None
    except (OSError, ValueError, SyntaxError, EOFError, Image.DecompressionBombError) as fault:
        raise _fault(path, str(fault)) from None
    # Pillow opens 16-bit grey images as I or I;16.
    return data / 65535.0 if deep else data.max(axis=-1) / 255.0


def _fault(path: str, why: str) -> InputError:
    return InputError([error("image-unreadable", f"the image cannot be read: {why}", file=path)])
