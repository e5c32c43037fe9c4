"""Decomposes meshes in a process of its own: `python -m my_simulations.engine.convex.worker`.

Arguments: FOLDER CPU_SECONDS NICE. For each line on the standard input it decomposes the mesh in
the folder, writes its hull and then the result beside it, and prints `DONE`. V-HACD prints its
progress before. The process ends with its input.
"""
from __future__ import annotations

import os
import resource
import signal
import sys
from typing import Any, Dict, List

from ...child_process import die_with_parent
from .cache import Decomposition, save
from .frame import NOT_DIVIDED, frame_of

INPUT, RESULT, FALLBACK = "mesh.npz", "result.parts", "hull.parts"
"""Files in the folder: the arrays `vertices` and `triangles`, the parts, and the hull."""

DONE = b"mesh done"
"""The line that follows the last line about a mesh."""

MOST_AT_ONCE = 20000
"""Most triangles that the simulator's process checks, to avoid delays."""

# Relative lengths: meshes are centred and scaled to a longest edge of 1 for V-HACD. Nearly all of
# its time are hulls of the voxels at both sides of a cut: at first 1/16 of the voxels at every
# fourth cut, then all at the nine around the best. Measured with 31 links and pieces of furniture,
# beside resolution 100000 and downsamplings 8 and 8: 35 % of the processor time, 260 parts instead
# of 316, and a mean distance of their surface to the mesh of 1.3 % instead of 1.2 % of the longest
# edge; the largest is 8.6 % instead of 8.8 %.
_VHACD: Dict[str, Any] = {"concavity": 0.0025, "alpha": 0.04, "resolution": 30000,
                          "planeDownsampling": 4, "convexhullDownsampling": 16,
                          "maxNumVerticesPerCH": 64}
# V-HACD lays at least 64 voxels along the shortest edge of the bounding box, so that a plate or a
# cog wheel gets millions and takes 6 to 10 s. Two vertices without a triangle widen the box to
# this share of the longest edge, which then has 128 voxels at most: the wheel takes 0.6 s and its
# parts are as near to it (mean distances of 1.4 % either way).
_LEAST_EDGE = 0.5
_VERSION = 4  # increase it when a mesh gives other parts than before
PARAMETERS = f"{_VERSION} {_LEAST_EDGE} {sorted(_VHACD.items())!r}"
"""Everything besides the mesh that its parts depend on."""


def main(argv: List[str]) -> int:
    """Decompose meshes until the input ends."""
    die_with_parent()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent ends it
    folder, seconds = argv[1], int(argv[2])
    os.nice(int(argv[3]))
    for _ in sys.stdin:
        _limit_processor_time(seconds)
        _decompose_file(folder)
        os.write(sys.stdout.fileno(), b"\n" + DONE + b"\n")
    return 0


def _limit_processor_time(seconds: int) -> None:
    """End this process by SIGXCPU when it has used that much time from now on."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    limit = int(used.ru_utime + used.ru_stime) + seconds
    resource.setrlimit(resource.RLIMIT_CPU, (limit, resource.RLIM_INFINITY))


def _decompose_file(folder: str) -> None:
    import numpy as np

    with np.load(os.path.join(folder, INPUT), allow_pickle=False) as held:
        made = _decompose(held["vertices"], held["triangles"], folder)
    unfinished = os.path.join(folder, RESULT + ".new")
    save(unfinished, made)
    os.replace(unfinished, os.path.join(folder, RESULT))


def _decompose(vertices: Any, triangles: Any, folder: str) -> Decomposition:
    from . import hulls

    frame = frame_of(vertices)
    if len(triangles) > MOST_AT_ONCE:  # otherwise the parent has checked it
        made = frame.parts_at_once(triangles)
        if made is not None:
            return made
    hull = hulls.hull_of(frame.points)
    save(os.path.join(folder, FALLBACK), frame.result([hull], NOT_DIVIDED))
    pieces = _run_vhacd(frame.points, triangles, folder)
    if len(pieces) == 1:  # the hull itself is nearer to the mesh than that of its voxels
        pieces = [hull]
    return frame.result(pieces) if pieces else frame.result([hull], NOT_DIVIDED)


def _run_vhacd(points: Any, triangles: Any, folder: str) -> List[Any]:
    """The hulls found by V-HACD, with a limited number of corners."""
    import numpy as np
    import pybullet

    from . import hulls

    used, corners = np.unique(triangles, return_inverse=True)
    vertices = points[used]
    source, target = os.path.join(folder, "in.obj"), os.path.join(folder, "out.obj")
    with open(source, "w", encoding="ascii") as stream:
        stream.writelines(f"v {x:.9f} {y:.9f} {z:.9f}\n"
                          for x, y, z in [*vertices.tolist(), *_box(vertices).tolist()])
        stream.writelines(f"f {a} {b} {c}\n" for a, b, c in (corners.reshape(-1, 3) + 1).tolist())
    pybullet.vhacd(source, target, os.path.join(folder, "log"), **_VHACD)
    hull = hulls.full_hull(vertices)
    pieces = [hulls.moved_onto_hull(piece, hull) for piece in _objects(target)]
    pieces = [hulls.hull_of(piece, hulls.PART_VERTICES).vertices for piece in pieces
              if not hulls.is_flat(piece)]
    return [hulls.full_hull(piece) for piece in hulls.stretch_parts(pieces, vertices)] \
        if pieces else []


def _box(vertices: Any) -> Any:
    """Two corners (2, 3) of the bounding box, with each edge widened to `_LEAST_EDGE`."""
    import numpy as np

    low, high = vertices.min(axis=0), vertices.max(axis=0)
    half = np.maximum(high - low, _LEAST_EDGE) / 2
    return np.stack([(low + high) / 2 - half, (low + high) / 2 + half])


def _objects(path: str) -> List[Any]:
    """The vertices (n, 3) of each object of an OBJ file that V-HACD wrote."""
    import numpy as np

    found: List[List[List[float]]] = []
    with open(path, encoding="ascii") as stream:
        for line in stream:
            kind, *values = line.split() or [""]
            if kind == "o":
                found.append([])
            elif kind == "v":
                found[-1].append([float(value) for value in values])
    return [np.array(points) for points in found if points]


if __name__ == "__main__":
    sys.exit(main(sys.argv))
