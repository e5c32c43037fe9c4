"""Files of the editor that only its user can read."""
from __future__ import annotations

import os
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
