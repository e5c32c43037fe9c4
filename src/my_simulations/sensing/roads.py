"""Roads as triangles: the strip of the editor's page (web/js/view/road_strip.ts).

A test compares both with test/data/road_strips.json.
"""
from __future__ import annotations

from typing import Optional

import numpy as np

from ..description.shapes import MeshData
from ..description.surroundings import Road
from ..formats.mesh.painted import PaintedPart, smooth

LIFT = 0.01
"""m by which a road lies above its points, so that a ground at their height does not hide it."""


def strip(road: Road) -> Optional[PaintedPart]:
    """A flat strip along the points, in the world frame; None for one without length or width.

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
    made = smooth(MeshData(corners, triangles))
    return PaintedPart(corners, made.normals, uv, triangles)
