"""Reduces a COLLADA file to nodes and positions, in the form that pycollada expects.

pycollada fails on a node with a missing material, reads a number up to the first letter, and NaN
as 0. Therefore everything but the shape is removed (images, effects, normals, texture coordinates,
cameras, animations), skins are replaced by their geometry, and the numbers are checked here, where
the line is known.
"""
from __future__ import annotations

import copy
import re
from typing import Any, Dict, List, Optional, Set

from .collada_encoding import without_stray_bytes
from .part import MeshError

_LIBRARIES = {"asset", "library_geometries", "library_nodes", "library_visual_scenes", "scene"}
_PLACES = {"translate", "rotate", "scale", "matrix"}
_NODE = _PLACES | {"node", "instance_geometry", "instance_node"}
_PRIMITIVES = {"triangles", "trifans", "tristrips", "polylist", "polygons"}
_NO_INDEX = re.compile(r"[^\s\d+]+")
_LARGE_INDEX = re.compile(r"0*[1-9]\d{9,}")  # of 1e9 and more
MOST_COLLADA_NODES = 100_000
_NODE_TAGS = (b"<node", b"<instance_node", b"<instance_geometry", b"<instance_controller")
_MOST_TAGS = 1_000_000  # an element takes about 200 bytes
_ANGLE_IN_VALUE = re.compile(rb'(?<==")[^"<\n]*<[^"\n]*(?=")')
"""An attribute value with `<`: not allowed in XML, accepted by TinyXML; `name="<STL_BINARY>"`."""
_NAMESPACE = "http://www.collada.org/2005/11/COLLADASchema"


def parse_collada_geometry(data: bytes) -> Any:
    """Parse a file and reduce its `<COLLADA>` element to the geometry of its scene.

    Elements keep the line numbers of the file. Raises MeshError: not COLLADA, or invalid numbers.
    """
    root = parse_collada(data)
    document = _Document(root)
    document.replace_controllers()
    for child in list(root):
        if _local(child) not in _LIBRARIES:
            root.remove(child)
    document.find_ids()  # removed elements are no longer targets
    document.tidy_nodes()
    document.share_nodes()
    document.tidy_geometries()
    return root


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
            element.tag = f"{{{_NAMESPACE}}}{_local(element)}"
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


class _Document:
    def __init__(self, root: Any) -> None:
        self._root = root
        self._by_id: Dict[str, Any] = {}
        self._used: List[Any] = []
        self.find_ids()

    def find_ids(self) -> None:
        """Know the elements that references may point to."""
        self._by_id = {e.get("id"): e for e in self._root.iter() if e.get("id")}

    def replace_controllers(self) -> None:
        """Replace instances of skins and morphs by their geometry, in its bind shape."""
        for instance in list(self._root.iter("{*}instance_controller")):
            matrices, source = [], self._target(instance)
            for _ in range(3):  # a skin may refer to a morph, and that to a geometry
                inner = _first(source, "skin", "morph") if source is not None else None
                if inner is None:
                    break
                matrices += inner.findall("{*}bind_shape_matrix")
                source = self._target(inner, "source")
            node = _make_element(instance, "node")
            for shape in matrices:
                matrix = _make_element(instance, "matrix")
                matrix.text, matrix.sourceline = shape.text, shape.sourceline
                node.append(matrix)
            geometry = _make_element(instance, "instance_geometry")
            geometry.set("url", "#" + (source.get("id") or "" if source is not None else ""))
            node.append(geometry)
            instance.getparent().replace(instance, node)

    def tidy_nodes(self) -> None:
        """Reduce each node to its transforms and the instances whose targets exist."""
        scene = self._root.find("{*}scene/{*}instance_visual_scene")
        if scene is not None and self._target(scene) is None:
            scene.getparent().remove(scene)
        for node in list(self._root.iter("{*}node")):
            for child in list(node):
                kind = _local(child)
                if kind in _PLACES:
                    _check_numbers(child)
                elif kind == "instance_geometry":
                    child[:] = []
                if kind not in _NODE or not self._is_there(child, kind):
                    node.remove(child)

    def _is_there(self, instance: Any, kind: str) -> bool:
        if not kind.startswith("instance_"):
            return True
        target = self._target(instance)
        if kind == "instance_node":
            return target is not None and _local(target) == "node"
        if target is None or target.find("{*}mesh") is None:
            return False
        self._used.append(target)
        return True

    def share_nodes(self) -> None:
        """Copy nodes that are instantiated several times to where pycollada searches for them."""
        self.find_ids()  # of two nodes with one name, the one may have been removed
        library = _make_element(self._root, "library_nodes")
        wanted: Set[str] = set()
        for instance in list(self._root.iter("{*}instance_node")):
            if self._is_there(instance, "instance_node"):
                wanted.add(instance.get("url")[1:])
            else:  # one outside of a node, which nothing has looked at
                instance.getparent().remove(instance)
        for name in sorted(wanted):
            if _local(self._by_id[name].getparent()) != "library_nodes":
                library.append(copy.deepcopy(self._by_id[name]))
        if len(library):
            self._root.append(library)

    def tidy_geometries(self) -> None:
        """Reduce each used geometry to positions and faces; remove the others."""
        used = {id(geometry) for geometry in self._used}
        placed = next(self._root.iter("{*}visual_scene"), None) is not None
        for geometry in list(self._root.iterfind("{*}library_geometries/{*}geometry")):
            mesh = geometry.find("{*}mesh")
            if mesh is None or (placed and id(geometry) not in used):
                geometry.getparent().remove(geometry)
                continue
            geometry[:] = [mesh]
            self._tidy_mesh(mesh)

    def _tidy_mesh(self, mesh: Any) -> None:
        positions: Dict[str, Any] = {}  # the source of positions, by the id of its <vertices>
        for vertices in mesh.iterfind("{*}vertices"):
            vertices[:] = [i for i in vertices if i.get("semantic") == "POSITION"][:1]
            for entry in vertices:
                positions[vertices.get("id")] = self._positions(entry)
        for child in list(mesh):
            if _local(child) == "source":
                keep = any(child is source for source in positions.values())
            elif _local(child) in _PRIMITIVES:
                keep = _tidy_primitive(child, positions)
            else:
                keep = _local(child) == "vertices"
            if not keep:
                mesh.remove(child)

    def _positions(self, entry: Any) -> Any:
        """Return the `<source>` of an input, after its array was rearranged as x y z numbers.

        Raises MeshError: it is missing.
        """
        source = self._target(entry, "source")
        accessor = source.find("{*}technique_common/{*}accessor") if source is not None else None
        array = self._target(accessor, "source") if accessor is not None else None
        if array is None and source is not None:
            array = source.find("{*}float_array")
        if source is None or accessor is None or array is None:
            raise MeshError("the positions of its vertices are missing", entry.sourceline)
        _set_xyz(array, accessor)
        if array.getparent() is not source:
            source.append(copy.deepcopy(array))
        return source

    def _target(self, instance: Any, attribute: str = "url") -> Optional[Any]:
        """The element that a reference points to; None if missing or in another file."""
        url = instance.get(attribute) or ""
        return self._by_id.get(url[1:]) if url.startswith("#") else None


def _set_xyz(array: Any, accessor: Any) -> None:
    """Check the numbers of an array and rearrange it as x y z, x y z, with its accessor."""
    numbers = _check_numbers(array, finite=True)
    stride, offset = int(accessor.get("stride") or 3), int(accessor.get("offset") or 0)
    if stride < 3 or (len(numbers) - offset) % stride:
        raise MeshError(f"{len(numbers) - offset} numbers are not positions of {stride} each",
                        array.sourceline)
    if stride > 3 or offset:
        rows = numbers[offset:].reshape(-1, stride)[:, :3]
        array.text = " ".join(map(repr, rows.ravel().tolist()))
        accessor.set("stride", "3")
        accessor.attrib.pop("offset", None)
    accessor[:] = [_make_element(accessor, "param", name=axis, type="float") for axis in "XYZ"]


def _tidy_primitive(primitive: Any, positions: Dict[str, Any]) -> bool:
    """Check the indices of a primitive; False if it has no faces."""
    for holed in list(primitive.iterfind("{*}ph")):  # holes are not cut
        outline = holed.find("{*}p")
        if outline is None:
            primitive.remove(holed)
        else:
            primitive.replace(holed, outline)
    lists = primitive.findall("{*}p") + primitive.findall("{*}vcount")
    for element in lists:
        bad = _NO_INDEX.search(element.text or "")
        if bad:
            raise MeshError(f"<{_local(element)}>: {bad.group()!r} is not part of an index",
                            element.sourceline)
        large = _LARGE_INDEX.search(element.text or "")
        if large:  # pycollada reads it as negative
            raise MeshError(f"<{_local(element)}>: there is no vertex {large.group()}",
                            element.sourceline)
    for entry in primitive.iterfind("{*}input"):
        entry.set("offset", entry.get("offset") or "0")
        source = positions.get((entry.get("source") or "")[1:])
        if entry.get("semantic") != "VERTEX":
            # Only its offset is used; its values may be missing.
            other = next(iter(positions.values()), None)
            if other is not None:
                entry.set("semantic", "COLOR")
                entry.set("source", "#" + other.get("id"))
        elif source is None:
            raise MeshError("the positions of its vertices are missing", entry.sourceline)
    counted = _local(primitive) != "polylist" or primitive.find("{*}vcount") is not None
    return counted and any((p.text or "").strip() for p in primitive.iterfind("{*}p"))


def _check_numbers(element: Any, finite: bool = False) -> Any:
    import numpy as np

    try:
        numbers = np.array((element.text or "").split(), dtype=np.float64)
    except ValueError as fault:
        raise MeshError(f"<{_local(element)}>: {fault}", element.sourceline) from None
    if finite and not np.isfinite(numbers).all():
        raise MeshError("the mesh has vertices that are not finite numbers", element.sourceline,
                        "mesh-not-finite")
    return numbers


def _first(element: Any, *kinds: str) -> Optional[Any]:
    return next((child for child in element if _local(child) in kinds), None)


def _make_element(like: Any, kind: str, **attributes: str) -> Any:
    """A new element in the namespace of `like`."""
    from lxml import etree

    return etree.Element(f"{{{etree.QName(like).namespace}}}{kind}", attributes)


def _local(element: Any) -> str:
    tag: str = element.tag if isinstance(element.tag, str) else ""
    return tag.rpartition("}")[2]
