"""Files of the editor that only its user can read, and the key of the page's addresses.

Browsers keep the page's files for good. Were their addresses known before, another user of the
machine could listen at the editor's port while it does not run, and have a browser keep other
scripts in their place.
"""
from __future__ import annotations

import contextlib
import os
import secrets
import tempfile

from ...resources.private_folder import make_private
from ..editor_options import cache_folder


def private_folder(cache_dir: str = "") -> str:
    """Where they are kept; "" for the user's own cache."""
    return os.path.join(cache_dir or cache_folder(), "editor")


def write_private(path: str, data: bytes) -> None:
    """Write a file whole, in a folder that is made for its user alone. Raises OSError."""
    folder = os.path.dirname(path)
    make_private(folder)
    handle, temporary = tempfile.mkstemp(dir=folder)  # readable by its user alone
    with os.fdopen(handle, "wb") as stream:
        stream.write(data)
    os.replace(temporary, path)


_BYTES = 32


def page_key(cache_dir: str) -> bytes:
    """The user's key, made at the first call; where it cannot be kept, another one each time."""
    path = os.path.join(private_folder(cache_dir), "page_key")
    with contextlib.suppress(OSError):  # there is none yet, or no home to keep it in
        with open(path, "rb") as stream:
            key = stream.read()
        if len(key) == _BYTES:
            return key
    key = secrets.token_bytes(_BYTES)
    with contextlib.suppress(OSError):  # browsers then ask for the files again after each start
        write_private(path, key)
    return key
