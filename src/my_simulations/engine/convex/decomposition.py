"""Decomposes meshes into convex parts for dynamic bodies: in PyBullet only convex shapes can move.

A convex mesh becomes its hull at once. Others are decomposed by `worker` processes, because that
takes up to a second each and V-HACD may crash. Only its processor time is limited, so that a mesh
gives the same parts on a busy machine.
"""
from __future__ import annotations

import contextlib
import logging
import os
import re
import signal
import subprocess
import time
from typing import Callable, List, Optional

from ...child_process import child_command, child_environment, signals_blocked
from ...description.shapes import MeshData
from ...errors import Issue, warning
from ...readable import wait_until_readable
from ..scratch_folder import Scratch
from .cache import Decomposition, PartsCache, content_key, default_folder, load
from .frame import FLAT, NOT_DIVIDED, frame_of
from .worker import DONE, FALLBACK, INPUT, MOST_AT_ONCE, PARAMETERS, RESULT

_log = logging.getLogger(__name__)

_FAULTS = "faults"    # what a worker writes on the standard error
_CPU_S = 30           # V-HACD may not terminate, e.g. for thin rings; then: the hull
_DEADLINE_S = 900.0   # only for work without progress: a busy machine must not matter
_NICE = 5
_PROGRESS = re.compile(rb"^ *(\d+)% \[", re.MULTILINE)

_NOTICES = {
    FLAT: ("the mesh has no volume; it collides as a thin solid",
           "avoid zero thickness: give it some, or use a box"),
    NOT_DIVIDED: ("the mesh could not be divided into convex parts; it collides as its convex "
                  "hull", "close its openings, or give simpler collision shapes"),
}

Progress = Callable[[int], None]


def _silent(_: int) -> None:
    return None


def ready_parts(mesh: MeshData, *, cache_dir: Optional[str] = None) -> Optional[Decomposition]:
    """The convex parts that are available at once; None if the mesh must be decomposed.

    Available are cached parts, and those of meshes that are convex, flat, or consist of separate
    convex pieces.
    """
    found = _cache(cache_dir).get(content_key(mesh, PARAMETERS))
    if found is not None or len(mesh.triangles) > MOST_AT_ONCE:
        return found
    return frame_of(mesh.vertices).parts_at_once(mesh.triangles)


class MeshDecomposer:
    """Decomposes one mesh after the other by V-HACD, in a worker process.

    The worker starts with the first mesh, and again with the mesh after one that ended it. The
    parts of a mesh do not depend on the meshes before it. As a context manager it ends the worker.

    Args:
        cache_dir: folder of the cache; None for the user's cache folder (XDG).
        deadline: wall seconds for a mesh after which it is aborted.
        cpu_seconds: limit of processor time; a mesh that needs more is not tried again.
        gently: run at low priority, because a world is running meanwhile.
    """

    def __init__(self, *, cache_dir: Optional[str] = None, deadline: float = _DEADLINE_S,
                 cpu_seconds: int = _CPU_S, gently: bool = False) -> None:
        self._cache = _cache(cache_dir)
        self._deadline = deadline
        self._limits = (str(cpu_seconds), str(_NICE if gently else 0))
        self._scratch = Scratch()
        self._worker: "Optional[subprocess.Popen[bytes]]" = None

    def __enter__(self) -> "MeshDecomposer":
        return self

    def __exit__(self, *_: object) -> None:
        self._end_worker()
        self._scratch.close()

    def decompose(self, mesh: MeshData, progress: Progress = _silent) -> Decomposition:
        """The convex parts of a mesh, which are cached; blocks.

        Together they approximate the mesh; each has about 64 corners at most. A mesh that cannot be
        decomposed within the limits gives its hull.

        Args:
            mesh: finite vertices, m; with or without openings.
            progress: called with the progress in per cent.
        """
        try:
            made, whole = self._by_worker(mesh, progress)
        except OSError as fault:  # a full disk, or too many processes
            _log.warning("dividing a mesh was not possible: %s", fault)
            return hull_only(mesh)
        if whole:  # otherwise it may succeed another time
            self._cache.put(content_key(mesh, PARAMETERS), made)
        return made

    def _by_worker(self, mesh: MeshData, progress: Progress) -> "tuple[Decomposition, bool]":
        """The parts, and whether the worker finished or ended in time."""
        import numpy as np

        folder = self._scratch.path
        for name in (RESULT, FALLBACK):
            with contextlib.suppress(FileNotFoundError):  # of the mesh before
                os.remove(os.path.join(folder, name))
        np.savez(os.path.join(folder, INPUT), vertices=mesh.vertices, triangles=mesh.triangles)
        in_time = self._run(folder, progress)
        for name in (RESULT, FALLBACK):
            try:
                return load(os.path.join(folder, name)), in_time
            except (OSError, ValueError) as fault:
                _log.debug("no decomposition in %s: %s", name, fault)
        return hull_only(mesh), False

    def _run(self, folder: str, progress: Progress) -> bool:
        """Let the worker decompose the mesh in the folder; False at the deadline."""
        worker = self._worker or self._start_worker(folder)
        assert worker.stdin is not None and worker.stdout is not None
        with contextlib.suppress(BrokenPipeError):  # it has ended, which is noticed below
            worker.stdin.write(b"\n")
        end = time.monotonic() + self._deadline
        if _follow(worker.stdout.fileno(), progress, end):
            return True
        in_time = time.monotonic() < end
        if in_time:
            worker.wait()
        self._end_worker()
        if in_time and worker.returncode != -signal.SIGXCPU:
            with open(os.path.join(folder, _FAULTS), "rb") as said:
                _log.warning("dividing a mesh ended with code %s: %s", worker.returncode,
                             said.read()[-2000:].decode(errors="replace").strip())
        return in_time

    def _start_worker(self, folder: str) -> "subprocess.Popen[bytes]":
        with open(os.path.join(folder, _FAULTS), "wb") as faults, signals_blocked():
            self._worker = subprocess.Popen(
                child_command("engine.convex.worker", folder, *self._limits), bufsize=0,
                stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=faults, cwd=folder,
                env=child_environment())
        return self._worker

    def _end_worker(self) -> None:
        if self._worker is not None:
            self._worker.kill()
            with self._worker:  # closes the pipes and waits
                self._worker = None


def hull_only(mesh: MeshData) -> Decomposition:
    return Decomposition([mesh], NOT_DIVIDED)


def decomposition_issues(made: Decomposition) -> List[Issue]:
    """The warning of a decomposition, if any, without a file."""
    if not made.notice:
        return []
    message, hint = _NOTICES.get(made.notice, _NOTICES[NOT_DIVIDED])
    return [warning(made.notice, message, hint=hint)]


def cache_folder_of(cache_dir: Optional[str] = None) -> str:
    return default_folder() if cache_dir is None else cache_dir


def _cache(cache_dir: Optional[str]) -> PartsCache:
    return PartsCache(cache_folder_of(cache_dir))


def _follow(output: int, progress: Progress, end: float) -> bool:
    """Report progress until the worker is done; False if it ended, or at the deadline."""
    reported, rest = 0, b""
    while True:
        left = end - time.monotonic()
        if left <= 0 or not wait_until_readable(output, left):
            return False
        said = os.read(output, 65536)
        if not said:
            return False
        lines = rest + said
        rest = lines[lines.rfind(b"\n") + 1:]
        for found in _PROGRESS.findall(lines):
            if int(found) >= reported + 10:
                reported = int(found)
                progress(reported)
        if DONE in lines.split(b"\n")[:-1]:
            return True
