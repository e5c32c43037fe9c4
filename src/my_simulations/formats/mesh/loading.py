"""Loads mesh files: DAE, STL, OBJ and other formats of trimesh, as triangles in metres."""
from __future__ import annotations

import contextlib
import functools
import os
import re
from dataclasses import replace
from typing import Any, Callable, Iterator, List, Optional, Tuple

from ...description.cost_budget import Cost, budget_faults
from ...description.model import Link, Model
from ...description.shapes import SOLIDS, Collision, Mesh, MeshData, MeshTable, Solid, mesh_key
from ...description.validate import closest_name_hint
from ...errors import InputError, Issue, Severity, error, warning
from ...resources.lfs_pointer import LFS_HINT, LFS_POINTER, is_lfs_pointer
from ..loading_advice import UNKNOWN, Written, located_issue
from ..reader_process import read_elsewhere
from .collada_encoding import encoding_issues
from .declared_size import check_declared_size
from .part import MeshError, MeshPart
from .terrain import solid_mesh

Reader = Callable[[bytes], List[MeshPart]]

_PLAIN_BYTES = {".dae": 4 << 20, ".stl": 8 << 20, ".stla": 8 << 20, ".stlb": 8 << 20,
                ".obj": 4 << 20}
"""Largest files that are read in this process."""

_MOST_COPIES, _MOST_COPIED = 10_000, 128 << 20
_MOST_PRIMITIVES = 2000
_PRIMITIVES = (b"<tri", b"<pol", b"<p>")
_FARTHEST_M = 1e9
"""Largest coordinate: volumes and moments of inertia of meshes beyond it lose all their digits."""

_MOST_GROUPS = 2000
"""Most `o` and `g` lines of an OBJ file that is read in this process: each takes 20 us."""

_MOST_TAGS = 20_000
"""Most tags of a COLLADA file that is read in this process: each element takes about 1.6 kB."""


def load_mesh(mesh: Mesh) -> MeshData:
    """The triangles of a mesh file (m), with unit, scale, submesh and centring applied.

    The up axis of the file is not applied (Gazebo behaviour). The arrays are shared between calls
    and read-only. Raises InputError: with one issue: `mesh-not-found`, `mesh-unreadable`,
    `mesh-empty` (no faces, or no such part) or `mesh-not-finite`.
    """
    try:
        status = os.stat(mesh.path) if mesh.path else None
    except OSError:
        status = None
    if os.path.isdir(mesh.path):
        raise _fault("mesh-unreadable", f"the mesh {mesh.uri!r} names a folder", mesh.path)
    if status is None or not os.path.isfile(mesh.path):
        raise _fault("mesh-not-found", f"the mesh {mesh.uri!r} was not found", mesh.path)
    return _load_kept(mesh.path, status.st_mtime_ns, status.st_size, mesh.scale, mesh.submesh,
                      mesh.center)


def load_solid(solid: Solid) -> MeshData:
    """The triangles of a mesh, a terrain, a map image or a polygon.

    Exceptions of the readers are reported as faults of the file. Raises InputError: with one issue;
    see `load_mesh` and `solids.solid_mesh`.
    """
    try:
        return load_mesh(solid) if isinstance(solid, Mesh) else solid_mesh(solid)
    except InputError:
        raise
    except Exception as fault:
        raise _fault("mesh-unreadable", "the shape cannot be read: "
                     f"{type(fault).__name__}: {fault}", getattr(solid, "path", "")) from fault


def collision_meshes(model: Model, written: Written = UNKNOWN) -> Tuple[MeshTable, List[Issue]]:
    """Meshes of a model's collisions by `mesh_key`, and a warning for each that cannot be loaded.

    Collisions without their mesh cannot be simulated; `without_missing_meshes` removes them, as
    Gazebo does. Nested models are included. A mesh whose size suggests a wrong unit gets the
    warning `mesh-size-odd`. If all have more triangles than a model may have, the error
    `model-too-large` names the collision at which that is so, and the rest is not loaded.

    Args:
        model: the model, flattened or not.
        written: where it is written, for the error.
    """
    table: MeshTable = {}
    issues: List[Issue] = []
    triangles = 0
    for scope, link, collision in _collisions(model, ""):
        mesh = collision.geometry
        if not isinstance(mesh, SOLIDS):
            continue
        if mesh_key(mesh) not in table:
            where = f"collision {collision.name!r} of link {scope + link.name!r}"
            data, found = _collision_mesh(mesh, not model.static)
            issues += [replace(issue, message=f"{where}: {issue.message}") for issue in found]
            if data is None:
                continue
            table[mesh_key(mesh)] = data
        triangles += len(table[mesh_key(mesh)].triangles)
        for fault in budget_faults(Cost(triangles=triangles), model):
            issues.append(located_issue(replace(fault, subject=collision), [model], written))
            return table, issues
    return table, issues


def _collision_mesh(mesh: Solid, moves: bool) -> Tuple[Optional[MeshData], List[Issue]]:
    """The mesh of a collision, None if it cannot be loaded; and warnings."""
    try:
        data = load_solid(mesh)
    except InputError as fault:
        return None, [replace(issue, message=f"{issue.message}; it is skipped", tolerated=True,
                              severity=Severity.WARNING) for issue in fault.issues]
    if not isinstance(mesh, Mesh):
        return data, []
    return data, [*odd_size(mesh, data, moves=moves), *encoding_issues(mesh)]


def without_missing_meshes(model: Model, table: MeshTable) -> Model:
    """The model without the collisions whose mesh is not in `table`; links are kept."""

    def usable(collision: Collision) -> bool:
        mesh = collision.geometry
        return not isinstance(mesh, SOLIDS) or mesh_key(mesh) in table

    if all(usable(collision) for _, _, collision in _collisions(model, "")):
        return model
    links = [replace(link, collisions=[c for c in link.collisions if usable(c)])
             for link in model.links]
    return replace(model, links=links,
                   models=[without_missing_meshes(inner, table) for inner in model.models])


def _collisions(model: Model, scope: str) -> Iterator[Tuple[str, Link, Collision]]:
    for link in model.links:
        for collision in link.collisions:
            yield scope, link, collision
    for inner in model.models:
        yield from _collisions(inner, f"{scope}{inner.name}::")


def _fault(code: str, message: str, path: str, line: int = 0, hint: str = "") -> InputError:
    return InputError([error(code, message, file=path, line=line, hint=hint)])


@functools.lru_cache(maxsize=32)
def _load_kept(path: str, changed: int, size: int, scale: Tuple[float, float, float], submesh: str,
               center: bool) -> MeshData:
    """Cached by time and size of the file, so that another spawn of an object is fast."""
    try:
        check_declared_size(path, size)
    except OSError as fault:
        raise _fault("mesh-unreadable", f"cannot be read: {fault.strerror}", path) from None
    except MeshError as fault:
        raise _fault(fault.code, f"the mesh cannot be read: {fault}", path) from None
    read = _read_elsewhere if _is_costly(path, size) else triangles_of
    return _to_data(*read(path, submesh), path, scale, bool(submesh and center))


def _is_costly(path: str, size: int) -> bool:
    """Whether a file may take much more memory or time than its size suggests.

    Bytes of STL and OBJ are read one after the other. COLLADA may name its nodes again and again,
    and the other formats may have compressed or repeated parts.
    """
    extension = os.path.splitext(path)[1].lower()
    if extension == ".dae" and size <= _PLAIN_BYTES[extension]:
        with contextlib.suppress(OSError), open(path, "rb") as stream:
            data = stream.read(size)
            copies = data.count(b"instance_geometry") << min(data.count(b"<instance_node"), 32)
            return (copies > _MOST_COPIES or copies * size > _MOST_COPIED
                    or max(map(data.count, _PRIMITIVES)) > _MOST_PRIMITIVES
                    or data.count(b"<") > _MOST_TAGS)
    if extension == ".obj" and size <= _PLAIN_BYTES[extension]:
        with contextlib.suppress(OSError), open(path, "rb") as stream:
            data = stream.read(size)
            return max(data.count(b"\ng"), data.count(b"\no")) > _MOST_GROUPS
    return size > _PLAIN_BYTES.get(extension, -1)


def _read_elsewhere(path: str, submesh: str) -> Tuple[Any, Any]:
    """Return what `triangles_of` returns, read in another process with limits."""
    _, (vertices, triangles) = read_elsewhere("mesh", path, "mesh-unreadable", submesh=submesh)
    inside = len(triangles) and 0 <= triangles.min() and triangles.max() < len(vertices)
    if not inside or not vertices.shape[1:] == triangles.shape[1:] == (3,):
        raise _fault("mesh-unreadable", "the mesh cannot be read: its reader failed", path)
    return vertices, triangles


def triangles_of(path: str, submesh: str) -> Tuple[Any, Any]:
    """Vertices (m, unscaled) and triangles of a file or of its parts with a name.

    Read in this process. Raises InputError as `load_mesh`.
    """
    parts = _select_submesh(_parts(path), submesh, path)
    if not sum(len(part.triangles) for part in parts):
        raise _fault("mesh-empty", "the mesh has no faces", path)
    try:
        return _join_parts(parts)
    except MeshError as fault:
        raise _fault(fault.code, f"the mesh cannot be read: {fault}", path) from None


def _reader(path: str, extension: str) -> Optional[Reader]:
    # Imported with the first mesh: start-up time counts.
    if extension == ".dae":
        from .collada import read_collada

        return read_collada
    from .obj import read_obj
    from .stl import read_stl
    from .trimesh_formats import extensions, read_with_trimesh

    if extension in (".stl", ".stla", ".stlb"):
        return read_stl
    if extension == ".obj":
        return read_obj
    if extension in extensions():
        return functools.partial(read_with_trimesh, path=path)
    return None


def _parts(path: str) -> List[MeshPart]:
    extension = os.path.splitext(path)[1].lower()
    reader = _reader(path, extension)
    if reader is None:
        raise _fault("mesh-unreadable", f"{extension or 'a file without extension'} is not a mesh"
                     " format that is read", path, hint="use .dae, .stl or .obj")
    try:
        with open(path, "rb") as stream:
            data = stream.read()
        if is_lfs_pointer(data):
            raise _fault("mesh-unreadable", LFS_POINTER, path, hint=LFS_HINT)
        return reader(data)
    except OSError as fault:
        raise _fault("mesh-unreadable", f"cannot be read: {fault.strerror}", path) from None
    except MeshError as fault:
        said = "" if fault.code == "mesh-not-finite" else "the mesh cannot be read: "
        raise _fault(fault.code, f"{said}{fault}", path, fault.line) from None
    except (ValueError, OverflowError) as fault:  # an attribute that is not a number
        raise _fault("mesh-unreadable", f"the mesh cannot be read: {fault}", path) from None


def _select_submesh(parts: List[MeshPart], submesh: str, path: str) -> List[MeshPart]:
    if not submesh:
        return parts
    chosen = [part for part in parts if submesh in part.names]
    if not chosen:
        known = [name for part in parts for name in part.names]
        raise _fault("mesh-empty", f"the mesh has no part {submesh!r}", path,
                     hint=closest_name_hint(submesh, known))
    return chosen


def _to_data(vertices: Any, triangles: Any, path: str, scale: Tuple[float, float, float],
             center: bool) -> MeshData:
    import numpy as np

    if not np.isfinite(vertices).all():
        raise _fault("mesh-not-finite", "the mesh has vertices that are not finite numbers", path)
    with np.errstate(over="ignore", invalid="ignore"):
        if center:
            vertices = vertices - (vertices.min(axis=0) + vertices.max(axis=0)) / 2
        vertices = vertices * np.array(scale)
    if scale[0] * scale[1] * scale[2] < 0:
        triangles = triangles[:, ::-1]  # mirrored: reverse the winding
    vertices = np.ascontiguousarray(vertices)
    if not np.abs(vertices).max() <= _FARTHEST_M:
        raise _fault("mesh-not-finite", f"the mesh has vertices beyond {_FARTHEST_M:g} m", path)
    triangles = np.ascontiguousarray(triangles, dtype=np.int32)
    vertices.flags.writeable = triangles.flags.writeable = False
    return MeshData(vertices, triangles)


def _join_parts(parts: List[MeshPart]) -> Tuple[Any, Any]:
    """One array of all used vertices, and the triangles that index it."""
    import numpy as np

    vertices, triangles, first = [], [], 0
    for part in parts:
        corners = part.triangles
        if len(corners) and (corners.min() < 0 or corners.max() >= len(part.vertices)):
            raise MeshError("a triangle names a vertex that does not exist")
        if corners.size < len(part.vertices):
            used, numbers = np.unique(corners, return_inverse=True)
            numbers = numbers.reshape(-1, 3)
        else:  # in proportion to the number of vertices, without sorting
            used = np.zeros(len(part.vertices), dtype=bool)
            used[corners.reshape(-1)] = True
            numbers = (np.cumsum(used) - 1)[corners]
        vertices.append(part.vertices[used])
        triangles.append(numbers + first)
        first += len(vertices[-1])
    return np.concatenate(vertices), np.concatenate(triangles)


_LARGEST_M = 25.0
_SMALLEST_M = 3.0
_STATIC_M = 10.0
_INCH_M = 0.0254
_HEAD_BYTES = 8192  # the <asset> of a .dae is at its beginning
_TOOL = re.compile(rb"<authoring_tool>[^<]*SketchUp", re.IGNORECASE)
_UNIT = re.compile(rb"<unit\b[^>]*\bmeter\s*=\s*[\"']([^\"']*)[\"']")


def odd_size(mesh: Mesh, data: MeshData, moves: bool) -> List[Issue]:
    """A warning for a mesh of more than 25 m in a model that is not static.

    Also for a static model if the file claims to be written by SketchUp, which uses inches, in
    metres. For a Collada file without `<unit>`, which means metres, the limit is 3 m, or 10 m in a
    static model: half a metre written in inches is 20. The mesh is not changed, because the size
    may be intended: public models of that size are either buildings, which are static, or files
    with a wrong unit, which their models correct by `<scale>`.

    Args:
        mesh: the mesh, with the path of its file.
        data: its triangles, scale applied.
        moves: False for a static model.
    """
    size = float((data.vertices.max(axis=0) - data.vertices.min(axis=0)).max())
    if size <= _SMALLEST_M:
        return []
    head = _collada_head(mesh.path)
    unitless = bool(head) and _UNIT.search(head) is None
    if unitless:
        odd = size > (_SMALLEST_M if moves else _STATIC_M)
    else:
        odd = size > _LARGEST_M and (moves or _lost_inches(head))
    if not odd:
        return []
    why = (": its file names no <unit>, so its numbers are metres" if unitless
           else ", which may be a lost unit")
    return [warning(
        "mesh-size-odd", f"the mesh is {size:.4g} m long{why}", file=mesh.path,
        hint=f"with a scale of {_INCH_M} it is {size * _INCH_M:.3g} m (inches), with 0.001 "
             f"{size * 0.001:.3g} m (millimetres)")]


def _collada_head(path: str) -> bytes:
    """The beginning of a Collada file with its `<asset>`; b"" for other files."""
    if os.path.splitext(path)[1].lower() != ".dae":
        return b""
    try:
        with open(path, "rb") as stream:
            return stream.read(_HEAD_BYTES)
    except OSError:  # deleted since it was loaded; the warning is optional
        return b""


def _lost_inches(head: bytes) -> bool:
    unit = _UNIT.search(head)
    return bool(_TOOL.search(head)) and (unit is None or unit.group(1).strip() in (b"1", b"1.0"))
