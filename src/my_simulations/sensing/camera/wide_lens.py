"""Pictures through wide-angle lenses, made of pinhole pictures to the sides of a cube.

Source: Gazebo's CameraLens and WideAngleCamera.
"""
from __future__ import annotations

import math
from dataclasses import replace
from typing import Callable, List, Mapping, Optional, Sequence, Tuple

import numpy as np

from ..api import NO_ROW, CameraSpec, WideLens
from .distortion import sample_bilinear, sample_nearest
from .kept_pictures import Drawn

_INVERSE: Mapping[str, Callable[[np.ndarray], np.ndarray]] = {
    "tan": np.arctan, "sin": np.arcsin, "id": np.asarray}
_SIDES: Tuple[Tuple[Tuple[int, int, int], Tuple[int, int, int]], ...] = (
    ((1, 0, 0), (0, 0, 1)), ((0, 1, 0), (0, 0, 1)), ((0, -1, 0), (0, 0, 1)),
    ((0, 0, 1), (-1, 0, 0)), ((0, 0, -1), (1, 0, 0)), ((-1, 0, 0), (0, 0, 1)))
"""Forward and up of the six pictures, in the sensor frame."""


class Side:
    """One of the pinhole pictures, and the pixels that come from it.

    Attributes:
        frame: sensor frame from the frame of this picture, 4 x 4.
        pixels: the indices of the pixels of the whole picture, flat.
        column, row: their places in this picture.
        ahead: factors that make depths along the sensor's +x of the depths of the nearest pixels.
    """

    def __init__(self, turn: np.ndarray, rays: np.ndarray, pixels: np.ndarray, focal: float,
                 side: int) -> None:
        self.frame, self.pixels = np.eye(4), pixels
        self.frame[:3, :3] = turn
        here = rays[pixels] @ turn
        middle = (side - 1) / 2.0
        self.column = middle - focal * here[:, 1] / here[:, 0]
        self.row = middle - focal * here[:, 2] / here[:, 0]
        left, up = ((middle - np.rint(place)) / focal for place in (self.column, self.row))
        self.ahead = (turn[0, 0] + turn[0, 1] * left + turn[0, 2] * up).astype(np.float32)


class LensMap:
    """Maps pixels of pinhole pictures, to the sides of a cube, to a wide-angle picture.

    Attributes:
        spec: camera of each pinhole picture.
        sides: the sides of the cube that the lens shows.
    """

    def __init__(self, spec: CameraSpec, lens: WideLens) -> None:
        self._whole = spec
        side = max(4, lens.side)
        focal = side / 2.0 - 1.0   # a pixel more on each side than a quarter turn
        self.spec = replace(spec, width=side, height=side, hfov=2.0 * math.atan(side / 2.0 / focal),
                            distortion=None, lens=None)
        rays, inside = rays_of(spec, lens)
        turns = [np.array([ahead, np.cross(up, ahead), up], dtype=float).T for ahead, up in _SIDES]
        nearest_side = np.argmax(np.stack([rays @ turn[:, 0] for turn in turns]), axis=0)
        found = (np.flatnonzero(inside & (nearest_side == n)) for n in range(len(turns)))
        self.sides: List[Side] = [Side(turn, rays, pixels, focal, side)
                                  for turn, pixels in zip(turns, found) if len(pixels)]

    def compose_picture(self, drawn: Sequence[Drawn]) -> Drawn:
        """Compose the picture; outside of the lens it is black, without label, with depth inf."""
        size = self._whole.width * self._whole.height
        shape = (self._whole.height, self._whole.width)
        rgb: Optional[np.ndarray] = None
        depth: Optional[np.ndarray] = None
        labels: Optional[np.ndarray] = None
        for side, (colours, away, rows) in zip(self.sides, drawn):
            if colours is not None:
                rgb = np.zeros((size, 3), np.uint8) if rgb is None else rgb
                rgb[side.pixels] = sample_bilinear(colours, side.column, side.row)
            if away is not None:
                depth = np.full(size, np.inf, np.float32) if depth is None else depth
                seen = sample_nearest(away, side.column, side.row, np.inf)
                depth[side.pixels] = seen * side.ahead
            if rows is not None:
                labels = np.full(size, NO_ROW, np.int32) if labels is None else labels
                labels[side.pixels] = sample_nearest(rows, side.column, side.row, NO_ROW)
        return (None if rgb is None else rgb.reshape(*shape, 3),
                None if depth is None else depth.reshape(shape),
                None if labels is None else labels.reshape(shape))


def rays_of(spec: CameraSpec, lens: WideLens) -> Tuple[np.ndarray, np.ndarray]:
    """Unit directions (pixels, 3) in the sensor frame, and which of them the lens has."""
    half = spec.width / 2.0
    column, row = np.meshgrid(np.arange(spec.width), np.arange(spec.height))
    right = ((column - (spec.width - 1) / 2.0) / half).ravel()
    down = ((row - (spec.height - 1) / 2.0) / half).ravel()
    away = np.hypot(right, down)
    with np.errstate(invalid="ignore"):   # of an arcsine above 1: outside of the lens
        angle = lens.c2 * (_INVERSE[lens.fun](away / lens.scale) - lens.c3)
    inside = (angle <= lens.cutoff) & (angle <= math.pi)
    angle = np.where(inside, angle, 0.0)
    share = np.sin(angle) / np.where(away > 0.0, away, 1.0)
    return np.stack([np.cos(angle), -share * right, -share * down], axis=1), inside
