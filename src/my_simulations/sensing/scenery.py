"""Roads and actors, which belong to no model: surfaces at places of their own.

The n-th of them is at the row -1 - n of a table of poses: `append_poses` puts theirs behind those
of the links, so that code that places links places them, too.

Roads as triangles: the strip of the editor's page (web/js/view/road_strip.ts).

A test compares both with test/data/road_strips.json.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import Callable, List, Optional, Tuple

import numpy as np

from ..description.shapes import MeshData
from ..description.surroundings import Road
from ..formats.mesh.painted import PaintedPart, shade_smooth
from ..geometry import Pose
from .actors.figure_shape import FigureShape, Form
from .api import PaintedRoad, SetScenery
from .surfaces import Piece, piece_of, surface_of

NO_SCENERY = SetScenery()


def _untold(text: str) -> None:
    """Discard a message."""


@dataclass(frozen=True)
class ScenicPart:
    """Triangles of one surface; `row`: where its place is in an extended table."""

    piece: Piece
    row: int
    casts_shadow: bool


class Scenery:
    """What there is, for one viewer.

    Args:
        scenery: roads and actors.
        report_problem: is told of skins that cannot be read.
        viewers: who does not see them, for that sentence.
    """

    def __init__(self, scenery: SetScenery = NO_SCENERY,
                 trouble: Callable[[str], None] = _untold, viewers: str = "cameras") -> None:
        self.told = scenery
        self.parts: List[ScenicPart] = []
        self._figures: List[Tuple[FigureShape, int]] = []   # with the number of its first part
        self._forms: List[Optional[Form]] = []
        fixed = [self._add_road(road, -1 - n) for n, road in enumerate(scenery.roads)]
        for figure in scenery.figures:
            shape = FigureShape(figure, trouble, viewers)
            row = -1 - len(fixed) - len(self._figures)
            self._figures.append((shape, len(self.parts)))
            self._forms.append(None)
            self.parts += [ScenicPart(piece, row, True) for piece in shape.pieces]
        self._fixed = np.array([[*pose.position, *pose.orientation] for pose in reversed(fixed)]
                               ).reshape(-1, 7)

    def _add_road(self, road: PaintedRoad, row: int) -> Pose:
        made = road_strip(road.road)
        at = Pose(road.road.points[0]) if made is not None else Pose()
        if made is not None:
            piece = piece_of(made.vertices - np.array(at.position), made.normals, made.uv,
                             made.triangles, surface_of(road.look, 1.0))
            self.parts.append(ScenicPart(piece, row, False))
        return at

    @property
    def count(self) -> int:
        """Number of rows, which follow those of the links: fixed visuals and actors."""
        return len(self._fixed) + len(self._figures)

    def append_poses(self, poses: np.ndarray, ns: int) -> np.ndarray:
        """Append the poses of fixed visuals and actors at a sim time (ns) to (n, 7) link poses."""
        if not self.count:
            return poses
        places = [[*pose.position, *pose.orientation]
                  for pose in (shape.pose_at(ns / 1e9) for shape, _ in reversed(self._figures))]
        return np.concatenate([poses, np.array(places).reshape(-1, 7), self._fixed])

    def forms(self, ns: int) -> bytes:
        """Return a key of the actors' shapes; equal keys mean equal shapes."""
        if not self._figures:
            return b""
        return repr([shape.form_at(ns / 1e9) for shape, _ in self._figures]).encode()

    def take_reshaped_parts(self, ns: int) -> List[Tuple[int, np.ndarray]]:
        """Return the parts whose shape changed since the last call, with their rows of `Piece`."""
        found: List[Tuple[int, np.ndarray]] = []
        for n, (shape, first) in enumerate(self._figures):
            form = shape.form_at(ns / 1e9)
            if form != self._forms[n]:
                self._forms[n] = form
                found += enumerate(shape.rows_at(form), first)
        return found


LIFT = 0.01
"""m by which a road lies above its points, so that a ground at their height does not hide it."""


def road_strip(road: Road) -> Optional[PaintedPart]:
    """Return the flat strip of a road in the world frame; None without length or width.

    Its sides run half the width to the left and to the right of the points, level, at right angles
    to the line from the point before to the next. Texture coordinates: u is 0 on the left and 1 on
    the right, v grows by 1 in each width of the way, measured level.
    """
    points = np.array(road.points, dtype=np.float64).reshape(-1, 3)
    if len(points) < 2 or not road.width > 0.0 or not np.isfinite(points).all():
        return None
    before, after = points[np.r_[0, 0:len(points) - 1]], points[np.r_[1:len(points), -1]]
    ahead = (after - before)[:, :2]
    length = np.hypot(ahead[:, 0], ahead[:, 1])
    ahead /= np.where(length > 0.0, length, 1.0)[:, None]
    half = np.column_stack([-ahead[:, 1], ahead[:, 0]]) * (road.width / 2)
    corners = np.repeat(points, 2, axis=0)
    corners[0::2, :2] += half
    corners[1::2, :2] -= half
    corners[:, 2] += LIFT
    steps = np.hypot(*(points - before)[:, :2].T) / road.width
    uv = np.column_stack([np.tile([0.0, 1.0], len(points)), np.repeat(np.cumsum(steps), 2)])
    first = 2 * np.arange(len(points) - 1)[:, None]
    triangles = (first + np.array([0, 1, 2, 2, 1, 3])).reshape(-1, 3).astype(np.int32)
    made = shade_smooth(MeshData(corners, triangles))
    return PaintedPart(corners, made.normals, uv, triangles)
