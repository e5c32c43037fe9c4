"""Temporary folders that are removed at the latest when the next one is created.

A folder belongs to the process that holds its lock. The kernel releases the locks of a process that
ends for any reason, so a folder that can be locked was left behind.
"""
from __future__ import annotations

import contextlib
import fcntl
import os
import shutil
import tempfile

_PREFIX = "my_simulations_scratch_"


class Scratch:
    """A private folder, created when its path is first used.

    As a context manager it is removed at the end.
    """

    def __init__(self) -> None:
        self._path = ""
        self._lock = -1

    def __enter__(self) -> "Scratch":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def path(self) -> str:
        """The path of the folder. Raises OSError if it cannot be created."""
        while not self._path:
            remove_stale_folders()
            made = tempfile.mkdtemp(prefix=_PREFIX)
            self._lock = _lock_folder(made)
            if self._lock >= 0:  # otherwise another process removed it in between
                self._path = made
        return self._path

    def close(self) -> None:
        if self._path:
            shutil.rmtree(self._path, ignore_errors=True)
            os.close(self._lock)
            self._path, self._lock = "", -1


def remove_stale_folders() -> None:
    """Remove folders of processes that have ended without removing them."""
    try:
        parent = tempfile.gettempdir()
        names = os.listdir(parent)
    except OSError:  # no parent folder: nothing to remove
        return
    for name in names:
        if name.startswith(_PREFIX):
            path = os.path.join(parent, name)
            lock = _lock_folder(path)
            if lock >= 0:
                shutil.rmtree(path, ignore_errors=True)
                os.close(lock)


def _lock_folder(path: str) -> int:
    """A descriptor that locks a folder; -1 if it cannot be locked."""
    descriptor = -1
    with contextlib.suppress(OSError):  # gone, another user's, or locked
        descriptor = os.open(path, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC)
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        if os.fstat(descriptor).st_uid == os.getuid() and os.path.isdir(path):
            return descriptor
    if descriptor >= 0:
        os.close(descriptor)
    return -1
