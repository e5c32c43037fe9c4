"""Unpacks archives of models from untrusted sources."""
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
    """An archive that is damaged, too large, or writes outside of its folder."""


def unpack(kind: str, archive: str, folder: str, name: str, limits: Limits, until: float) -> str:
    """Unpack `model.tar.gz`, or the zip file of a Fuel server.

    Only folders and regular files are created; an archive with any other kind of entry, an absolute
    path, `..` or a link is rejected. Owners, times and special modes are not restored. The archive
    is read by another process, limited to 256 MB and the remaining time.

    Args:
        kind: `tar` (gzipped) or `zip`.
        archive: path of the file.
        folder: destination, which is created.
        name: the only top-level folder that the archive may contain; "" for any.
        limits: limits of files and bytes.
        until: `time.monotonic()` at which to give up.

    Returns:
        The path of `folder/name`, which contains a model's config.

    Raises:
        ArchiveError: the archive is rejected.
    """
    extract(kind, archive, folder, limits, until, name=name)
    unpacked = os.path.join(folder, name)
    if not any(os.path.isfile(os.path.join(unpacked, config)) for config in _CONFIGS):
        raise ArchiveError(f"the archive does not contain {os.path.join(name, _CONFIGS[0])}")
    return unpacked


def extract(kind: str, archive: str, folder: str, limits: Limits, until: float, *, name: str = "",
            skips_links: bool = False) -> None:
    """Unpack an archive of any content, with the limits of `unpack`.

    Args:
        kind: `tar` (gzipped) or `zip`.
        archive: path of the file.
        folder: destination, which is created.
        limits: limits of files and bytes.
        until: `time.monotonic()` at which to give up.
        name: the only top-level folder that the archive may contain; "" for any.
        skips_links: leave out links and special files instead of rejecting the archive, accept
            backslashes between folders, and keep permissions to execute.

    Raises:
        ArchiveError: the archive is rejected.
    """
    os.makedirs(folder)
    left = max(0.01, until - time.monotonic())
    task = {"kind": kind, "archive": archive, "folder": folder, "name": name,
            "files": limits.files, "size": limits.unpacked_bytes, "seconds": int(left) + 1,
            "skips_links": skips_links}
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


def install(place: str, make: Callable[[str], str]) -> None:
    """Create a folder atomically; if another process creates it meanwhile, that one is kept.

    Args:
        place: path of the new folder.
        make: creates the content below the scratch folder that it is given, on the same disk, and
            returns its path.
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
