"""Where the surfaces of a figure are, in its own frame, as its bones carry them."""
from __future__ import annotations

from typing import Dict, List, Optional, Tuple

import numpy as np

from ...formats.mesh.figures import FigureFile, FigurePart
from ...formats.mesh.keyframes import Clip, composed, decomposed
from ...formats.mesh.node_tree import NodeTree

Surface = Tuple[np.ndarray, np.ndarray]
"""Vertices (n, 3), m, and normals (n, 3)."""


class Skeleton:
    """The bones of a figure and what they carry.

    Args:
        figure: of the file.
        scale: of the actor's skin.
        clip: the movement of another file and its nodes, which gives how bones of the same name
            turn; None for the figure's own.
        borrows: whether it is to move by another file alone.
        on_path: whether a path says how far the figure has come; then its root does not go along x
            (Gazebo behaviour).
    """

    def __init__(self, figure: FigureFile, scale: float,
                 clip: Optional[Tuple[NodeTree, Clip]] = None, borrows: bool = False,
                 on_path: bool = False) -> None:
        self._figure, self._factor = figure, scale * figure.unit
        self._rest = decomposed(figure.tree.rest)
        self._moves: List[Tuple[int, np.ndarray, np.ndarray]] = []   # keys, their columns, nodes
        self._root = figure.tree.root_joint if on_path else None
        if not borrows:
            self._clip = figure.clip
            self._borrowed = None
        else:
            self._clip = None if clip is None else clip[1]
            self._borrowed = None if clip is None else _shared(clip[0], figure.tree)
            if self._clip is not None and not any(
                    keys.turned[n] and int(node) in (self._borrowed or {})
                    for keys in self._clip.keys for n, node in enumerate(keys.nodes)):
                self._clip = None

    @property
    def duration(self) -> Optional[float]:
        """Of its movement, s; None where it has none."""
        return None if self._clip is None else self._clip.duration

    def surfaces(self, at: Optional[float]) -> List[Surface]:
        """One for each part of the figure, `at` s in its movement, or as the file has it."""
        world = self._world(at)
        return [_skinned(part, world, self._factor) for part in self._figure.parts]

    def _world(self, at: Optional[float]) -> np.ndarray:
        """(n, 4, 4) figure from node, in the file's unit."""
        places, turns, scales = (one.copy() for one in self._rest)
        if at is not None and self._clip is not None:
            for keys in self._clip.keys:
                now = keys.at(at)
                if self._borrowed is None:
                    places[keys.nodes], turns[keys.nodes], scales[keys.nodes] = now
                    continue
                for n, node in enumerate(keys.nodes):
                    own = self._borrowed.get(int(node))
                    if own is not None and keys.turned[n]:
                        turns[own] = now[1][n]
            if self._root is not None:
                places[self._root, 0] = 0.0
        world = composed(places, turns, scales)
        for n, parent in enumerate(self._figure.tree.parents):
            if parent >= 0:
                world[n] = world[parent] @ world[n]
        return world


def _shared(theirs: NodeTree, ours: NodeTree) -> Dict[int, int]:
    """Number of our node by that of theirs of the same name."""
    numbers: Dict[str, int] = {}
    for n, name in enumerate(ours.names):
        numbers.setdefault(name, n)
    return {n: numbers[name] for n, name in enumerate(theirs.names) if name and name in numbers}


def _skinned(part: FigurePart, world: np.ndarray, factor: float) -> Surface:
    """Linear blend skinning."""
    shape, skin = part.part, part.skin
    if skin is None:
        frame = world[part.node]
        turned = shape.normals @ frame[:3, :3].T
        return (shape.vertices @ frame[:3, :3].T + frame[:3, 3]) * factor, _unit(turned)
    bones = (world[skin.nodes] @ skin.inverses)[:, :3].reshape(-1, 12)
    blended = np.take(bones, skin.index[:, 0], axis=0) * skin.weights[:, :1]
    for n in range(1, skin.index.shape[1]):
        held = np.flatnonzero(skin.weights[:, n])   # most vertices have a bone or two
        blended[held] += np.take(bones, skin.index[held, n], axis=0) * skin.weights[held, n, None]
    frames = blended.reshape(-1, 3, 4)
    vertices = np.einsum("nij,nj->ni", frames[:, :, :3], shape.vertices) + frames[:, :, 3]
    return vertices * factor, _unit(np.einsum("nij,nj->ni", frames[:, :, :3], shape.normals))


def _unit(rows: np.ndarray) -> np.ndarray:
    length = np.linalg.norm(rows, axis=1, keepdims=True)
    unit: np.ndarray = rows / np.where(length > 0.0, length, 1.0)
    return unit
