"""Decomposes the meshes of a world into convex parts, one a processor, and reports progress."""
from __future__ import annotations

import functools
import os
import queue
import threading
import time
from typing import Callable, Dict, List, Optional, Sequence, Tuple

from ...description.shapes import MeshData
from .cache import Decomposition, content_key
from .decomposition import MeshDecomposer, cache_folder_of, hull_only, ready_parts

_MOST_WORKERS = 4  # each takes about 80 MB
PROGRESS_EVERY_S = 2.0
"""Longest time between two progress messages, s."""

Progress = Callable[[str], None]
Named = Tuple[str, MeshData]


def decompose_all(meshes: Sequence[Named], progress: Progress, *,
               cache_dir: Optional[str] = None, gently: bool = False) -> List[Decomposition]:
    """The convex parts of each mesh, in order.

    Blocks until all are done, so that a world starts with the same shapes whether they were cached
    or not. Reports the meshes to decompose, the start and end of each, and the progress every few
    seconds. The threads are daemons and their processes end with them, so a program that exits does
    not wait.

    Args:
        meshes: name for messages, and mesh.
        progress: called with messages, from this thread.
        cache_dir: folder of the cache; None for the user's cache folder (XDG).
        gently: run at low priority, because a world is running meanwhile.
    """
    found: Dict[int, Decomposition] = {}
    remaining: Dict[str, List[int]] = {}  # equal meshes in two files are decomposed once
    for n, (_, mesh) in enumerate(meshes):
        ready = ready_parts(mesh, cache_dir=cache_dir)
        if ready is None:
            remaining.setdefault(content_key(mesh, ""), []).append(n)
        else:
            found[n] = ready
    if remaining:
        work = _Work([meshes[same[0]] for same in remaining.values()], progress, cache_dir,
                     gently)
        for same, made in zip(remaining.values(), work.done()):
            found.update((n, made) for n in same)
    return [found[n] for n in range(len(meshes))]


class _Work:
    """Meshes that are being decomposed."""

    def __init__(self, meshes: Sequence[Named], progress: Progress,
                 cache_dir: Optional[str], gently: bool) -> None:
        self._meshes = meshes
        self._progress = progress
        self._cache_dir = cache_dir
        self._gently = gently
        self._began = time.monotonic()
        self._waiting: "queue.Queue[int]" = queue.Queue()
        self._reports: "queue.Queue[Tuple[int, Optional[Decomposition]]]" = queue.Queue()
        self._busy: Dict[int, float] = {}
        self._percent: Dict[int, int] = {}
        self._made: Dict[int, Decomposition] = {}

    def done(self) -> List[Decomposition]:
        """Decompose all meshes; returns when the last one is done."""
        count = len(self._meshes)
        several = f"{count} meshes are" if count > 1 else "a mesh is"
        self._progress(f"{several} divided into convex parts before the world goes on; the parts "
                       f"are kept in {cache_folder_of(self._cache_dir)}")
        for n in sorted(range(count), key=lambda n: -len(self._meshes[n][1].triangles)):
            self._waiting.put(n)  # the longest work first, so that all workers end together
        threads = [threading.Thread(target=self._decompose_waiting, name="convex parts",
                                    daemon=True)
                   for _ in range(min(count, _MOST_WORKERS, len(os.sched_getaffinity(0))))]
        for thread in threads:
            thread.start()
        while len(self._made) < count:
            self._receive()
        for thread in threads:  # until their workers have ended
            thread.join()
        self._progress(f"convex parts are ready after {self._seconds(self._began)}")
        return [self._made[n] for n in range(count)]

    def _decompose_waiting(self) -> None:
        with MeshDecomposer(cache_dir=self._cache_dir, gently=self._gently) as decomposer:
            while True:
                try:
                    n = self._waiting.get_nowait()
                except queue.Empty:
                    return
                self._reports.put((n, None))
                made = hull_only(self._meshes[n][1])
                try:
                    made = decomposer.decompose(self._meshes[n][1],
                                          functools.partial(self._percent.__setitem__, n))
                finally:  # any exception must reach the waiting thread
                    self._reports.put((n, made))

    def _receive(self) -> None:
        try:
            n, made = self._reports.get(timeout=PROGRESS_EVERY_S)
        except queue.Empty:
            at = "; ".join(f"{self._name(n)}, {self._percent.get(n, 0)} % in "
                           f"{self._seconds(since)}"
                           for n, since in sorted(self._busy.items()))
            self._progress(f"{len(self._made)} of {len(self._meshes)} meshes divided after "
                           f"{self._seconds(self._began)}; at work: {at}")
            return
        if made is None:
            self._busy[n] = time.monotonic()
            triangles = len(self._meshes[n][1].triangles)
            self._progress(f"dividing {self._name(n)}, {triangles} triangles")
            return
        took = self._seconds(self._busy.pop(n))
        self._made[n] = made
        parts = len(made.parts)
        said = f"{parts} convex parts in" if parts > 1 else "its hull after"
        self._progress(f"{self._name(n)}: {said} {took}")

    def _name(self, n: int) -> str:
        return f"mesh {n + 1} of {len(self._meshes)} ({self._meshes[n][0]})"

    @staticmethod
    def _seconds(since: float) -> str:
        return f"{time.monotonic() - since:.1f} s"
