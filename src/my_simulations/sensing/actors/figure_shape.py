"""The surface of an actor, and how its limbs carry it."""
from __future__ import annotations

from dataclasses import replace
from typing import Callable, List, Optional, Tuple

import numpy as np

from ...errors import InputError
from ...formats.mesh.figures import read_figure, read_movement
from ...formats.mesh.loading import load_mesh
from ...formats.mesh.painted import PaintedPart, painted_parts
from ...formats.mesh.part import MeshError
from ...geometry import Pose
from ..api import Figure
from ..surfaces import Piece, own_surface, piece_of
from .path import ActorPath
from .skeleton import Borrowed, Skeleton

Form = Tuple[int, float, bool]
"""Number of an animation of the actor, s in it, and whether a path brings the actor on."""


class FigureShape:
    """What an actor looks like at a time, as on the editor's page (web/js/view/actors.ts).

    Args:
        figure: the actor and its files.
        report_problem: is told of a skin that cannot be read; the actor is not seen then.
        viewers: who does not see it, for that sentence.
    """

    def __init__(self, figure: Figure, trouble: Callable[[str], None], viewers: str) -> None:
        self._skeletons: List[Skeleton] = []   # one for each animation
        self._numbers = {one.name: n for n, one in enumerate(figure.actor.animations)}
        self.pieces = self._pieces(figure, trouble, viewers) if figure.skin.uri else []
        lengths = {name: self._skeletons[n].duration for name, n in self._numbers.items()
                   if self._skeletons}
        self._path = ActorPath(figure.actor, {name: length or 0.0
                                              for name, length in lengths.items()})

    def _pieces(self, figure: Figure, trouble: Callable[[str], None], viewers: str) -> List[Piece]:
        try:
            load_mesh(figure.skin)   # within limits, and it tells faults of the file
        except InputError as fault:
            trouble(f"{viewers} do not see the actor {figure.actor.name!r}: {fault}")
            return []
        parts: List[PaintedPart] = []
        try:
            parts = self._load_skeletons(figure)
        except MeshError as fault:
            trouble(f"{viewers} see the actor {figure.actor.name!r} in one shape: {fault}")
        return [piece_of(part.vertices, part.normals, part.uv, part.triangles,
                         own_surface(part, 1.0))
                for part in parts or painted_parts(figure.skin)]

    def _load_skeletons(self, figure: Figure) -> List[PaintedPart]:
        """Load the skeletons of a figure; return its skin in the rest pose, or [] without bones.

        Raises MeshError: a bone is at infinity.
        """
        found = read_figure(figure.skin.path)
        if found is None:
            return []
        scales = [one.scale for one in figure.actor.animations] or [1.0]
        skeletons = [Skeleton(found, figure.skin.scale[0],
                              Borrowed(read_movement(path), scale) if path else None)
                     for path, scale in zip(figure.animations or ("",), scales)]
        surfaces = skeletons[0].surfaces(None)
        if not all(np.isfinite(vertices).all() for vertices, _ in surfaces):
            raise MeshError("its bones are not at finite places")
        self._skeletons = skeletons
        return [replace(one.part, vertices=vertices, normals=normals)
                for one, (vertices, normals) in zip(found.parts, surfaces)]

    def pose_at(self, time: float) -> Pose:
        """In the world, at a sim time in s."""
        return self._path.pose_at(time)

    def form_at(self, time: float) -> Optional[Form]:
        """What its shape depends on; None for the shape of the file."""
        stride = self._path.stride_at(time)
        if stride is None or not self._skeletons:
            return None
        number = self._numbers.get(stride.type, 0)
        skeleton = self._skeletons[number]
        length = skeleton.duration
        if length is None:
            return None
        at = None if stride.distance is None else skeleton.time_at(stride.distance)
        if at is None:
            at = stride.time if stride.time <= length else stride.time % length if length else 0.0
        return number, at, stride.on_path

    def rows_at(self, form: Optional[Form]) -> List[np.ndarray]:
        """Rows of `Piece`, one table of each piece."""
        rows = [piece.rows.copy() for piece in self.pieces]
        if self._skeletons:
            number, at, on_path = form or (0, None, False)
            surfaces = self._skeletons[number].surfaces(at, on_path)
            for table, (vertices, normals) in zip(rows, surfaces):
                table[:, :3], table[:, 3:6] = vertices, normals
        return rows
