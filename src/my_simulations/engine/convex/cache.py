"""Caches convex parts on disk, by the content of the mesh."""
from __future__ import annotations

import contextlib
import hashlib
import io
import logging
import os
import tempfile
import time
from dataclasses import dataclass
from typing import Any, List, Optional

from ...description.shapes import MeshData
from ...resources.private_folder import make_private, user_folder

_log = logging.getLogger(__name__)
_SUFFIX = ".parts"
_UNFINISHED = ".new"
_UNFINISHED_LIFE_S = 3600.0
_DIGEST_BYTES = 32


@dataclass
class Decomposition:
    """Convex parts of a mesh.

    Attributes:
        parts: at least one convex part, in the frame of the mesh, m.
        notice: code of a warning to report; "" for none.
    """

    parts: List[MeshData]
    notice: str = ""


def default_folder() -> str:
    """The default cache folder (XDG base directory specification)."""
    return os.path.join(user_folder("XDG_CACHE_HOME", "~/.cache"), "decompositions")


def content_key(mesh: MeshData, parameters: str) -> str:
    """A key that is equal for equal vertices, triangles and parameters."""
    import numpy as np

    digest = hashlib.sha256(parameters.encode())
    for array, kind in ((mesh.vertices, "<f8"), (mesh.triangles, "<i4")):
        plain = np.ascontiguousarray(array, dtype=kind)
        digest.update(repr(plain.shape).encode())
        digest.update(plain.tobytes())
    return digest.hexdigest()


def save(path: str, made: Decomposition) -> None:
    """Write a decomposition to a file: a SHA-256 checksum and the arrays."""
    import numpy as np

    stream = io.BytesIO()
    np.savez_compressed(
        stream,
        vertices=np.concatenate([np.asarray(p.vertices, dtype="<f8") for p in made.parts]),
        triangles=np.concatenate([np.asarray(p.triangles, dtype="<i4") for p in made.parts]),
        counts=np.array([(len(p.vertices), len(p.triangles)) for p in made.parts], dtype="<i8"),
        notice=np.array(made.notice))
    with open(path, "wb") as file:
        file.write(hashlib.sha256(stream.getvalue()).digest())
        file.write(stream.getvalue())


def load(path: str) -> Decomposition:
    """Read a file written by `save`.

    Raises:
        OSError: the file cannot be read.
        ValueError: it is damaged.
    """
    import numpy as np

    with open(path, "rb") as file:
        digest, content = file.read(_DIGEST_BYTES), file.read()
    if hashlib.sha256(content).digest() != digest:
        raise ValueError("it is damaged")
    with np.load(io.BytesIO(content), allow_pickle=False) as held:
        vertices, triangles, counts = held["vertices"], held["triangles"], held["counts"]
        made = Decomposition(_split(vertices, triangles, counts), str(held["notice"]))
    if not made.parts or not np.isfinite(vertices).all():
        raise ValueError("not a decomposition: nothing in it, or no numbers")
    return made


def _split(vertices: Any, triangles: Any, counts: Any) -> List[MeshData]:
    if counts.sum(axis=0).tolist() != [len(vertices), len(triangles)]:
        raise ValueError("the counts do not fit the arrays")
    parts, at, face = [], 0, 0
    for points, faces in counts.tolist():
        part = MeshData(vertices[at:at + points], triangles[face:face + faces])
        if not faces or part.triangles.min() < 0 or part.triangles.max() >= points:
            raise ValueError("a triangle names a vertex that does not exist")
        parts.append(part)
        at, face = at + points, face + faces
    return parts


class PartsCache:
    """A folder of decompositions. Errors of the disk are logged and disable caching only.

    Args:
        folder: created at the first write.
        limit: largest size, bytes; the least recently used entries are deleted first.
    """

    def __init__(self, folder: str, limit: int = 256 * 1024 * 1024) -> None:
        self._folder = folder
        self._limit = limit

    def get(self, key: str) -> Optional[Decomposition]:
        """The entry of a key; None if it is missing or damaged."""
        path = self._path(key)
        try:
            made = load(path)
        except FileNotFoundError:
            return None
        except (OSError, ValueError) as fault:
            _log.warning("%s is invalid and is created again: %s", path, fault)
            with contextlib.suppress(OSError):  # it will be replaced
                os.remove(path)
            return None
        with contextlib.suppress(OSError):  # of another user, or on a read-only disk
            os.utime(path)
        return made

    def put(self, key: str, made: Decomposition) -> None:
        """Store a decomposition atomically."""
        unfinished = ""
        try:
            make_private(self._folder)
            descriptor, unfinished = tempfile.mkstemp(suffix=_UNFINISHED, dir=self._folder)
            os.close(descriptor)
            save(unfinished, made)
            os.replace(unfinished, self._path(key))
            self._trim(self._path(key))
        except OSError as fault:
            _log.warning("convex parts cannot be kept in %s: %s", self._folder, fault)
            if unfinished:
                with contextlib.suppress(OSError):  # not cached
                    os.remove(unfinished)

    def _path(self, key: str) -> str:
        return os.path.join(self._folder, key + _SUFFIX)

    def _trim(self, newest: str) -> None:
        entries = []
        for entry in os.scandir(self._folder):
            with contextlib.suppress(FileNotFoundError):  # deleted by another process
                status = entry.stat()
                if entry.name.endswith(_SUFFIX):
                    entries.append((status.st_mtime_ns, status.st_size, entry.path))
                elif (entry.name.endswith(_UNFINISHED)
                      and time.time() - status.st_mtime > _UNFINISHED_LIFE_S):
                    os.remove(entry.path)
        total = sum(size for _, size, _ in entries)
        for _, size, path in sorted(entries):
            if total <= self._limit:
                return
            if path != newest:
                with contextlib.suppress(FileNotFoundError):
                    os.remove(path)
                total -= size
