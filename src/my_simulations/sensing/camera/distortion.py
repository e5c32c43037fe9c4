"""Lens distortion: which pixel of an ideal picture is seen where."""
from __future__ import annotations

from typing import Tuple

import numpy as np

from ..api import CameraSpec, Distortion

_ROUNDS = 30


def distorted(model: Distortion, x: np.ndarray, y: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Where the lens puts ideal normalised coordinates (Brown's model, as OpenCV's)."""
    squared = x * x + y * y
    radial = 1.0 + squared * (model.k1 + squared * (model.k2 + squared * model.k3))
    return (x * radial + 2.0 * model.p1 * x * y + model.p2 * (squared + 2.0 * x * x),
            y * radial + model.p1 * (squared + 2.0 * y * y) + 2.0 * model.p2 * x * y)


def sources(spec: CameraSpec) -> Tuple[np.ndarray, np.ndarray]:
    """For each pixel of the seen picture, column and row (float) in the ideal one.

    The inverse of the model, by fixed-point rounds; pixels that no ideal one falls on lie outside.
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
    x, y = x_seen.copy(), y_seen.copy()
    for _ in range(_ROUNDS):
        at_x, at_y = distorted(lens, x, y)
        x += np.clip(x_seen - at_x, -0.5, 0.5)
        y += np.clip(y_seen - at_y, -0.5, 0.5)
    at_x, at_y = distorted(lens, x, y)
    lost = np.hypot(at_x - x_seen, at_y - y_seen) * f > 0.5
    x[lost] = np.inf
    return x * f + middle[0], y * f + middle[1]


def crop_share(spec: CameraSpec) -> float:
    """How much smaller the part is that a barrel distortion fills."""
    lens, f = spec.distortion or Distortion(), spec.focal_length
    if lens.k1 >= 0.0:
        return 1.0
    x = np.array([spec.width / 2 / f])
    y = np.array([spec.height / 2 / f])
    edge_x, _ = distorted(lens, x, np.zeros(1))
    _, edge_y = distorted(lens, np.zeros(1), y)
    return float(min(edge_x[0] / x[0], edge_y[0] / y[0], 1.0))


def blended(picture: np.ndarray, column: np.ndarray, row: np.ndarray) -> np.ndarray:
    """A picture (h, w, 3) seen at these places, between pixels by parts; black outside."""
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


def nearest(picture: np.ndarray, column: np.ndarray, row: np.ndarray, outside: float,
            ) -> np.ndarray:
    """A picture (h, w) seen at these places, whole pixels only."""
    height, width = picture.shape
    column, row = np.where(np.isfinite(column), column, -9.0), np.where(np.isfinite(row), row, -9.0)
    x, y = np.rint(column).astype(np.int64), np.rint(row).astype(np.int64)
    inside = (x >= 0) & (y >= 0) & (x < width) & (y < height)
    made = picture[np.clip(y, 0, height - 1), np.clip(x, 0, width - 1)]
    made[~inside] = outside
    return made
