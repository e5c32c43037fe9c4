"""Decomposes meshes into convex parts for dynamic bodies: in PyBullet only convex shapes can move.

A convex mesh becomes its hull at once. Others are decomposed by a separate process,
`python -m my_simulations.engine.convex.decomposition FOLDER CPU_SECONDS NICE`, because it takes
seconds and V-HACD may crash. Only its processor time is limited, so that a mesh gives the same
parts on a busy machine.
"""
from __future__ import annotations

import logging
import os
import re
import resource
import select
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from typing import Any, Callable, Dict, List, Optional, Sequence

from ...child_process import child_command, child_environment, die_with_parent, shielded
from ...description.shapes import MeshData
from ...errors import Issue, warning
from ..scratch_folder import Scratch
from .cache import Decomposition, PartsCache, content_key, default_folder, load, save

_log = logging.getLogger(__name__)

# Relative lengths: meshes are centred and scaled to a longest edge of 1 for V-HACD.
_VHACD: Dict[str, Any] = {"concavity": 0.0025, "alpha": 0.04, "resolution": 100000,
                          "planeDownsampling": 8, "convexhullDownsampling": 8,
                          "maxNumVerticesPerCH": 64}
_VERSION = 3  # increase it when a mesh gives other parts than before
_PARAMETERS = f"{_VERSION} {sorted(_VHACD.items())!r}"
_THICKNESS_M = (0.001, 0.01)  # a flat mesh gets 1/100 of its extent, within these
_INPUT, _RESULT, _FALLBACK, _FAULTS = "mesh.npz", "result.parts", "hull.parts", "faults"
_CPU_S = 30           # V-HACD may not terminate, e.g. for thin rings; then: the hull
_DEADLINE_S = 900.0   # only for work without progress: a busy machine must not matter
_NICE = 5
_MOST_AT_ONCE = 20000  # most triangles that are checked in this process, to avoid delays
_PROGRESS = re.compile(rb"^ *(\d+)% \[", re.MULTILINE)

_FLAT, _NOT_DIVIDED = "mesh-flat", "mesh-not-decomposed"
_NOTICES = {
    _FLAT: ("the mesh has no volume; it collides as a thin solid",
                  "avoid zero thickness: give it some, or use a box"),
    _NOT_DIVIDED: ("the mesh could not be divided into convex parts; it collides as its convex "
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
    found = _cache(cache_dir).get(content_key(mesh, _PARAMETERS))
    if found is not None or len(mesh.triangles) > _MOST_AT_ONCE:
        return found
    return _frame(mesh.vertices).parts_at_once(mesh.triangles)


def divided(mesh: MeshData, *, cache_dir: Optional[str] = None, progress: Progress = _silent,
            deadline: float = _DEADLINE_S, cpu_seconds: int = _CPU_S,
            gently: bool = False) -> Decomposition:
    """The convex parts of a mesh by V-HACD, which are cached; blocks for seconds.

    Together they approximate the mesh; each has about 64 corners at most. A mesh that cannot be
    decomposed within `cpu_seconds` gives its hull.

    Args:
        mesh: finite vertices, m; with or without openings.
        cache_dir: folder of the cache; None for the user's cache folder (XDG).
        progress: called with the progress in per cent.
        deadline: wall seconds without progress after which it is aborted.
        cpu_seconds: limit of processor time; a mesh that needs more is not tried again.
        gently: run at low priority, because a world is running meanwhile.
    """
    limits = (str(cpu_seconds), str(_NICE if gently else 0))
    try:
        made, whole = _in_child(mesh, progress, time.monotonic() + deadline, limits)
    except OSError as fault:  # no disk space or no more processes
        _log.warning("dividing a mesh was not possible: %s", fault)
        return undivided(mesh)
    if whole:  # may succeed another time
        _cache(cache_dir).put(content_key(mesh, _PARAMETERS), made)
    return made


def undivided(mesh: MeshData) -> Decomposition:
    """A mesh that is represented by its hull."""
    return Decomposition([mesh], _NOT_DIVIDED)


def notices(made: Decomposition) -> List[Issue]:
    """The warning of a decomposition, if any, without a file."""
    if not made.notice:
        return []
    message, hint = _NOTICES.get(made.notice, _NOTICES[_NOT_DIVIDED])
    return [warning(made.notice, message, hint=hint)]


def kept_in(cache_dir: Optional[str] = None) -> str:
    """The folder of the cache."""
    return default_folder() if cache_dir is None else cache_dir


def _cache(cache_dir: Optional[str]) -> PartsCache:
    return PartsCache(kept_in(cache_dir))


def _in_child(mesh: MeshData, progress: Progress, end: float,
              limits: Sequence[str]) -> "tuple[Decomposition, bool]":
    """Decompose in a child process; also returns whether it finished in time."""
    import numpy as np

    with Scratch() as scratch:
        folder = scratch.path
        np.savez(os.path.join(folder, _INPUT), vertices=mesh.vertices, triangles=mesh.triangles)
        in_time = _run(folder, progress, end, limits)
        for name in (_RESULT, _FALLBACK):
            try:
                return load(os.path.join(folder, name)), in_time
            except (OSError, ValueError) as fault:
                _log.debug("no decomposition in %s: %s", name, fault)
    return undivided(mesh), False


def _run(folder: str, progress: Progress, end: float, limits: Sequence[str]) -> bool:
    """Run the child; False if it was killed at its deadline."""
    faults = os.path.join(folder, _FAULTS)
    with open(faults, "wb") as stream:
        with shielded():
            started = subprocess.Popen(
                child_command("engine.convex.decomposition", folder, *limits),
                stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=stream, cwd=folder,
                env=child_environment())
        in_time = _watched(started, progress, end)
    if in_time and started.returncode not in (0, -signal.SIGXCPU):
        with open(faults, "rb") as said:
            _log.warning("dividing a mesh ended with code %s: %s", started.returncode,
                         said.read()[-2000:].decode(errors="replace").strip())
    return in_time


def _watched(started: "subprocess.Popen[bytes]", progress: Progress, end: float) -> bool:
    with started as child:
        assert child.stdout is not None
        try:
            in_time = _follow(child.stdout.fileno(), progress, end)
            if in_time:
                child.wait()
        finally:
            child.kill()
    return in_time


def _follow(output: int, progress: Progress, end: float) -> bool:
    """Report the progress of the child until it closes its output; False at the deadline."""
    told, rest = 0, b""
    while True:
        left = end - time.monotonic()
        if left <= 0 or not select.select([output], [], [], left)[0]:
            return False
        said = os.read(output, 65536)
        if not said:
            return True
        lines = rest + said
        rest = lines[lines.rfind(b"\n") + 1:]
        for found in _PROGRESS.findall(lines):
            if int(found) >= told + 10:
                told = int(found)
                progress(told)


def main(argv: List[str]) -> int:
    """Decompose the mesh in a folder; writes the hull first, then the result, beside it."""
    import numpy as np

    die_with_parent()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent ends it
    folder, limit = argv[1], int(argv[2])
    os.nice(int(argv[3]))
    resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 5))
    with np.load(os.path.join(folder, _INPUT), allow_pickle=False) as held:
        made = _decomposed(held["vertices"], held["triangles"], folder)
    unfinished = os.path.join(folder, _RESULT + ".new")
    save(unfinished, made)
    os.replace(unfinished, os.path.join(folder, _RESULT))
    return 0


@dataclass(frozen=True)
class _Frame:
    """A mesh centred and scaled to a longest edge of 1, and the inverse transform."""

    points: Any
    centre: Any
    size: float

    def result(self, solids: Sequence[Any], notice: str = "") -> Decomposition:
        """Transform solids of this frame to parts in the frame of the mesh."""
        return Decomposition([MeshData(solid.vertices * self.size + self.centre, solid.faces)
                              for solid in solids], notice)

    def parts_at_once(self, triangles: Any) -> Optional[Decomposition]:
        """The parts of a mesh that need not be decomposed; None for other meshes."""
        from . import hulls

        if hulls.is_flat(self.points):
            least, most = _THICKNESS_M
            thickness = min(max(self.size / 100, least), most) / self.size
            return self.result([hulls.thickened(self.points, thickness)], _FLAT)
        mesh = hulls.cleaned(self.points, triangles)
        if not len(mesh.faces):
            return self.result([hulls.hull_of(self.points)], _NOT_DIVIDED)
        if hulls.is_convex(mesh):
            return self.result([hulls.hull_of(mesh.vertices)])
        pieces = hulls.convex_pieces(mesh)
        return self.result(pieces) if pieces else None


def _frame(vertices: Any) -> _Frame:
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    centre, size = (low + high) / 2, max(float((high - low).max()), 1e-9)
    return _Frame((vertices - centre) / size, centre, size)


def _decomposed(vertices: Any, triangles: Any, folder: str) -> Decomposition:
    from . import hulls

    frame = _frame(vertices)
    if len(triangles) > _MOST_AT_ONCE:  # otherwise it must be decomposed
        made = frame.parts_at_once(triangles)
        if made is not None:
            return made
    hull = hulls.hull_of(frame.points)
    save(os.path.join(folder, _FALLBACK), frame.result([hull], _NOT_DIVIDED))
    pieces = _divided(hulls.cleaned(frame.points, triangles), folder)
    return frame.result(pieces) if pieces else frame.result([hull], _NOT_DIVIDED)


def _divided(mesh: Any, folder: str) -> List[Any]:
    """The hulls found by V-HACD, with a limited number of corners."""
    import pybullet
    import trimesh

    from . import hulls

    source, target = os.path.join(folder, "in.obj"), os.path.join(folder, "out.obj")
    with open(source, "w", encoding="ascii") as stream:
        stream.writelines(f"v {x:.9f} {y:.9f} {z:.9f}\n" for x, y, z in mesh.vertices.tolist())
        stream.writelines(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in mesh.faces.tolist())
    pybullet.vhacd(source, target, os.path.join(folder, "log"), **_VHACD)
    found = trimesh.load_scene(target, file_type="obj", process=False, split_objects=True,
                               group_material=False)
    hull = hulls.full_hull(mesh.vertices)
    pieces = [hulls.drawn_in(piece.vertices, hull) for piece in found.geometry.values()]
    pieces = [hulls.hull_of(points, hulls.PART_VERTICES).vertices for points in pieces
              if not hulls.is_flat(points)]
    return [hulls.full_hull(points) for points in hulls.stretched(pieces, mesh.vertices)] \
        if pieces else []


if __name__ == "__main__":
    sys.exit(main(sys.argv))
