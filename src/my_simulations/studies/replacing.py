"""Writes files atomically: readers find them whole, however the writer ends."""
from __future__ import annotations

import contextlib
import os
import socket
from typing import Iterator


@contextlib.contextmanager
def replacement_file(path: str) -> Iterator[str]:
    """The name of a file to write; it takes the place of `path` at the end.

    Its name is that of this process alone, also in a folder that several machines share.
    """
    part = f"{path}.{socket.gethostname()}-{os.getpid()}.part"
    try:
        yield part
        os.replace(part, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.remove(part)
        raise
