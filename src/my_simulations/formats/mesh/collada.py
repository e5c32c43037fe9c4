"""Reads the surfaces of COLLADA files.

`up_axis` is not applied (Gazebo behaviour). Files of exporters name materials, images, normals and
nodes that do not exist: only what a shape needs must be right.
"""
from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Any, Dict, Iterator, List, Optional, Tuple

import numpy as np

from .collada_encoding import without_stray_bytes
from .node_tree import Array, floats, local_matrix, placings_of
from .part import MeshError, MeshPart, check_triangle_count

MOST_COLLADA_NODES = 100_000
_DEEPEST = 100
_NODE_TAGS = (b"<node", b"<instance_node", b"<instance_geometry", b"<instance_controller")
_MOST_TAGS = 1_000_000  # an element takes about 200 bytes
_IN_NODES = ("{*}node", "{*}instance_node", "{*}instance_geometry", "{*}instance_controller")
_PRIMITIVES = ("{*}triangles", "{*}trifans", "{*}tristrips", "{*}polylist", "{*}polygons")
_ANGLE_IN_VALUE = re.compile(rb'(?<==")[^"<\n]*<[^"\n]*(?=")')
"""An attribute value with `<`: not allowed in XML, accepted by TinyXML; `name="<STL_BINARY>"`."""
_NAMESPACE = "http://www.collada.org/2005/11/COLLADASchema"
_NO_POSITIONS = "the positions of its vertices are missing"


def read_collada(data: bytes) -> List[MeshPart]:
    """The parts of a .dae file, in metres. Raises MeshError: not COLLADA, or invalid numbers."""
    root = parse_collada(data)
    try:
        unit = unit_of(root)
        with np.errstate(all="ignore"):  # non-finite numbers are reported later
            made = (_part(instance, unit) for instance in ColladaDocument(root).instances())
            return check_triangle_count(part for part in made if part is not None)
    except (ValueError, OverflowError) as fault:  # an attribute or a transform
        raise MeshError(str(fault)) from None


def _part(instance: "Instance", unit: float) -> Optional[MeshPart]:
    surfaces = instance.surfaces
    if not surfaces:
        return None
    firsts = np.cumsum([0] + [len(surface.positions) for surface in surfaces])
    triangles = np.concatenate([surface.triangles + first
                                for surface, first in zip(surfaces, firsts)])
    positions = np.concatenate([surface.positions for surface in surfaces])
    matrix = instance.matrix
    return MeshPart(instance.names, (positions @ matrix[:3, :3].T + matrix[:3, 3]) * unit,
                    triangles[:, ::-1] if is_mirrored(matrix) else triangles)


def parse_collada(data: bytes) -> Any:
    """Parse the `<COLLADA>` element of a file; put its elements into COLLADA's namespace.

    Raises MeshError: not COLLADA.
    """
    from lxml import etree

    if b"<!ENTITY" in data:
        raise MeshError("it declares entities, which are not read")
    if sum(map(data.count, _NODE_TAGS)) > MOST_COLLADA_NODES or data.count(b"<") > _MOST_TAGS:
        raise MeshError(f"it has more than {MOST_COLLADA_NODES} nodes or {_MOST_TAGS} tags")
    root = _parse_leniently(without_stray_bytes(data))
    name = etree.QName(root)
    if name.localname != "COLLADA":
        raise MeshError(f"expected <COLLADA>, found <{name.localname}>", 1)
    if not name.namespace:
        for element in root.iter():
            element.tag = f"{{{_NAMESPACE}}}{_local_name(element)}"
    return root


def _parse_leniently(data: bytes) -> Any:
    """Parse XML; if that fails, parse it with `<` in attribute values escaped. Raises MeshError."""
    from lxml import etree

    def parse(text: bytes) -> Any:
        return etree.fromstring(text, etree.XMLParser(
            resolve_entities=False, no_network=True, load_dtd=False, huge_tree=True,
            remove_comments=True, remove_pis=True))

    try:
        return parse(data)
    except etree.XMLSyntaxError as fault:
        mistake = MeshError(f"not well formed: {fault.msg}", fault.position[0])
    escaped, count = _ANGLE_IN_VALUE.subn(lambda value: value.group().replace(b"<", b"&lt;"), data)
    if not count:
        raise mistake
    try:
        return parse(escaped)
    except etree.XMLSyntaxError:
        raise mistake from None


def unit_of(root: Any) -> float:
    """The length of a file's unit, m. Raises MeshError: it is no length."""
    element = root.find("{*}asset/{*}unit")
    text = element.get("meter") if element is not None else None
    if text is None:
        return 1.0
    try:
        unit = float(text)
    except ValueError:
        unit = math.nan
    if not (unit > 0 and math.isfinite(unit)):
        raise MeshError(f"the unit {text!r} is not a length in metres", element.sourceline)
    return unit


_Inputs = Dict[str, Tuple[Any, int]]
"""The `<source>` of each semantic, and its place among the indices of a corner."""


class Surface:
    """The triangles of one primitive of a geometry, in the file's unit.

    Attributes:
        positions: (n, 3) of vertices.
        triangles: (m, 3) vertex indices.
        material: symbol of its material; None for none.
    """

    def __init__(self, document: "ColladaDocument", rows: Array, inputs: _Inputs,
                 material: Optional[str]) -> None:
        self._document, self._rows, self._inputs = document, rows, inputs
        source, offset = inputs["VERTEX"]
        self.positions = document.numbers_of(source, 3)
        self.triangles = rows[:, :, offset]
        self.material = material

    def corner_values(self, semantic: str, width: int) -> Optional[Array]:
        """(m, 3, width) values of a kind such as "NORMAL"; None if the file has no valid ones."""
        source, offset = self._inputs.get(semantic, (None, 0))
        if source is None:
            return None
        try:
            values: Array = self._document.numbers_of(source, width)[self._rows[:, :, offset]]
        except (MeshError, ValueError, IndexError):
            return None  # the shape does not need them
        return values


@dataclass(frozen=True)
class Instance:
    """A geometry in the scene.

    Attributes:
        names: its names and those of its nodes, the most specific first.
        surfaces: its triangles.
        matrix: (4, 4), scene from geometry.
        materials: see `material_references`.
    """

    names: Tuple[str, ...]
    surfaces: List[Surface]
    matrix: Array
    materials: Dict[Optional[str], str]


def is_mirrored(matrix: Array) -> bool:
    """Whether a (4, 4) matrix turns triangles inside out."""
    return bool(np.linalg.det(matrix[:3, :3]) < 0)


class ColladaDocument:
    """The scene and the geometries of a file. Its methods raise MeshError for invalid numbers."""

    def __init__(self, root: Any) -> None:
        self._root = root
        self._by_id: Dict[str, Any] = {one.get("id"): one for one in root.iter() if one.get("id")}
        self._surfaces: Dict[Any, List[Surface]] = {}
        self._numbers: Dict[Tuple[Any, int], Array] = {}

    def target(self, element: Any, attribute: str = "url") -> Optional[Any]:
        """The element that a reference points to; None if missing or in another file."""
        url = element.get(attribute) or ""
        return self._by_id.get(url[1:]) if url.startswith("#") else None

    def instances(self) -> Iterator[Instance]:
        """All geometries of the scene; without a scene, those of the library.

        Raises ValueError: a matrix has not 16 numbers.
        """
        reference = self._root.find("{*}scene/{*}instance_visual_scene")
        scene = self.target(reference) if reference is not None else None
        if scene is None:
            scene = self._root.find("{*}library_visual_scenes/{*}visual_scene")
        if scene is None:
            for geometry in self._root.iterfind("{*}library_geometries/{*}geometry"):
                yield Instance(_names(geometry), self.surfaces(geometry), np.eye(4), {})
            return
        waiting: List[Tuple[Any, Array, Tuple[str, ...], int]] = [
            (child, np.eye(4), (), 0) for child in scene.iterchildren(*_IN_NODES, reversed=True)]
        count = 0
        while waiting:
            element, above, names, depth = waiting.pop()
            if _local_name(element) == "instance_node":
                element = self.target(element)
            count += 1
            if count > MOST_COLLADA_NODES or depth > _DEEPEST:
                raise MeshError("its nodes form a cycle or are nested too deeply")
            if element is None:
                continue
            if _local_name(element) == "node":
                names = (*_names(element), *names)
                matrix = above @ local_matrix(placings_of(element))
                waiting += [(child, matrix, names, depth + 1)
                            for child in element.iterchildren(*_IN_NODES, reversed=True)]
            elif _local_name(element).startswith("instance_"):
                geometry, bound = self._geometry_of(element)
                if geometry is not None:
                    yield Instance((*_names(geometry), *names), self.surfaces(geometry),
                                   above @ bound, material_references(element))

    def _geometry_of(self, instance: Any) -> Tuple[Optional[Any], Array]:
        """The geometry of an instance, and where the skin that it may be in was bound."""
        matrix, source = np.eye(4), self.target(instance)
        for _ in range(3):  # a skin may refer to a morph, and that to a geometry
            inner = None if source is None else next(
                source.iterchildren("{*}skin", "{*}morph"), None)
            if inner is None:
                break
            for shape in inner.iterfind("{*}bind_shape_matrix"):
                matrix = matrix @ floats(shape).reshape(4, 4)
            source = self.target(inner, "source")
        return source, matrix

    def surfaces(self, geometry: Any) -> List[Surface]:
        """The surfaces of a `<geometry>` that have triangles; read once."""
        if geometry not in self._surfaces:
            mesh = geometry.find("{*}mesh")
            made = [] if mesh is None else map(self._surface, mesh.iterchildren(*_PRIMITIVES))
            self._surfaces[geometry] = [surface for surface in made if surface is not None]
        return self._surfaces[geometry]

    def _surface(self, primitive: Any) -> Optional[Surface]:
        inputs, width = self._inputs(primitive)
        rows = _triangulate(primitive, width)
        if not len(rows):
            return None
        if "VERTEX" not in inputs:
            raise MeshError(_NO_POSITIONS, primitive.sourceline)
        made = Surface(self, rows, inputs, primitive.get("material"))
        largest = int(made.triangles.max())
        if largest >= len(made.positions):
            raise MeshError(f"<{_local_name(primitive)}>: there is no vertex {largest}",
                            primitive.sourceline)
        return made

    def _inputs(self, primitive: Any) -> Tuple[_Inputs, int]:
        """The inputs of a primitive, and how many indices each of its corners has."""
        vertices = {one.get("id"): one for one in primitive.getparent().iterfind("{*}vertices")}
        found: _Inputs = {}
        width = 1
        for entry in primitive.iterfind("{*}input"):
            offset = int(entry.get("offset") or 0)
            width = max(width, offset + 1)
            if entry.get("semantic") != "VERTEX":
                found.setdefault(entry.get("semantic"), (self.target(entry, "source"), offset))
                continue
            owner = vertices.get((entry.get("source") or "")[1:])
            for inner in () if owner is None else owner.iterfind("{*}input"):
                kind = inner.get("semantic")
                found.setdefault("VERTEX" if kind == "POSITION" else kind,
                                 (self.target(inner, "source"), offset))
            if found.get("VERTEX", (None,))[0] is None:
                raise MeshError(_NO_POSITIONS, entry.sourceline)
        return found, width

    def numbers_of(self, source: Any, width: int) -> Array:
        """(n, width), the first numbers of each value of a `<source>`; read once."""
        if (source, width) not in self._numbers:
            self._numbers[source, width] = self._read_numbers(source, width)
        return self._numbers[source, width]

    def _read_numbers(self, source: Any, width: int) -> Array:
        accessor = source.find("{*}technique_common/{*}accessor")
        array = self.target(accessor, "source") if accessor is not None else None
        if array is None:
            array = source.find("{*}float_array")
        if accessor is None or array is None:
            raise MeshError(_NO_POSITIONS, source.sourceline)
        numbers = floats(array)
        if not np.isfinite(numbers).all():
            raise MeshError("the mesh has vertices that are not finite numbers", array.sourceline,
                            "mesh-not-finite")
        stride, offset = int(accessor.get("stride") or width), int(accessor.get("offset") or 0)
        if stride < width or offset < 0 or (len(numbers) - offset) % stride:
            raise MeshError(f"{len(numbers) - offset} numbers are not positions of {stride} each",
                            array.sourceline)
        rows: Array = numbers[offset:].reshape(-1, stride)[:, :width]
        return rows


def material_references(instance: Any) -> Dict[Optional[str], str]:
    """The URL of the `<material>` of each symbol, of an instance of a geometry."""
    return {one.get("symbol"): one.get("target", "")
            for one in instance.iter("{*}instance_material")}


def _triangulate(primitive: Any, width: int) -> Array:
    """(m, 3, width), the indices of the corners of triangles; holes of polygons are not cut."""
    kind = _local_name(primitive)
    outlines = [child if _local_name(child) == "p" else child.find("{*}p")
                for child in primitive.iterchildren("{*}p", "{*}ph")]
    lists = [_indices(one, width) for one in outlines if one is not None]
    rows = np.concatenate([np.zeros((0, width), dtype=np.int64), *lists])
    counts = np.array([len(one) for one in lists], dtype=np.int64)
    if kind == "triangles":
        counts = np.full(len(rows) // 3, 3)
    elif kind == "polylist":
        told = primitive.find("{*}vcount")
        if told is None:
            return rows[:0].reshape(0, 3, width)
        counts = _indices(told, 1)[:, 0]
    if counts.sum() != len(rows):
        raise MeshError(f"<{kind}>: the number of its indices does not fit", primitive.sourceline)
    return rows[_triangle_corners(counts, kind == "tristrips")]


def _triangle_corners(counts: Array, is_strip: bool) -> Array:
    """(m, 3), the corners of triangles of which polygons (as fans) or strips consist.

    `counts`: corners of each polygon or strip; all corners are numbered one after the other.
    """
    triangles = np.maximum(counts - 2, 0)
    first = np.repeat(np.cumsum(counts) - counts, triangles)
    step = np.arange(triangles.sum()) - np.repeat(np.cumsum(triangles) - triangles, triangles)
    odd = step % 2 if is_strip else 0  # every other triangle of a strip has the other direction
    start = first + step if is_strip else first
    made: Array = np.column_stack([start + odd, first + step + 1 - odd, first + step + 2])
    return made


def _indices(element: Any, width: int) -> Array:
    """(n, width), the indices in an element."""
    words = (element.text or "").split()
    told = f"<{_local_name(element)}>: "
    try:
        found = np.array(words, dtype=np.int64)
    except ValueError as fault:
        raise MeshError(f"{told}{fault}", element.sourceline) from None
    except OverflowError:
        raise MeshError(f"{told}there is no vertex {max(words, key=len)}",
                        element.sourceline) from None
    if len(found) and found.min() < 0:
        raise MeshError(f"{told}there is no vertex {found.min()}", element.sourceline)
    if len(found) % width:
        raise MeshError(f"{told}{len(found)} indices are not corners of {width} each",
                        element.sourceline)
    return found.reshape(-1, width)


def _names(element: Any) -> Tuple[str, ...]:
    return tuple(dict.fromkeys(filter(None, (element.get("name"), element.get("id")))))


def _local_name(element: Any) -> str:
    tag: str = element.tag if isinstance(element.tag, str) else ""
    return tag.rpartition("}")[2]
