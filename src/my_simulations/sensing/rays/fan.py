"""Directions of the rays of a fan."""
from __future__ import annotations

import numpy as np


def fan_directions(samples: int, min_angle: float, max_angle: float, rows: int,
                   min_elevation: float, max_elevation: float) -> np.ndarray:
    """Unit directions (rows * samples, 3) of a fan, row by row; a single one is the minimum."""
    yaw, pitch = np.meshgrid(_spread(samples, min_angle, max_angle),
                             _spread(rows, min_elevation, max_elevation))
    yaw, pitch = yaw.ravel(), pitch.ravel()
    return np.stack([np.cos(pitch) * np.cos(yaw), np.cos(pitch) * np.sin(yaw), np.sin(pitch)],
                    axis=1)


def _spread(count: int, low: float, high: float) -> np.ndarray:
    return np.linspace(low, high, count) if count > 1 else np.array([low])
