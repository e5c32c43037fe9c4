"""Opens pictures in the formats that worlds use, and makes textures of them."""
from __future__ import annotations

import io
import os
import struct
import tempfile
from typing import IO, Any, Optional, Sequence, Union

from ...resources.limited_file import at_most
from ..reader_process import read_elsewhere
from . import float64_tiff

MOST_PIXELS = 64 << 20
"""Most pixels of an image: Pillow uses up to four bytes for each."""

FORMATS = ("PNG", "JPEG", "TIFF", "BMP", "GIF", "PPM", "TGA", "WEBP", "DDS")
"""Pillow knows more, among them some that it has other programs read (EPS)."""

_PLAIN_PIXELS, _PLAIN_BYTES, _PLAIN_SCANS = 4 << 20, 8 << 20, 100
_SCAN = b"\xff\xda"
"""Begins a scan of a JPEG: a progressive one may go through its pixels again for every 20 bytes."""


def of_formats(source: Union[str, IO[bytes]], formats: Sequence[str]) -> Any:
    """A PIL image of one of these formats, whose header has been read.

    Raises as PIL's `open`.
    """
    import PIL
    import PIL.Image

    pillow: Any = PIL.Image  # its types differ between versions
    if int(PIL.__version__.partition(".")[0]) >= 8:
        return pillow.open(source, formats=formats)
    # Pillow 7, of Ubuntu 20.04, can only try all formats.
    pillow.init()
    head = _head(source)
    for factory, accept in (pillow.OPEN[name] for name in formats if name in pillow.OPEN):
        try:
            if accept is None or accept(head) is True:
                return factory(source, None)
        except (SyntaxError, IndexError, TypeError, struct.error):  # as Pillow itself does
            pass
        if not isinstance(source, str):
            source.seek(0)
    raise PIL.UnidentifiedImageError("it is of no known format")


def _head(source: Union[str, IO[bytes]]) -> bytes:
    if isinstance(source, str):
        with open(source, "rb") as stream:
            return stream.read(16)
    head = source.read(16)
    source.seek(0)
    return head


def open_image(source: Union[str, IO[bytes]]) -> Any:
    """Open a PIL image and read its header.

    Raises OSError, ValueError, SyntaxError, EOFError: it is none of `FORMATS`, damaged, or has too
    many pixels.
    """
    from PIL import Image, UnidentifiedImageError

    try:
        image = of_formats(source, FORMATS)
    except Image.DecompressionBombError:
        raise ValueError(f"it has more than {MOST_PIXELS} pixels") from None
    except UnidentifiedImageError:
        deep = _of_float64(source)
        if deep is None:
            raise
        return deep
    if image.width * image.height > MOST_PIXELS:
        size = image.size
        image.close()
        raise ValueError(f"it has {size[0]} x {size[1]} pixels")
    return image


def _of_float64(source: Union[str, IO[bytes]]) -> Optional[Any]:
    if not isinstance(source, str):
        return float64_tiff.image_of(source, MOST_PIXELS)
    with open(source, "rb") as stream:
        return float64_tiff.image_of(stream, MOST_PIXELS)


def is_costly(path: str) -> bool:
    """Whether a picture that can be opened may take so much that another process reads it.

    Raises as `open_image`.
    """
    if os.path.getsize(path) > _PLAIN_BYTES:
        return True
    with open(path, "rb") as stream:
        return _is_large(at_most(stream, _PLAIN_BYTES))


def _is_large(content: bytes) -> bool:
    if len(content) > _PLAIN_BYTES or float64_tiff.pixels_in(content) > _PLAIN_PIXELS:
        return True
    with open_image(io.BytesIO(content)) as image:
        if image.width * image.height > _PLAIN_PIXELS:
            return True
        return image.format == "JPEG" and content.count(_SCAN) > _PLAIN_SCANS


def verify_format(content: bytes) -> str:
    """Decode every pixel of an image and return its format, one of `FORMATS`.

    Raises:
        OSError, ValueError, SyntaxError, EOFError: as `open_image`.
        InputError: the child process that decodes large images failed.
    """
    if not _is_large(content):
        return format_of(io.BytesIO(content))
    with tempfile.NamedTemporaryFile(prefix="my_simulations_") as file:
        file.write(content)
        file.flush()
        return str(read_elsewhere("format", file.name, "image-unreadable")[0])


def format_of(source: Union[str, IO[bytes]]) -> str:
    """As `verify_format`, in this process."""
    with open_image(source) as image:
        image.load()
        return str(image.format)


def read_picture(path: str, largest: int) -> Optional[Any]:
    """Read an image as uint8 (h, w, 4), lowest row first; None if it is unreadable.

    It has at most `largest` pixels along a side.
    """
    from ...errors import InputError

    try:
        if not is_costly(path):
            return pixels_of(path, largest)
        read, arrays = read_elsewhere("picture", path, "image-unreadable", largest=largest)
    except (OSError, ValueError, SyntaxError, EOFError, InputError):
        return None
    return arrays[0] if read else None


def pixels_of(source: Any, largest: int) -> Optional[Any]:
    """As `read_picture`, of a path or an open image, in this process."""
    import numpy as np
    import PIL.Image

    pillow: Any = PIL.Image  # its types differ between versions
    try:
        image = open_image(source) if isinstance(source, str) else source
        if max(image.size) > largest:
            image.draft("RGB", (largest, largest))
            image = image.convert("RGBA")
            image.thumbnail((largest, largest), pillow.BILINEAR)
        upwards = pillow.FLIP_TOP_BOTTOM
        return np.asarray(image.convert("RGBA").transpose(upwards))
    except (OSError, ValueError, SyntaxError, EOFError):
        return None
