"""Reads files for `reader_process`: `python -m my_simulations.formats.reader_worker`.

Requests are lines of JSON from standard input. An answer is a length of 8 bytes, JSON, and the
bytes of its arrays. Each request brings its limits; a process that has grown large ends after it.
"""
from __future__ import annotations

import json
import os
import resource
import struct
import sys
from typing import Any, Callable, Dict, List, Tuple

from ..errors import InputError, error

_LARGE = 512 << 20
_FILES = 64


def read_mesh(path: str, submesh: str) -> Tuple[Any, List[Any]]:
    """Vertices and triangles of a mesh or of its parts with a name."""
    from .mesh.loading import triangles_of

    vertices, triangles = triangles_of(path, submesh)
    return None, [vertices.astype("<f8"), triangles.astype("<i8")]


def read_levels(path: str, widest: int, step: int) -> Tuple[Any, List[Any]]:
    """White and the grey levels of an image."""
    from .image.levels import levels_of

    levels = levels_of(path, widest, step)
    values = levels.values if levels.values.dtype.kind == "u" else levels.values.astype("<i4")
    return levels.white, [values]


def read_elevations(path: str, widest: int) -> Tuple[Any, List[Any]]:
    """The fields of `Elevations`; null for an image without heights."""
    from .image.levels import elevations_of

    found = elevations_of(path, widest)
    if found is None:
        return None, []
    return [found.shape, found.lowest, found.highest, found.extent], [found.heights.astype("<f8")]


def read_picture(path: str, largest: int) -> Tuple[Any, List[Any]]:
    """The pixels of a picture that is made smaller; null for one that cannot be read."""
    from .image.pixels import pixels_of

    found = pixels_of(path, largest)
    return found is not None, [] if found is None else [found]


def read_format(path: str) -> Tuple[Any, List[Any]]:
    """The format of a picture that can be decoded."""
    from .image.pixels import format_of

    return format_of(path), []


TASKS: Dict[str, Callable[..., Tuple[Any, List[Any]]]] = {
    "mesh": read_mesh, "levels": read_levels, "elevations": read_elevations,
    "picture": read_picture, "format": read_format}


def _limit(what: int, most: int) -> None:
    _, hard = resource.getrlimit(what)
    resource.setrlimit(what, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))


def _set_limits(memory: int, seconds: int) -> None:
    """Limits of what the next file may take in addition to what is in use."""
    with open("/proc/self/statm", encoding="ascii") as stream:
        used = int(stream.read().split()[0]) * resource.getpagesize()
    _limit(resource.RLIMIT_AS, used + memory)
    spent = resource.getrusage(resource.RUSAGE_SELF)
    _limit(resource.RLIMIT_CPU, int(spent.ru_utime + spent.ru_stime) + seconds + 1)


def _most_used() -> int:
    """The most memory this process had in use, in bytes.

    Not `ru_maxrss`, which begins with what the process had that started this one.
    """
    with open("/proc/self/status", encoding="ascii", errors="replace") as stream:
        return next(int(line.split()[1]) << 10 for line in stream if line.startswith("VmHWM:"))


def _answer(request: Dict[str, Any]) -> Tuple[Dict[str, Any], List[Any]]:
    path = request["path"]
    try:
        value, arrays = TASKS[request["task"]](path, **request["options"])
        return {"value": value, "arrays": [[array.dtype.str, array.shape] for array in arrays]}, (
            arrays)
    except InputError as fault:
        issues = fault.issues
    except MemoryError:
        issues = [error(_code(request), "it cannot be read: reading takes more than "
                        f"{request['memory'] >> 20} MB of memory", file=path)]
    except Exception as fault:  # the libraries raise various ones
        issues = [error(_code(request), f"it cannot be read: {type(fault).__name__}: {fault}",
                        file=path)]
    return {"issues": [issue.to_json() for issue in issues]}, []


def _code(request: Dict[str, Any]) -> str:
    return "mesh-unreadable" if request["task"] == "mesh" else "image-unreadable"


def main() -> None:
    """Answer until the caller closes the pipe."""
    for what, most in ((resource.RLIMIT_CORE, 0), (resource.RLIMIT_FSIZE, 0),
                       (resource.RLIMIT_NOFILE, _FILES)):
        _limit(what, most)
    # What a library prints must not be taken for an answer.
    out = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    for line in sys.stdin.buffer:
        request = json.loads(line)
        _set_limits(request["memory"], request["seconds"])
        header, arrays = _answer(request)
        text = json.dumps(header).encode()
        out.write(struct.pack("<Q", len(text)) + text)
        for array in arrays:
            out.write(array.tobytes())
        out.flush()
        if _most_used() > _LARGE:
            return


if __name__ == "__main__":
    main()
