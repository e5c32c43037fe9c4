"""A model's archive, unpacked as if whoever packed it were an enemy."""
from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from typing import Callable

from ...errors import ResourceError
from .http_download import Limits

_WORKER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "archive_worker.py")
_CONFIGS = ("model.config", "manifest.xml")


class ArchiveError(ResourceError):
    """An archive that is broken, too large, or reaches out of its folder."""


def unpack(kind: str, archive: str, folder: str, name: str, limits: Limits, until: float) -> str:
    """Unpack `model.tar.gz`, or the zip file of a Fuel server.

    Only folders and plain files are made; any other kind of entry, an absolute path, `..`, and
    links are refused with the whole archive. Owners, times and special modes of the archive are
    not taken over. It is read by another process, which may use 256 MB and the time that is left.

    Args:
        kind: `tar` (gzipped) or `zip`.
        archive: path of the file.
        folder: where to; it is made.
        name: the only folder that the archive may hold at its top; "" for any.
        limits: of files and bytes.
        until: `time.monotonic()` at which to give up.

    Returns:
        The path of `folder/name`, which holds a model's config.

    Raises:
        ArchiveError: nothing of it is to be used.
    """
    os.makedirs(folder)
    left = max(0.01, until - time.monotonic())
    task = {"kind": kind, "archive": archive, "folder": folder, "name": name,
            "files": limits.files, "size": limits.unpacked_bytes, "seconds": int(left) + 1}
    try:
        done = subprocess.run([sys.executable, "-I", "-S", _WORKER, json.dumps(task)],
                              stdin=subprocess.DEVNULL, capture_output=True, timeout=left,
                              check=False)
    except subprocess.TimeoutExpired:
        raise ArchiveError("timed out while unpacking the archive") from None
    if done.returncode != 0:
        said = done.stdout.decode("utf-8", "replace").strip()
        raise ArchiveError(said or "unpacking the archive exceeded 256 MB of memory or the time"
                           f" limit (status {done.returncode})")
    unpacked = os.path.join(folder, name)
    if not any(os.path.isfile(os.path.join(unpacked, config)) for config in _CONFIGS):
        raise ArchiveError(f"the archive does not contain {os.path.join(name, _CONFIGS[0])}")
    return unpacked


def install(place: str, make: Callable[[str], str]) -> None:
    """Put a folder at `place` as a whole or not at all; one that another process put there wins.

    Args:
        place: the folder to be.
        make: makes the folder's content somewhere below a scratch folder it is given, on the same
            disk, and returns where.
    """
    parent, name = os.path.split(place)
    os.makedirs(parent, exist_ok=True)
    work = tempfile.mkdtemp(prefix=f".{name}-", dir=parent)
    try:
        made = make(work)
        try:
            os.rename(made, place)
        except OSError:
            if not os.path.isdir(place):
                raise
    finally:
        shutil.rmtree(work, ignore_errors=True)
