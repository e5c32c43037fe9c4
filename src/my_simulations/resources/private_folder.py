"""Folders that only their user can enter: what they contain may be unsaved work."""
from __future__ import annotations

import os

_USER_ONLY = 0o700


def make_private(folder: str) -> None:
    """Make a folder if it does not exist, and deny it to other users. Raises OSError."""
    os.makedirs(folder, mode=_USER_ONLY, exist_ok=True)
    if os.stat(folder).st_mode & 0o077:  # one that an earlier version made
        os.chmod(folder, _USER_ONLY)
