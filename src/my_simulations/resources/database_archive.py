"""A model's archive, unpacked as if whoever packed it were an enemy."""
from __future__ import annotations

import os
import tarfile
import time
import zlib
from typing import IO, Optional

from .database_http import Limits

_CHUNK = 1 << 16


class ArchiveFault(Exception):
    """An archive that is broken, too large, or reaches out of its folder."""


def unpack(archive: str, folder: str, name: str, limits: Limits, until: float) -> str:
    """Unpack `model.tar.gz`.

    Only folders and plain files below `name/` are made; any other kind of entry, an absolute
    path, `..`, and links are refused with the whole archive. Owners, times and special modes of
    the archive are not taken over.

    Args:
        archive: path of the file.
        folder: where to; it is made.
        name: the only folder it may hold.
        limits: of files and bytes.
        until: `time.monotonic()` at which to give up.

    Returns:
        The path of `folder/name`.

    Raises:
        ArchiveFault: nothing of it is to be used.
    """
    os.makedirs(folder)
    files, size = 0, 0
    try:
        with tarfile.open(archive, "r:gz") as packed:
            for entry in packed:
                if time.monotonic() >= until:
                    raise ArchiveFault("it was not unpacked in time")
                path = _safe_path(entry, folder, name)
                files, size = files + 1, size + entry.size
                if files > limits.files or size > limits.unpacked_bytes:
                    raise ArchiveFault(f"the archive holds more than {limits.files} files or"
                                       f" {limits.unpacked_bytes} bytes")
                if path is not None:
                    _write(packed.extractfile(entry), path, until)
        _read_to_end(archive, limits)
    except (tarfile.TarError, EOFError, zlib.error) as fault:
        raise ArchiveFault(f"the archive is broken: {fault}") from None
    except OSError as fault:
        # gzip says so of a wrong checksum; a full disk has a number.
        if fault.errno is None:
            raise ArchiveFault(f"the archive is broken: {fault}") from None
        raise
    unpacked = os.path.join(folder, name)
    if not os.path.isfile(os.path.join(unpacked, "model.config")) and not os.path.isfile(
            os.path.join(unpacked, "manifest.xml")):
        raise ArchiveFault(f"the archive holds no {name}/model.config")
    return unpacked


def _safe_path(entry: tarfile.TarInfo, folder: str, name: str) -> Optional[str]:
    """Where a file goes; None for a folder, which is made at once."""
    parts = [part for part in entry.name.split("/") if part not in ("", ".")]
    if entry.name.startswith("/") or ".." in parts or "\0" in entry.name or "\\" in entry.name:
        raise ArchiveFault(f"the archive reaches out of its folder: {entry.name!r}")
    if parts and parts[0] != name:
        raise ArchiveFault(f"the archive holds {parts[0]!r} besides {name!r}")
    path = os.path.join(folder, *parts)
    if entry.isdir():
        os.makedirs(path, exist_ok=True)
        return None
    if not entry.isreg() or len(parts) < 2:
        raise ArchiveFault(f"{entry.name!r} is neither a file nor a folder")
    return path


def _write(stream: Optional[IO[bytes]], path: str, until: float) -> None:
    if stream is None:
        raise ArchiveFault(f"{path!r} has no content")
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with stream, open(path, "wb") as out:
        while True:
            chunk = stream.read(_CHUNK)
            if not chunk:
                return
            out.write(chunk)
            if time.monotonic() >= until:
                raise ArchiveFault("it was not unpacked in time")


def _read_to_end(archive: str, limits: Limits) -> None:
    """gzip's checksum stands at the very end, which tar need not reach."""
    import gzip

    size = 0
    with gzip.open(archive, "rb") as stream:
        while True:
            chunk = stream.read(_CHUNK)
            if not chunk:
                return
            size += len(chunk)
            if size > limits.unpacked_bytes + (limits.files + 2) * 1024 + (1 << 20):
                raise ArchiveFault("the archive goes on after its end")
