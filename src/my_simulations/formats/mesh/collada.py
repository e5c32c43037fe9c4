"""Reads COLLADA with pycollada: the triangles of all instances in the visual scene.

The file's unit is applied to all lengths, including translations of nodes. `up_axis` is not
applied (Gazebo behaviour).
"""
from __future__ import annotations

import io
import math
from typing import Any, Iterator, List, Tuple

from .collada_cleanup import MOST_COLLADA_NODES, parse_collada_geometry
from .part import MeshError, MeshPart, check_triangle_count

_DEEPEST = 100


def read_collada(data: bytes) -> List[MeshPart]:
    """The parts of a .dae file. Raises MeshError: not COLLADA, or inconsistent numbers."""
    import numpy as np
    from lxml import etree

    root = parse_collada_geometry(data)
    try:
        document = _load_collada(etree.tostring(root))
        unit = unit_of(root)
        with np.errstate(all="ignore"):  # non-finite numbers are reported later
            made = (_part(names, geometry, unit) for names, geometry in bound_geometries(document))
            return check_triangle_count(part for part in made if part is not None)
    except RecursionError:
        raise MeshError("its nodes form a cycle or are nested too deeply") from None
    except (LookupError, TypeError, ValueError, OverflowError, AttributeError) as fault:
        # pycollada fails in many ways on elements that it expects and does not check.
        raise MeshError(str(fault), _line_of_fault(root)) from None


def _load_collada(text: bytes) -> Any:
    import collada

    try:
        return collada.Collada(io.BytesIO(text))
    except collada.DaeError as fault:
        raise ValueError(fault.msg) from None
    except RecursionError:
        raise
    except RuntimeError:  # pycollada has a bare `raise` outside of a handler
        raise ValueError("an element stands where COLLADA has no such element") from None


def _line_of_fault(root: Any) -> int:
    """Line of the geometry that pycollada cannot read; 0 if all are readable."""
    import collada
    from collada.common import tagger
    from lxml import etree

    document = collada.Collada()
    document.tag = tagger(etree.QName(root).namespace)
    for geometry in root.iterfind("{*}library_geometries/{*}geometry"):
        try:
            collada.geometry.Geometry.load(document, {}, geometry)
        except (collada.DaeError, LookupError, TypeError, ValueError, AttributeError):
            line: int = geometry.sourceline
            return line
    return 0


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


def bound_geometries(document: Any) -> Iterator[Tuple[Tuple[str, ...], Any]]:
    """Yield the names and the bound geometry of every instance in the scene."""
    import numpy as np
    from collada.scene import ControllerNode, GeometryNode

    scene = document.scene or (document.scenes[0] if len(document.scenes) else None)
    if scene is None:
        for geometry in document.geometries:
            yield _names(geometry), geometry.bind(np.eye(4), {})
        return
    # Not scene.objects("geometry"), which does not give the names of the nodes.
    waiting: List[Tuple[Any, Any, Tuple[str, ...], int]] = [
        (node, np.eye(4), (), 0) for node in reversed(scene.nodes)]
    count = 0
    while waiting:
        node, above, names, depth = waiting.pop()
        count += 1
        if count > MOST_COLLADA_NODES or depth > _DEEPEST:
            raise MeshError("its nodes form a cycle or are nested too deeply")
        if isinstance(node, GeometryNode):
            for bound in node.objects("geometry", above):
                yield (*_names(bound.original), *names), bound
        elif isinstance(node, ControllerNode):  # a skin, in the shape in which it was bound
            for bound in node.objects("controller", above):
                yield (*_names(bound.geometry.original), *names), bound.geometry
        elif hasattr(node, "children"):  # not a camera, a light or an <extra>
            names = (*_names(getattr(node, "node", node)), *names)
            matrix = above @ node.matrix
            waiting += [(c, matrix, names, depth + 1) for c in reversed(node.children)]


def _names(element: Any) -> Tuple[str, ...]:
    return tuple(dict.fromkeys(name for name in (element.name, element.id) if name))


def _part(names: Tuple[str, ...], geometry: Any, unit: float) -> Any:
    import numpy as np

    vertices: List[Any] = []
    triangles: List[Any] = []
    first = 0
    for primitive in geometry.primitives():
        if not len(primitive) or primitive.vertex is None:
            continue
        faces = _triangles(primitive)
        vertices.append(primitive.vertex)
        triangles.append(faces.astype(np.int64) + first)
        first += len(primitive.vertex)
    if not triangles:
        return None
    joined = np.concatenate(triangles)
    if np.linalg.det(geometry.matrix[:3, :3]) < 0:
        joined = joined[:, ::-1]  # mirrored: reverse the winding
    return MeshPart(names, np.concatenate(vertices).astype(np.float64) * unit, joined)


def _triangles(primitive: Any) -> Any:
    from collada.polylist import BoundPolylist

    if not isinstance(primitive, BoundPolylist):
        return primitive.vertex_index
    if primitive.nvertices != len(primitive.index):  # pycollada does not check it
        raise ValueError("<vcount> and <p> do not fit each other")
    return primitive.triangleset().vertex_index
