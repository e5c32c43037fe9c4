"""Reads files of a limited size."""
from __future__ import annotations

import os
from typing import BinaryIO


def at_most(stream: BinaryIO, most: int) -> bytes:
    """The content of a file that was just opened; of a larger one, the first `most` + 1 bytes.

    `stream.read(most + 1)` would take room for the largest file each time: a few bytes of it stay
    in use, and the heap of a process that reads many small files grows.
    """
    size = min(os.fstat(stream.fileno()).st_size, most)
    data = stream.read(size + 1)
    if len(data) > size:  # a pipe has no size, and a file may grow
        data += stream.read(most + 1 - len(data))
    return data
