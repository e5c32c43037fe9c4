"""Folders that only their user can enter: what they contain may be unsaved work."""
from __future__ import annotations

import os

_USER_ONLY = 0o700


def user_folder(variable: str, default: str) -> str:
    """A user's folder of this package (XDG base directory specification).

    By the specification, a relative path in the variable counts as unset.
    """
    base = os.environ.get(variable, "")
    return os.path.join(base if os.path.isabs(base) else os.path.expanduser(default),
                        "my_simulations")


def make_private(folder: str) -> None:
    """Make a folder if it does not exist, and deny it to other users. Raises OSError."""
    os.makedirs(folder, mode=_USER_ONLY, exist_ok=True)
    if os.stat(folder).st_mode & 0o077:  # one that an earlier version made
        os.chmod(folder, _USER_ONLY)
