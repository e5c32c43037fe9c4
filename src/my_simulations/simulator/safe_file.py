"""Atomic file writes: to a temporary file, then renamed."""
from __future__ import annotations

import contextlib
import errno
import os
import tempfile
from typing import Optional

from ..errors import CommandError
from ..resources.private_folder import make_private


def write_atomically(path: str, data: bytes, overwrite: bool, private: bool = False) -> None:
    """Write a file atomically; creates missing folders.

    On any error an existing file is unchanged, and no partial file is left. If `private`, only the
    user may read the file and enter its folder. Raises CommandError: it exists and `overwrite` is
    False, or it cannot be written.
    """
    folder = os.path.dirname(path)
    temporary: Optional[str] = None
    try:
        if private:
            make_private(folder)
        else:
            os.makedirs(folder, exist_ok=True)
        handle, temporary = tempfile.mkstemp(prefix=".", suffix=".part", dir=folder)
        with os.fdopen(handle, "wb") as stream:
            stream.write(data)
            stream.flush()
            os.fchmod(stream.fileno(), 0o600 if private else _mode(path))
            os.fsync(stream.fileno())
        _move_into_place(temporary, path, overwrite)
        _sync_folder(folder)
    except FileExistsError as fault:
        if not os.path.isdir(folder):
            raise CommandError(f"cannot write {path}: {folder} is not a folder") from fault
        raise CommandError(f"{path} already exists; confirm overwriting, or choose another"
                           " name") from None
    except OSError as fault:
        raise CommandError(f"cannot write {path}: {fault.strerror or fault}") from fault
    finally:
        if temporary is not None and os.path.lexists(temporary):
            os.unlink(temporary)


def _move_into_place(temporary: str, path: str, overwrite: bool) -> None:
    if os.path.isdir(path):
        raise IsADirectoryError(errno.EISDIR, "it is a folder", path)
    if overwrite:
        os.replace(temporary, path)
        return
    try:
        # Unlike a rename, a link never replaces a file that was created meanwhile.
        os.link(temporary, path)
    except FileExistsError:
        raise
    except OSError:  # a file system without hard links
        if os.path.lexists(path):
            raise FileExistsError(errno.EEXIST, "it exists", path) from None
        os.replace(temporary, path)


def _mode(path: str) -> int:
    """Mode of the existing file, else the default of the umask."""
    try:
        return os.stat(path).st_mode & 0o777
    except OSError:
        mask = os.umask(0)
        os.umask(mask)
        return 0o666 & ~mask


def _sync_folder(folder: str) -> None:
    # The file is complete; some file systems (vboxsf, some FUSE and SMB mounts) cannot do more.
    with contextlib.suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)
