"""Figures of COLLADA files: surfaces, the nodes that carry them, and how these move.

A skin's vertex follows up to four nodes (bones); other surfaces follow the node that they hang on.
`up_axis` is not applied (Gazebo behaviour).
"""
from __future__ import annotations

import os
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, Dict, Iterator, List, Optional, Tuple

import numpy as np

from .bvh import read_bvh
from .collada import ColladaDocument, material_references, parse_collada, unit_of
from .collada_materials import ColladaMaterials
from .keyframes import Clip, clip_of
from .node_tree import Array, Bones, NodeTree, floats
from .painted import PaintedPart, corners_of, merge_corners
from .part import MOST_TRIANGLES, MeshError

_MOST_BONES = 4
"""Bones of a vertex; the editor's page uses as many."""
_LARGEST = 64 << 20
"""Bytes of a file with bones: no other limit applies to reading an animation."""


@dataclass(frozen=True)
class Skin:
    """How bones carry vertices.

    Attributes:
        nodes: (b,) the node of each bone.
        inverses: (b, 4, 4) bone from skin where the skin was bound.
        index: (n, 4) bones of each vertex.
        weights: (n, 4), their sum is 1.
    """

    nodes: Array
    inverses: Array
    index: Array
    weights: Array


@dataclass(frozen=True)
class FigurePart:
    """Triangles of one material, in the file's unit.

    Attributes:
        part: in the frame of `node`, or where the skin was bound.
        node: that carries it all, without a skin.
        skin: None for what is rigid.
    """

    part: PaintedPart
    node: int
    skin: Optional[Skin] = None


@dataclass(frozen=True)
class FigureFile:
    """A file as it is: `unit` in m, `clip` None where nothing moves."""

    tree: NodeTree
    parts: List[FigurePart]
    clip: Optional[Clip]
    unit: float


@dataclass(frozen=True)
class Movement:
    """The animation of a file: its bones, their keyframes, and the file's unit in m."""

    tree: Bones
    clip: Clip
    unit: float


def read_figure(path: str) -> Optional[FigureFile]:
    """The figure in a COLLADA file; None for other files, or one without surfaces.

    For files that `load_mesh` has read before, which reports faults of their shape. Raises
    MeshError: a fault of a skin or an animation.
    """
    return _figure(path, _read_change_stamp(path)) if _is_collada(path) else None


def read_movement(path: str) -> Optional[Movement]:
    """The animation of a COLLADA or BVH file; None where there is none.

    Raises MeshError: it cannot be read.
    """
    known = _is_collada(path) or _is_bvh(path)
    return _moves(path, _read_change_stamp(path)) if known else None


def _is_collada(path: str) -> bool:
    return path.lower().endswith(".dae")


def _is_bvh(path: str) -> bool:
    return path.lower().endswith(".bvh")


def _read_change_stamp(path: str) -> Tuple[int, int]:
    try:
        status = os.stat(path)
    except OSError as fault:
        raise MeshError(f"cannot be read: {fault.strerror}") from None
    if status.st_size > _LARGEST:
        raise MeshError(f"it is larger than {_LARGEST >> 20} MB")
    return status.st_mtime_ns, status.st_size


@lru_cache(maxsize=8)
def _figure(path: str, _changed_at: Tuple[int, int]) -> Optional[FigureFile]:
    """Kept, as a crowd wears a few skins."""
    root = _root_of(path)
    with _as_input_error():
        found = _Reader(root, os.path.dirname(path)).figure()
    if found is not None:
        found.tree.release_xml()
    return found


@lru_cache(maxsize=8)
def _moves(path: str, _changed_at: Tuple[int, int]) -> Optional[Movement]:
    if _is_bvh(path):
        return Movement(*read_bvh(_bytes_of(path)), 1.0)
    root = _root_of(path)
    with _as_input_error():
        tree = NodeTree(root)
        clip = clip_of(root, tree)
        unit = unit_of(root)
    tree.release_xml()
    return None if clip is None else Movement(tree, clip, unit)


def _root_of(path: str) -> Any:
    return parse_collada(_bytes_of(path))


def _bytes_of(path: str) -> bytes:
    try:
        with open(path, "rb") as stream:
            return stream.read()
    except OSError as fault:
        raise MeshError(f"cannot be read: {fault.strerror}") from None


@contextmanager
def _as_input_error() -> Iterator[None]:
    """Faults of the file, which is not checked before it is read, as what they are."""
    try:
        yield
    except MeshError:
        raise
    except Exception as fault:  # of any library that reads it
        raise MeshError("its skin or animation cannot be read: "
                        f"{type(fault).__name__}: {fault}") from None


class _Reader:
    def __init__(self, root: Any, folder: str) -> None:
        self._root, self._folder = root, folder
        self._tree = NodeTree(root)
        self._clip = clip_of(root, self._tree)
        self._document, self._materials = ColladaDocument(root), ColladaMaterials(root)
        self._found: List[FigurePart] = []
        self._triangles = 0

    def figure(self) -> Optional[FigureFile]:
        for node, element in enumerate(self._tree.elements):
            for instance in element.iterchildren("{*}instance_geometry", "{*}instance_controller"):
                if instance.tag.endswith("geometry"):
                    self._add(instance.get("url"), node, instance, None)
                else:
                    self._add_skin(node, instance)
        if not self._found:
            return None
        return FigureFile(self._tree, self._found, self._clip, unit_of(self._root))

    def _add_skin(self, node: int, instance: Any) -> None:
        controller = self._tree.by_id[instance.get("url")[1:]]
        element = controller.find("{*}skin")
        if element is None:
            raise MeshError("it has a controller that is not a skin", instance.sourceline)
        roots = [self._tree.numbers[one.text.strip()[1:]]
                 for one in instance.iterchildren("{*}skeleton")
                 if (one.text or "").strip()[1:] in self._tree.numbers]
        self._add(element.get("source"), node, instance, _Binding(element, self._tree, roots))

    def _add(self, url: str, node: int, instance: Any, binding: "Optional[_Binding]") -> None:
        geometry = self._tree.by_id.get(url[1:])
        if geometry is None:
            return
        materials = material_references(instance)
        for surface in self._document.surfaces(geometry):
            index = surface.triangles.reshape(-1)
            self._triangles += len(index) // 3
            if self._triangles > MOST_TRIANGLES:
                raise MeshError("it has too many triangles")
            paint = self._materials.paint_of(materials.get(surface.material, ""), self._folder)
            part, first = merge_corners(*corners_of(surface, np.eye(4)), paint,
                                        None if binding is None else index)
            skin = None if binding is None else binding.of(index[first])
            if binding is not None:
                part = binding.bound(part)
            self._found.append(FigurePart(part, node, skin))


class _Binding:
    """A `<skin>`: bones, and their weights for each vertex of the geometry."""

    def __init__(self, skin: Any, tree: NodeTree, roots: List[int]) -> None:
        shape = skin.find("{*}bind_shape_matrix")
        self._shape = np.eye(4) if shape is None else floats(shape).reshape(4, 4)
        sources = {one.get("id"): one for one in skin.iterchildren("{*}source")}
        joints = _inputs(skin.find("{*}joints"))
        names = next(words for words in map(
            sources[joints["JOINT"][0]].find, ("{*}Name_array", "{*}IDREF_array"))
            if words is not None)
        self._nodes = np.array([tree.bone(name, roots)
                                for name in "".join(names.itertext()).split()],
                               dtype=np.int64)
        self._inverses = floats(sources[joints["INV_BIND_MATRIX"][0]].find("{*}float_array")
                                ).reshape(-1, 4, 4)
        if len(self._inverses) != len(self._nodes):
            raise MeshError("a skin has not a matrix for each joint", skin.sourceline)
        influences = skin.find("{*}vertex_weights")
        self._table = _strongest(influences, floats(sources[
            _inputs(influences)["WEIGHT"][0]].find("{*}float_array")), len(self._nodes))

    def of(self, vertices: Array) -> Skin:
        """Return the skin of some vertices of the geometry."""
        index, weights = self._table
        return Skin(self._nodes, self._inverses, index[vertices], weights[vertices])

    def bound(self, part: PaintedPart) -> PaintedPart:
        """A part where the skin was bound."""
        turn = self._shape[:3, :3]
        return replace(part, vertices=part.vertices @ turn.T + self._shape[:3, 3],
                       normals=part.normals @ turn.T)


def _inputs(element: Any) -> Dict[str, Tuple[str, int]]:
    """Source and offset of each `<input>` by what it means."""
    return {one.get("semantic"): (one.get("source")[1:], int(one.get("offset") or 0))
            for one in element.iterchildren("{*}input")}


def _strongest(influences: Any, weights: Array, bones: int) -> Tuple[Array, Array]:
    """Bones (n, 4) and weights (n, 4) of each vertex, the strongest ones, their sum 1."""
    inputs = _inputs(influences)
    counts = floats(influences.find("{*}vcount")).astype(np.int64)
    width = max(offset for _, offset in inputs.values()) + 1
    pairs = floats(influences.find("{*}v")).astype(np.int64).reshape(-1, width)
    bone, weight = pairs[:, inputs["JOINT"][1]], weights[pairs[:, inputs["WEIGHT"][1]]]
    if counts.sum() != len(pairs) or (len(bone) and not 0 <= bone.min() <= bone.max() < bones):
        raise MeshError("the weights of a skin do not fit its joints", influences.sourceline)
    vertex = np.repeat(np.arange(len(counts)), counts)
    order = np.lexsort((-weight, vertex))   # stable: of equal ones the first come first
    vertex, bone, weight = vertex[order], bone[order], weight[order]
    rank = np.arange(len(vertex)) - np.repeat(np.cumsum(counts) - counts, counts)
    kept = rank < _MOST_BONES
    index = np.zeros((len(counts), _MOST_BONES), dtype=np.int64)
    parts = np.zeros((len(counts), _MOST_BONES))
    index[vertex[kept], rank[kept]], parts[vertex[kept], rank[kept]] = bone[kept], weight[kept]
    total = parts.sum(axis=1, keepdims=True)
    parts[total[:, 0] == 0.0, 0] = 1.0   # nothing holds it: its first bone does
    return index, parts / np.where(total == 0.0, 1.0, total)
