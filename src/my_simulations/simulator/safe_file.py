"""Files that are whole or not there: written beside, then renamed."""
from __future__ import annotations

import errno
import os
import tempfile
from typing import Optional

from ..errors import CommandError


def write_whole(path: str, data: bytes, overwrite: bool) -> None:
    """Write a file in one piece; missing folders are made.

    Whatever goes wrong, a file that was there stays as it was and nothing half-written is left.

    Raises:
        CommandError: it exists and must not be replaced; no space, no permission, or the like.
    """
    folder = os.path.dirname(path)
    temporary: Optional[str] = None
    try:
        os.makedirs(folder, exist_ok=True)
        handle, temporary = tempfile.mkstemp(prefix=".", suffix=".part", dir=folder)
        with os.fdopen(handle, "wb") as stream:
            stream.write(data)
            stream.flush()
            os.fchmod(stream.fileno(), _mode(path))
            os.fsync(stream.fileno())
        _put(temporary, path, overwrite)
        _sync_folder(folder)
    except FileExistsError as fault:
        if not os.path.isdir(folder):
            raise CommandError(f"{path} cannot be written: {folder} is no folder") from fault
        raise CommandError(f"{path} exists already; ask for it to be replaced, or choose another"
                           " name") from None
    except OSError as fault:
        raise CommandError(f"{path} cannot be written: {fault.strerror or fault}") from fault
    finally:
        if temporary is not None and os.path.lexists(temporary):
            os.unlink(temporary)


def _put(temporary: str, path: str, overwrite: bool) -> None:
    if os.path.isdir(path):
        raise IsADirectoryError(errno.EISDIR, "it is a folder", path)
    if overwrite:
        os.replace(temporary, path)
        return
    try:
        # Unlike a rename, a link never replaces a file that came into being just now.
        os.link(temporary, path)
    except FileExistsError:
        raise
    except OSError:  # a file system without hard links
        if os.path.lexists(path):
            raise FileExistsError(errno.EEXIST, "it exists", path) from None
        os.replace(temporary, path)


def _mode(path: str) -> int:
    """That of the file to be replaced, else what the umask leaves."""
    try:
        return os.stat(path).st_mode & 0o777
    except OSError:
        mask = os.umask(0)
        os.umask(mask)
        return 0o666 & ~mask


def _sync_folder(folder: str) -> None:
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
