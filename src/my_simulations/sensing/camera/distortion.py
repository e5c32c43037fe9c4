"""Lens distortion: which pixel of an ideal picture is seen where."""
from __future__ import annotations

import math
from typing import Tuple

import numpy as np

from ..api import CameraSpec, Distortion

_ROUNDS = 12
_STRIDE = 0.5     # longest step of a round, of normalised coordinates
_ENTRIES = 4096

_Bend = Tuple[np.ndarray, np.ndarray, np.ndarray]
"""The derivative of the lens, a symmetric matrix: xx, xy and yy."""


def distort(model: Distortion, x: np.ndarray, y: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Apply lens distortion to normalised coordinates (Brown's model, as in OpenCV)."""
    squared = x * x + y * y
    radial = _radial(model, squared)
    return (x * radial + 2.0 * model.p1 * x * y + model.p2 * (squared + 2.0 * x * x),
            y * radial + model.p1 * (squared + 2.0 * y * y) + 2.0 * model.p2 * x * y)


def _radial(lens: Distortion, squared: np.ndarray) -> np.ndarray:
    """By how much the lens stretches; `squared`: of the ideal distance from the middle."""
    stretch: np.ndarray = 1.0 + squared * (lens.k1 + squared * (lens.k2 + squared * lens.k3))
    return stretch


def source_pixels(spec: CameraSpec) -> Tuple[np.ndarray, np.ndarray]:
    """Return the column and row (float) in the undistorted picture of each distorted pixel.

    The inverse of the model: of its radial part from a table, the rest by Newton's rounds. Pixels
    that no ideal one falls on, short of where the lens folds the picture, lie outside.
    """
    lens = spec.distortion or Distortion()
    f = spec.focal_length
    middle = (spec.width * lens.center[0] - 0.5, spec.height * lens.center[1] - 0.5)
    column, row = np.meshgrid(np.arange(spec.width, dtype=float),
                              np.arange(spec.height, dtype=float))
    x_seen, y_seen = (column - middle[0]) / f, (row - middle[1]) / f
    if lens.crop:
        share = crop_share(spec)
        x_seen, y_seen = x_seen * share, y_seen * share
    corner = math.hypot(max(middle[0], spec.width - 1 - middle[0]),
                        max(middle[1], spec.height - 1 - middle[1])) / f
    x, y = _without_radial(lens, x_seen, y_seen, corner)
    for _ in range(_ROUNDS):
        miss_x, miss_y, bend = _misses(lens, x, y, x_seen, y_seen)
        whole = np.where(_is_unfolded(*bend), bend[0] * bend[2] - bend[1] ** 2, np.inf)
        x += np.clip((miss_x * bend[2] - miss_y * bend[1]) / whole, -_STRIDE, _STRIDE)
        y += np.clip((miss_y * bend[0] - miss_x * bend[1]) / whole, -_STRIDE, _STRIDE)
    miss_x, miss_y, bend = _misses(lens, x, y, x_seen, y_seen)
    lost = (np.hypot(miss_x, miss_y) * f > 0.5) | ~_is_unfolded(*bend)
    x[lost] = np.inf
    return x * f + middle[0], y * f + middle[1]


def _without_radial(lens: Distortion, x_seen: np.ndarray, y_seen: np.ndarray, corner: float,
                    ) -> Tuple[np.ndarray, np.ndarray]:
    """Ideal coordinates as if the lens had only its radial part.

    `corner`: ideal distance from the middle up to which anything is seen; what the lens puts
    further out than that, or than its fold, comes from there.
    """
    ideal = np.linspace(0.0, 1.1 * corner, _ENTRIES)
    seen = ideal * _radial(lens, ideal * ideal)
    falls = np.flatnonzero(np.diff(seen) <= 0.0)
    end = int(falls[0]) + 1 if len(falls) else _ENTRIES
    away = np.hypot(x_seen, y_seen)
    share = np.interp(away, seen[:end], ideal[:end]) / np.where(away > 0.0, away, 1.0)
    return x_seen * share, y_seen * share


def _misses(lens: Distortion, x: np.ndarray, y: np.ndarray, x_seen: np.ndarray,
            y_seen: np.ndarray) -> "Tuple[np.ndarray, np.ndarray, _Bend]":
    """How far the lens puts ideal coordinates from the seen ones, and its derivative there."""
    squared = x * x + y * y
    radial = _radial(lens, squared)
    slope = 2.0 * (lens.k1 + squared * (2.0 * lens.k2 + squared * 3.0 * lens.k3))
    at_x, at_y = distort(lens, x, y)
    return x_seen - at_x, y_seen - at_y, (
        radial + x * x * slope + 2.0 * lens.p1 * y + 6.0 * lens.p2 * x,
        x * y * slope + 2.0 * lens.p1 * x + 2.0 * lens.p2 * y,
        radial + y * y * slope + 6.0 * lens.p1 * y + 2.0 * lens.p2 * x)


def _is_unfolded(across: np.ndarray, mixed: np.ndarray, down: np.ndarray) -> np.ndarray:
    """Where a derivative neither mirrors nor turns the picture over: short of a fold."""
    kept: np.ndarray = (across * down - mixed * mixed > 0.0) & (across + down > 0.0)
    return kept


def crop_share(spec: CameraSpec) -> float:
    """How much smaller the part is that a barrel distortion fills."""
    lens, f = spec.distortion or Distortion(), spec.focal_length
    if lens.k1 >= 0.0:
        return 1.0
    x = np.array([spec.width / 2 / f])
    y = np.array([spec.height / 2 / f])
    edge_x, _ = distort(lens, x, np.zeros(1))
    _, edge_y = distort(lens, np.zeros(1), y)
    return float(min(edge_x[0] / x[0], edge_y[0] / y[0], 1.0))


def sample_bilinear(picture: np.ndarray, column: np.ndarray, row: np.ndarray) -> np.ndarray:
    """Sample a picture (h, w, 3) with bilinear interpolation; black outside of it."""
    height, width = picture.shape[:2]
    inside = (column >= 0) & (row >= 0) & (column <= width - 1) & (row <= height - 1)
    column, row = np.where(inside, column, 0.0), np.where(inside, row, 0.0)
    left: np.ndarray = column.astype(np.int64)
    top: np.ndarray = row.astype(np.int64)
    right, bottom = np.minimum(left + 1, width - 1), np.minimum(top + 1, height - 1)
    u, v = (column - left)[..., None], (row - top)[..., None]
    upper = picture[top, left] * (1 - u) + picture[top, right] * u
    lower = picture[bottom, left] * (1 - u) + picture[bottom, right] * u
    made = np.rint(upper * (1 - v) + lower * v).astype(picture.dtype)
    made[~inside] = 0
    return made


def sample_nearest(picture: np.ndarray, column: np.ndarray, row: np.ndarray, outside: float,
                   ) -> np.ndarray:
    """Sample the nearest pixels of a picture (h, w); `outside` for positions outside of it."""
    height, width = picture.shape
    column, row = np.where(np.isfinite(column), column, -9.0), np.where(np.isfinite(row), row, -9.0)
    x, y = np.rint(column).astype(np.int64), np.rint(row).astype(np.int64)
    inside = (x >= 0) & (y >= 0) & (x < width) & (y < height)
    made = picture[np.clip(y, 0, height - 1), np.clip(x, 0, width - 1)]
    made[~inside] = outside
    return made
