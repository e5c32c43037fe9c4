"""Where the surfaces of a figure are, in its own frame, as its bones carry them."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, List, Optional, Tuple

import numpy as np

from ...formats.mesh.figures import FigureFile, FigurePart, Movement
from ...formats.mesh.keyframes import Clip, compose_matrices, decompose_matrices

Surface = Tuple[np.ndarray, np.ndarray]
"""Vertices (n, 3), m, and normals (n, 3)."""
_Columns = Tuple[Any, np.ndarray]
"""Of the nodes of some keys: which move the figure, and the figure's nodes that they move."""
_Way = Tuple[np.ndarray, np.ndarray]
"""Of the root: times of keys, s, and how far along x it is then, m."""


@dataclass(frozen=True)
class Borrowed:
    """The movement of another file, None where it has none, and the `scale` of its lengths.

    It places and turns the bones, as long as they are there (Gazebo behaviour).
    """

    movement: Optional[Movement]
    scale: float = 1.0


class Skeleton:
    """The bones of a figure and what they carry.

    Args:
        figure: of the file.
        scale: of the actor's skin.
        borrowed: how it moves by another file; None for the figure's own movement.
    """

    def __init__(self, figure: FigureFile, scale: float,
                 borrowed: "Optional[Borrowed]" = None) -> None:
        self._figure, self._factor = figure, scale * figure.unit
        self._rest = decompose_matrices(figure.tree.rest)
        self._root = figure.tree.root_joint
        self._clip: Optional[Clip] = None
        self._columns: List[_Columns] = []
        self._ratio, self._own = 1.0, borrowed is None
        if borrowed is None and figure.clip is not None:
            self._clip = figure.clip
            self._columns = [(slice(None), keys.nodes) for keys in figure.clip.keys]
        elif borrowed is not None and borrowed.movement is not None:
            self._borrow(borrowed.movement, borrowed.scale)
        self._way = self._root_keys()

    def _borrow(self, movement: Movement, scale: float) -> None:
        ours = self._figure.tree.match_bones(movement.tree)
        for keys in movement.clip.keys:
            known = np.array([int(node) in ours for node in keys.nodes], dtype=bool)
            nodes = np.array([ours[int(node)] for node in keys.nodes[known]], dtype=np.int64)
            self._columns.append((known, nodes))
        if any(len(nodes) for _, nodes in self._columns):
            self._clip = movement.clip
        self._ratio = movement.unit * scale / (self._factor or 1.0)

    def _root_keys(self) -> Optional[_Way]:
        for keys, (columns, nodes) in zip(self._clip.keys if self._clip else (), self._columns):
            [found] = np.nonzero(nodes == self._root)
            if len(found):
                return keys.times, (keys.places[:, columns][:, found[0], 0]
                                    * self._ratio * self._factor)
        return None

    def time_at(self, distance: float) -> Optional[float]:
        """The time, s, at which its root has gone that far along x, m; the movement repeats.

        Gazebo's rule. None if the movement does not advance.
        """
        if self._way is None or self._way[1][-1] <= 0.0:
            return None
        times, places = self._way
        last = float(places[-1])
        gone = max(distance, float(places[0]))
        gone = gone if gone <= last else gone % last or last
        after = int(np.argmax(places >= gone))
        if not after:
            return float(times[0])
        start, goal = float(places[after - 1]), float(places[after])
        return float(times[after - 1]
                     + (times[after] - times[after - 1]) * (gone - start) / (goal - start))

    @property
    def duration(self) -> Optional[float]:
        """Of its movement, s; None where it has none."""
        return None if self._clip is None else self._clip.duration

    def surfaces(self, at: Optional[float], on_path: bool = False) -> List[Surface]:
        """One for each part of the figure, `at` s in its movement, or as the file has it.

        `on_path`: whether a path says how far the figure has come; then its root does not go along
        x (Gazebo behaviour).
        """
        world = self._world(at, on_path)
        return [_skin_surface(part, world, self._factor) for part in self._figure.parts]

    def _world(self, at: Optional[float], on_path: bool) -> np.ndarray:
        """(n, 4, 4) figure from node, in the file's unit."""
        places, turns, scales = (one.copy() for one in self._rest)
        if at is not None and self._clip is not None:
            for keys, (columns, nodes) in zip(self._clip.keys, self._columns):
                moved = keys.at(at)
                places[nodes] = moved[0][columns] * self._ratio
                turns[nodes] = moved[1][columns]
                if self._own:
                    scales[nodes] = moved[2][columns]
            if on_path and self._root is not None:
                places[self._root, 0] = 0.0
        world = compose_matrices(places, turns, scales)
        for n, parent in enumerate(self._figure.tree.parents):
            if parent >= 0:
                world[n] = world[parent] @ world[n]
        return world


def _skin_surface(part: FigurePart, world: np.ndarray, factor: float) -> Surface:
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
