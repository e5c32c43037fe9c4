"""COLLADA 1.4: the triangles of the visual scene, every instance in its place.

The file's unit is applied to everything, translations of nodes included; `up_axis` is not, as in
Gazebo, whose users have turned their models accordingly.
"""
from __future__ import annotations

import math
from typing import Any, Callable, Dict, Iterator, List, Optional, Tuple

from .mesh_part import MeshFault, MeshPart

_MOST_INSTANCES = 100000
_DEEPEST = 100


def read_collada(data: bytes) -> List[MeshPart]:
    """The pieces of a .dae file.

    Raises:
        MeshFault: not COLLADA, or numbers that do not fit each other.
    """
    from lxml import etree

    if b"<!ENTITY" in data:
        raise MeshFault("it declares entities, which are not read")
    parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False,
                             huge_tree=True, remove_comments=True)
    try:
        root = etree.fromstring(data, parser)
    except etree.XMLSyntaxError as fault:
        raise MeshFault(f"not well formed: {fault.msg}", fault.position[0]) from None
    if etree.QName(root).localname != "COLLADA":
        raise MeshFault(f"expected <COLLADA>, found <{etree.QName(root).localname}>", 1)
    return _Document(root).parts()


class _Document:
    def __init__(self, root: Any) -> None:
        self._root = root
        self._by_id: Dict[str, Any] = {e.get("id"): e for e in root.iter() if e.get("id")}
        self._meshes: Dict[int, Optional[Tuple[Any, Any]]] = {}

    def parts(self) -> List[MeshPart]:
        import numpy as np

        unit = self._unit()
        found: List[MeshPart] = []
        for names, geometry, matrix in self._instances():
            mesh = self._mesh(geometry)
            if mesh is not None:
                with np.errstate(all="ignore"):  # what is not finite is reported later
                    vertices = (mesh[0] @ matrix[:3, :3].T + matrix[:3, 3]) * unit
                triangles = mesh[1]
                if _determinant(matrix) < 0:
                    triangles = triangles[:, ::-1]  # a mirrored piece is inside out
                found.append(MeshPart(names, vertices, triangles))
        return found

    def _unit(self) -> float:
        unit = self._root.find("{*}asset/{*}unit")
        text = unit.get("meter", "1") if unit is not None else "1"
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not (value > 0 and math.isfinite(value)):
            raise MeshFault(f"the unit {text!r} is not a length in metres",
                            unit.sourceline if unit is not None else 0)
        return value

    def _instances(self) -> Iterator[Tuple[Tuple[str, ...], Any, Any]]:
        """(names, `<geometry>`, matrix to the scene) of every piece."""
        import numpy as np

        scene = self._scene()
        if scene is None:
            for geometry in self._root.iterfind("{*}library_geometries/{*}geometry"):
                yield _names(geometry), geometry, np.eye(4)
            return
        roots = list(scene.iterfind("{*}node"))
        waiting: List[Tuple[Any, Any, Tuple[str, ...], int]] = [
            (node, np.eye(4), (), 0) for node in reversed(roots)]
        count = 0
        while waiting:
            node, above, names, depth = waiting.pop()
            count += 1
            if count > _MOST_INSTANCES or depth > _DEEPEST:
                raise MeshFault("its nodes are nested without end", node.sourceline)
            matrix = above @ _matrix(node)
            names = (*_names(node), *names)
            for geometry, bind in self._geometries(node):
                yield (*_names(geometry), *names), geometry, matrix @ bind
            children = list(node.iterfind("{*}node"))
            children += [self._target(i) for i in node.iterfind("{*}instance_node")]
            waiting += [(c, matrix, names, depth + 1) for c in reversed(children) if c is not None]

    def _scene(self) -> Optional[Any]:
        instance = self._root.find("{*}scene/{*}instance_visual_scene")
        scene = self._target(instance) if instance is not None else None
        return scene if scene is not None else self._root.find(
            "{*}library_visual_scenes/{*}visual_scene")

    def _target(self, instance: Any, attribute: str = "url") -> Optional[Any]:
        """What a reference within the file names; None for nothing, and for other files."""
        url = instance.get(attribute) or ""
        return self._by_id.get(url[1:]) if url.startswith("#") else None

    def _geometries(self, node: Any) -> Iterator[Tuple[Any, Any]]:
        """(`<geometry>`, matrix that its skin binds it with) of the node itself."""
        import numpy as np

        for instance in node.iterfind("{*}instance_geometry"):
            geometry = self._target(instance)
            if geometry is not None:
                yield geometry, np.eye(4)
        for instance in node.iterfind("{*}instance_controller"):
            bind, source = np.eye(4), self._target(instance)
            for _ in range(3):  # a skin may refer to a morph, and that to a geometry
                if source is None or not source.tag.endswith("}controller"):
                    break
                inner = source.find("{*}skin")
                inner = inner if inner is not None else source.find("{*}morph")
                shape = inner.find("{*}bind_shape_matrix") if inner is not None else None
                if shape is not None:
                    bind = bind @ _numbers(shape, 16).reshape(4, 4)
                source = self._target(inner, "source") if inner is not None else None
            if source is not None and source.tag.endswith("}geometry"):
                yield source, bind

    def _mesh(self, geometry: Any) -> Optional[Tuple[Any, Any]]:
        """(vertices, triangles) of a geometry as it stands in the file."""
        if id(geometry) not in self._meshes:
            self._meshes[id(geometry)] = self._read_mesh(geometry)
        return self._meshes[id(geometry)]

    def _read_mesh(self, geometry: Any) -> Optional[Tuple[Any, Any]]:
        import numpy as np

        mesh = geometry.find("{*}mesh")
        vertices: List[Any] = []
        triangles: List[Any] = []
        first = 0
        for primitive in mesh if mesh is not None else ():
            read = _PRIMITIVES.get(_local(primitive))
            if read is None:
                continue
            indices, width, positions = self._indices(primitive)
            if positions is None:
                continue
            faces = read(primitive, indices, width)
            if len(faces) and (faces.min() < 0 or faces.max() >= len(positions)):
                raise MeshFault(f"<{_local(primitive)}> names a vertex that does not exist",
                                primitive.sourceline)
            vertices.append(positions)
            triangles.append(faces + first)
            first += len(positions)
        if not triangles:
            return None
        return np.concatenate(vertices), np.concatenate(triangles)

    def _indices(self, primitive: Any) -> Tuple[int, int, Any]:
        """(offset of the vertex in a tuple, length of a tuple, positions) of a primitive."""
        offset, width, positions = 0, 1, None
        for entry in primitive.iterfind("{*}input"):
            at = int(entry.get("offset") or 0)
            width = max(width, at + 1)
            if entry.get("semantic") == "VERTEX":
                offset, vertices = at, self._target(entry, "source")
                for inner in vertices.iterfind("{*}input") if vertices is not None else ():
                    if inner.get("semantic") == "POSITION":
                        positions = self._positions(inner)
            elif entry.get("semantic") == "POSITION":
                offset, positions = at, self._positions(entry)
        return offset, width, positions

    def _positions(self, entry: Any) -> Any:
        source = self._target(entry, "source")
        accessor = source.find("{*}technique_common/{*}accessor") if source is not None else None
        if source is None or accessor is None:
            raise MeshFault("the positions of its vertices are missing", entry.sourceline)
        array = self._target(accessor, "source")
        if array is None:
            array = source.find("{*}float_array")
        if array is None:
            raise MeshFault("the positions of its vertices are missing", entry.sourceline)
        stride = int(accessor.get("stride") or 3)
        numbers = _numbers(array)[int(accessor.get("offset") or 0):]
        if stride < 3 or len(numbers) % stride:
            raise MeshFault(f"{len(numbers)} numbers are not positions of {stride} each",
                            array.sourceline)
        return numbers.reshape(-1, stride)[:, :3]


def _local(element: Any) -> str:
    tag: str = element.tag if isinstance(element.tag, str) else ""
    return tag.rpartition("}")[2]


def _names(element: Any) -> Tuple[str, ...]:
    return tuple(name for name in (element.get("name"), element.get("id")) if name)


def _numbers(element: Any, count: int = 0) -> Any:
    import numpy as np

    try:
        numbers = np.array((element.text or "").split(), dtype=np.float64)
    except ValueError as fault:
        raise MeshFault(f"<{_local(element)}>: {fault}", element.sourceline) from None
    if count and len(numbers) != count:
        raise MeshFault(f"<{_local(element)}> has {len(numbers)} numbers instead of {count}",
                        element.sourceline)
    return numbers


def _integers(element: Any) -> Any:
    import numpy as np

    try:
        return np.array((element.text or "").split(), dtype=np.int64)
    except (ValueError, OverflowError) as fault:
        raise MeshFault(f"<{_local(element)}>: {fault}", element.sourceline) from None


def _matrix(node: Any) -> Any:
    """The product of a node's transforms, in their order."""
    import numpy as np

    matrix = np.eye(4)
    for child in node:
        make = _TRANSFORMS.get(_local(child))
        if make is not None:
            matrix = matrix @ make(child)
    return matrix


def _translate(element: Any) -> Any:
    import numpy as np

    matrix = np.eye(4)
    matrix[:3, 3] = _numbers(element, 3)
    return matrix


def _scale(element: Any) -> Any:
    import numpy as np

    return np.diag([*_numbers(element, 3), 1.0])


def _rotate(element: Any) -> Any:
    """An axis and an angle in degrees (Rodrigues)."""
    import numpy as np

    x, y, z, degrees = _numbers(element, 4)
    length = math.sqrt(x * x + y * y + z * z)
    matrix = np.eye(4)
    if length > 0:
        x, y, z = x / length, y / length, z / length
        k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        angle = math.radians(degrees)
        matrix[:3, :3] += math.sin(angle) * k + (1 - math.cos(angle)) * (k @ k)
    return matrix


def _determinant(matrix: Any) -> float:
    import numpy as np

    return float(np.linalg.det(matrix[:3, :3]))


_TRANSFORMS: Dict[str, Callable[[Any], Any]] = {
    "matrix": lambda element: _numbers(element, 16).reshape(4, 4),
    "translate": _translate, "scale": _scale, "rotate": _rotate,
}


def _corners(element: Any, offset: int, width: int) -> Any:
    indices = _integers(element)
    if len(indices) % width:
        raise MeshFault(f"{len(indices)} indices are not tuples of {width}", element.sourceline)
    return indices.reshape(-1, width)[:, offset]


def _fan(corners: Any) -> List[Tuple[int, int, int]]:
    return [(corners[0], corners[k], corners[k + 1]) for k in range(1, len(corners) - 1)]


def _strip(corners: Any) -> List[Tuple[int, int, int]]:
    # Every second triangle of a strip runs the other way round.
    return [(corners[k], corners[k + 1], corners[k + 2]) if k % 2 == 0 else
            (corners[k + 1], corners[k], corners[k + 2]) for k in range(len(corners) - 2)]


def _faces(triangles: List[Tuple[int, int, int]]) -> Any:
    import numpy as np

    return np.array(triangles, dtype=np.int64).reshape(-1, 3)


def _triangles(primitive: Any, offset: int, width: int) -> Any:
    import numpy as np

    pieces = [_corners(p, offset, width) for p in primitive.iterfind("{*}p")]
    corners = np.concatenate(pieces) if pieces else np.zeros(0, dtype=np.int64)
    if len(corners) % 3:
        raise MeshFault(f"{len(corners)} corners are not triangles", primitive.sourceline)
    return corners.reshape(-1, 3)


def _polylist(primitive: Any, offset: int, width: int) -> Any:
    counts, p = primitive.find("{*}vcount"), primitive.find("{*}p")
    if counts is None or p is None:
        return _faces([])
    corners, sizes = _corners(p, offset, width), _integers(counts)
    if sizes.sum() != len(corners):
        raise MeshFault("<vcount> and <p> do not fit each other", primitive.sourceline)
    if len(sizes) and (sizes == 3).all():
        return corners.reshape(-1, 3)
    faces: List[Tuple[int, int, int]] = []
    at = 0
    for size in sizes:
        faces += _fan(corners[at:at + size])
        at += size
    return _faces(faces)


def _many(shape: Callable[[Any], List[Tuple[int, int, int]]]) -> Callable[[Any, int, int], Any]:
    """A reader of primitives with one `<p>` for each piece; holes are not cut."""

    def read(primitive: Any, offset: int, width: int) -> Any:
        faces: List[Tuple[int, int, int]] = []
        for p in primitive.iter("{*}p"):
            faces += shape(_corners(p, offset, width))
        return _faces(faces)

    return read


_PRIMITIVES: Dict[str, Callable[[Any, int, int], Any]] = {
    "triangles": _triangles, "polylist": _polylist, "polygons": _many(_fan),
    "trifans": _many(_fan), "tristrips": _many(_strip),
}
