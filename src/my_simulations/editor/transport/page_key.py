"""A secret of this user, which the addresses of the page's files are made with.

Browsers keep these files for good. Were their addresses known before, another user of the machine
could listen at the editor's port while it does not run, and have a browser keep other scripts in
their place.
"""
from __future__ import annotations

import contextlib
import os
import secrets

from .private_file import private_folder, write_private

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
