"""Unpacks an archive in a process of its own; this file is run, not imported (`-I -S`).

A malicious archive can make its reader use any amount of memory and time before it yields a byte
(headers of tar, the directory of zip). Therefore it is read here, under limits of the kernel, while
the calling process waits.
"""
import json
import os
import resource
import stat
import sys
import tarfile
import zipfile
import zlib
from typing import IO, Any, Iterator, List, Optional, Tuple

try:
    from lzma import LZMAError
except ImportError:   # a Python without liblzma, whose zipfile refuses such entries itself
    LZMAError = zlib.error  # type: ignore[assignment,misc]

MEMORY = 256 << 20
_CHUNK = 1 << 16
_MOST_PARTS = 50   # of a path: deeper trees exhaust the stack of programs that walk them

Entry = Tuple[str, str, int, Any, bool]
"""Name, kind (`file`, `folder`, `encrypted`, `other`), size in the header, a function that opens
it, and whether it can be executed."""


class ArchiveRefusedError(Exception):
    """The archive is damaged, too large, or writes outside of its folder."""


class _Count:
    """Counts entries and bytes, and raises when a limit is exceeded."""

    def __init__(self, files: int, size: int) -> None:
        self._most_files, self._most_bytes = files, size
        self._files, self._told, self._size = 0, 0, 0

    def entry(self, size: int) -> None:
        self._files, self._told = self._files + 1, self._told + size
        self._check()

    def chunk(self, size: int) -> None:
        self._size += size
        self._check()

    def _check(self) -> None:
        if self._files > self._most_files or max(self._told, self._size) > self._most_bytes:
            raise ArchiveRefusedError(f"the archive contains more than {self._most_files} files or"
                          f" {self._most_bytes} bytes")


def unpack(kind: str, archive: str, folder: str, name: str, files: int, size: int,
           skips_links: bool = False) -> None:
    """Create the folders and regular files of an archive below `folder`.

    Args:
        kind: `tar` (gzipped) or `zip`.
        archive: path of the file.
        folder: destination, an existing empty folder.
        name: the only top-level folder that the archive may contain; "" for any.
        files: largest number of entries.
        size: largest number of bytes in total.
        skips_links: as of `extract` in archive.py.

    Raises:
        ArchiveRefusedError: the archive is rejected.
    """
    count = _Count(files, size)
    if kind == "zip":
        with zipfile.ZipFile(archive) as packed:
            for entry in _of_zip(packed):
                _unpack_entry(entry, folder, name, count, skips_links)
        return
    with tarfile.open(archive, "r:gz") as tar:
        for entry in _of_tar(tar):
            _unpack_entry(entry, folder, name, count, skips_links)
    _read_to_end(archive, size + (files + 2) * 1024 + (1 << 20))


def _of_tar(packed: tarfile.TarFile) -> Iterator[Entry]:
    for member in packed:
        kind = "folder" if member.isdir() else "file" if member.isreg() else "other"
        yield (member.name, kind, member.size, lambda m=member: packed.extractfile(m),
               bool(member.mode & 0o111))
        # tarfile keeps every member in memory, with its headers.
        packed.members = []  # type: ignore[attr-defined]


def _of_zip(packed: zipfile.ZipFile) -> Iterator[Entry]:
    for member in packed.infolist():
        form = stat.S_IFMT(member.external_attr >> 16)
        kind = ("folder" if member.is_dir() else
                "encrypted" if member.flag_bits & 1 else
                "file" if form in (0, stat.S_IFREG) else "other")
        yield (member.orig_filename, kind, member.file_size, lambda m=member: packed.open(m),
               bool(member.external_attr >> 16 & 0o111))


def _unpack_entry(entry: Entry, folder: str, name: str, count: _Count, skips_links: bool) -> None:
    path, kind, size, opened, runs = entry
    count.entry(size)
    if skips_links and kind == "other":
        return
    target = _safe_path(path.replace("\\", "/") if skips_links else path, kind, folder, name)
    if target is not None:
        _write(opened(), path, target, count)
        if skips_links and runs:
            os.chmod(target, 0o755)


def _safe_path(path: str, kind: str, folder: str, name: str) -> Optional[str]:
    """Destination of a file; None for a folder, which is created here."""
    parts = [part for part in path.split("/") if part not in ("", ".")]
    if path.startswith("/") or ".." in parts or "\0" in path or "\\" in path:
        raise ArchiveRefusedError(f"the archive contains a path outside its folder: {path!r}")
    if len(parts) > _MOST_PARTS:
        raise ArchiveRefusedError(f"the archive has more than {_MOST_PARTS} folders in each other")
    if name and parts and parts[0] != name:
        raise ArchiveRefusedError(f"the archive contains {parts[0]!r} besides {name!r}")
    target = os.path.join(folder, *parts)
    if kind == "folder":
        os.makedirs(target, exist_ok=True)
        return None
    if kind == "encrypted":
        raise ArchiveRefusedError(f"{path!r} is encrypted")
    if kind != "file" or len(parts) < (2 if name else 1):
        raise ArchiveRefusedError(f"{path!r} is neither a file nor a folder")
    return target


def _write(stream: Optional[IO[bytes]], path: str, target: str, count: _Count) -> None:
    if stream is None:
        raise ArchiveRefusedError(f"{path!r} has no content")
    os.makedirs(os.path.dirname(target), exist_ok=True)
    with stream, open(target, "wb") as out:
        while True:
            chunk = stream.read(_CHUNK)
            if not chunk:
                return
            count.chunk(len(chunk))
            out.write(chunk)


def _read_to_end(archive: str, largest: int) -> None:
    """Read to the end of the gzip stream, where its checksum is; tar may stop before."""
    import gzip

    size = 0
    with gzip.open(archive, "rb") as stream:
        while True:
            chunk = stream.read(_CHUNK)
            if not chunk:
                return
            size += len(chunk)
            if size > largest:
                raise ArchiveRefusedError("the archive has data after its end")


def _limit(memory: int, seconds: int, size: int) -> None:
    for what, most in ((resource.RLIMIT_AS, memory), (resource.RLIMIT_CPU, seconds),
                       (resource.RLIMIT_FSIZE, size), (resource.RLIMIT_CORE, 0)):
        _, hard = resource.getrlimit(what)
        if hard != resource.RLIM_INFINITY:
            most = min(most, hard)
        resource.setrlimit(what, (most, hard))


def main(argv: List[str]) -> int:
    """Unpack with the arguments in a JSON object; prints a fault and returns status 1."""
    task = json.loads(argv[1])
    _limit(MEMORY, int(task.pop("seconds")) + 1, int(task["size"]) + _CHUNK)
    try:
        unpack(**task)
    except ArchiveRefusedError as fault:
        said = str(fault)
    except MemoryError:
        said = f"the archive needs more than {MEMORY >> 20} MB of memory to be read"
    except (tarfile.TarError, zipfile.BadZipFile, zlib.error, LZMAError, EOFError, ValueError,
            RecursionError, NotImplementedError, RuntimeError, KeyError, IndexError) as fault:
        said = f"the archive is broken: {fault}"
    except OSError as fault:
        # gzip raises it, without errno, for a wrong checksum; a full disk has an errno.
        said = fault.strerror or f"the archive is broken: {fault}"
    else:
        return 0
    sys.stdout.write(said)
    return 1


if __name__ == "__main__":
    sys.exit(main(sys.argv))
