"""Convex parts of a mesh, for bodies that move: PyBullet lets only convex shapes do that.

What is convex already is taken as its hull at once. The rest is divided by
`python -m my_simulations.engine.convex.decomposition FOLDER CPU_SECONDS NICE`, a process of its
own: it takes seconds, and V-HACD may crash. Only processor time limits it, so that a mesh gives the
same parts on a busy machine.
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

from ...description.shapes import MeshData
from ...errors import Issue, warning
from .. import child_process
from ..scratch_folder import Scratch
from .cache import Decomposition, PartsCache, content_key, default_folder, load, save

_log = logging.getLogger(__name__)

# Lengths are relative: V-HACD sees every mesh centred, its longest edge 1.
_VHACD: Dict[str, Any] = {"concavity": 0.0025, "alpha": 0.04, "resolution": 100000,
                          "planeDownsampling": 8, "convexhullDownsampling": 8,
                          "maxNumVerticesPerCH": 64}
_VERSION = 2  # to be raised when the same mesh gives other parts than before
_PARAMETERS = f"{_VERSION} {sorted(_VHACD.items())!r}"
_THICKNESS_M = (0.001, 0.01)  # of a mesh without volume: a hundredth of its extent within these
_INPUT, _RESULT, _FALLBACK, _FAULTS = "mesh.npz", "result.parts", "hull.parts", "faults"
_CPU_S = 30           # V-HACD never ends on some meshes, thin rings for one: then the hull it is
_DEADLINE_S = 900.0   # only for work that stands still: what a busy machine does must not count
_NICE = 5
_MOST_AT_ONCE = 20000  # triangles that are looked at in this process; more would hold it up
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
    """The convex parts that are to be had at once; None when the mesh must be divided first.

    At once are those in the cache, and those of meshes that are convex, flat, or made of separate
    convex pieces.
    """
    found = _cache(cache_dir).get(content_key(mesh, _PARAMETERS))
    if found is not None or len(mesh.triangles) > _MOST_AT_ONCE:
        return found
    return _frame(mesh.vertices).parts_at_once(mesh.triangles)


def divided(mesh: MeshData, *, cache_dir: Optional[str] = None, progress: Progress = _silent,
            deadline: float = _DEADLINE_S, cpu_seconds: int = _CPU_S,
            gently: bool = False) -> Decomposition:
    """The convex parts of a mesh by V-HACD, which are kept; blocks for seconds.

    Together they have the shape of the mesh; each has about 64 corners at most. A mesh that cannot
    be divided, in `cpu_seconds` or at all, gives its hull.

    Args:
        mesh: finite vertices, metres; with or without openings.
        cache_dir: where the parts are kept; None for the user's cache folder (XDG).
        progress: told how many per cent are done.
        deadline: seconds after which work that stands still is given up.
        cpu_seconds: processor time that it may take; a mesh that needs more is never tried again.
        gently: let physics that runs meanwhile come first.
    """
    limits = (str(cpu_seconds), str(_NICE if gently else 0))
    try:
        made, whole = _in_child(mesh, progress, time.monotonic() + deadline, limits)
    except OSError as fault:  # no room for files or for one more process
        _log.warning("dividing a mesh was not possible: %s", fault)
        return undivided(mesh)
    if whole:  # what only took too long may be done another time
        _cache(cache_dir).put(content_key(mesh, _PARAMETERS), made)
    return made


def undivided(mesh: MeshData) -> Decomposition:
    """A mesh whose hull must do."""
    return Decomposition([mesh], _NOT_DIVIDED)


def notices(made: Decomposition) -> List[Issue]:
    """The warning that goes with a decomposition, if there is one; without a file."""
    if not made.notice:
        return []
    message, hint = _NOTICES.get(made.notice, _NOTICES[_NOT_DIVIDED])
    return [warning(made.notice, message, hint=hint)]


def kept_in(cache_dir: Optional[str] = None) -> str:
    """The folder in which parts are kept."""
    return default_folder() if cache_dir is None else cache_dir


def _cache(cache_dir: Optional[str]) -> PartsCache:
    return PartsCache(kept_in(cache_dir))


def _in_child(mesh: MeshData, progress: Progress, end: float,
              limits: Sequence[str]) -> "tuple[Decomposition, bool]":
    """The work of a child process, and whether it came to its end in time."""
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
    """Run the child; False when it had to be killed because its time was over."""
    faults = os.path.join(folder, _FAULTS)
    with open(faults, "wb") as stream:
        with child_process.shielded():
            started = subprocess.Popen(
                child_process.command("engine.convex.decomposition", folder, *limits),
                stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=stream, cwd=folder,
                env=child_process.environment())
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
    """Pass on how far the child is until it closes its output; False when time is over."""
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
    """Divide the mesh in a folder; the result is put beside it, and first the hull alone."""
    import numpy as np

    child_process.die_with_parent()
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
    """A mesh centred, its longest edge 1, and the way back."""

    points: Any
    centre: Any
    size: float

    def result(self, solids: Sequence[Any], notice: str = "") -> Decomposition:
        """Solids in this frame as parts in the mesh's."""
        return Decomposition([MeshData(solid.vertices * self.size + self.centre, solid.faces)
                              for solid in solids], notice)

    def parts_at_once(self, triangles: Any) -> Optional[Decomposition]:
        """The parts of what need not be divided; None for other meshes."""
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
    if len(triangles) > _MOST_AT_ONCE:  # else it is known to need dividing
        made = frame.parts_at_once(triangles)
        if made is not None:
            return made
    hull = hulls.hull_of(frame.points)
    save(os.path.join(folder, _FALLBACK), frame.result([hull], _NOT_DIVIDED))
    pieces = _divided(hulls.cleaned(frame.points, triangles), folder)
    return frame.result(pieces) if pieces else frame.result([hull], _NOT_DIVIDED)


def _divided(mesh: Any, folder: str) -> List[Any]:
    """The hulls that V-HACD finds, with their corners limited."""
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
    pieces = [hulls.hull_of(points).vertices for points in pieces if not hulls.is_flat(points)]
    return [hulls.full_hull(points) for points in hulls.stretched(pieces, mesh.vertices)] \
        if pieces else []


if __name__ == "__main__":
    sys.exit(main(sys.argv))
