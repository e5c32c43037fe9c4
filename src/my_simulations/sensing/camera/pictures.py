"""Pictures for textures: read from files, or drawn where Gazebo would bring its own."""
from __future__ import annotations

import os
from typing import Any, Optional, Tuple

import numpy as np

from ...appearance.palette import PATTERNS
from ...appearance.textures import existing_path, mesh_image_candidates
from ...formats.image.pixels import pixels_of
from ...formats.image.pixels import read_picture as read

LARGEST = 1024
"""Pixels along a side; larger pictures are made smaller."""

_PATTERN = 256
Rgb = Tuple[int, int, int]


def read_picture(picture: Any) -> Optional[np.ndarray]:
    """uint8 (h, w, 4), the lowest row first, of a path or a PIL image; None if unreadable."""
    if not isinstance(picture, str):
        return pixels_of(picture, LARGEST)
    path = _find_picture(picture)
    return None if path is None else read(path, LARGEST)


def state_of(picture: str) -> Optional[Tuple[str, int, int]]:
    """The file that `read_picture` would read, its time, ns, and its size; None without one."""
    path = _find_picture(picture)
    try:
        status = None if path is None else os.stat(path)
    except OSError:
        return None  # gone since; `read_picture` will say so
    return None if path is None or status is None else (path, status.st_mtime_ns, status.st_size)


def _find_picture(picture: str) -> Optional[str]:
    return existing_path(picture) or next(
        (hit for hit in map(existing_path, mesh_image_candidates(picture, [])) if hit), None)


def draw_pattern(name: str) -> Optional[np.ndarray]:
    """uint8 (256, 256, 4) like the page's pattern of that name; None for one it does not know."""
    pattern = PATTERNS.get(name)
    if pattern is None:
        return None
    canvas, grain = np.zeros((_PATTERN, _PATTERN, 3)), pattern.grain
    colors = tuple((color >> 16, color >> 8 & 255, color & 255) for color in pattern.colors)
    _PAINTERS[pattern.painter](canvas, colors, pattern.count)
    if grain:
        noise = np.random.Generator(np.random.Philox(11)).random((_PATTERN, _PATTERN, 1))
        canvas += (noise - 0.5) * grain
    solid = np.full((_PATTERN, _PATTERN, 1), 255.0)
    return np.concatenate([np.clip(canvas, 0, 255), solid], axis=2).astype(np.uint8)[::-1].copy()


def _fill(canvas: np.ndarray, colors: Tuple[Rgb, ...], _count: int) -> None:
    canvas[:] = colors[0]


def _planks(canvas: np.ndarray, colors: Tuple[Rgb, ...], count: int) -> None:
    size, height = len(canvas), len(canvas) / count
    veins = np.random.Generator(np.random.Philox(7)).random(size)
    for row in range(count):
        top, bottom = round(row * height), round((row + 1) * height)
        canvas[top:bottom] = colors[row % len(colors)]
        canvas[top:bottom] -= veins[top:bottom, None, None] * 18
        joint = round((0.3 if row % 2 else 0.75) * size)
        canvas[top:bottom, joint:joint + 2] *= 0.5
        canvas[top:top + 2] *= 0.5


def _bricks(canvas: np.ndarray, colors: Tuple[Rgb, ...], count: int) -> None:
    size, height, width = len(canvas), len(canvas) // count, len(canvas) // 4
    canvas[:] = colors[0]
    shades = np.random.Generator(np.random.Philox(3)).random((count, 5)) * 0.3 + 0.85
    for row in range(count):
        for column in range(-1, 4):
            left = round((column + (row % 2) / 2) * width)
            canvas[row * height + 2:(row + 1) * height - 1,
                   max(left + 2, 0):min(left + width - 1, size)] = (
                np.array(colors[1]) * shades[row, column])


def _tiles(canvas: np.ndarray, colors: Tuple[Rgb, ...], count: int) -> None:
    step = len(canvas) // count
    canvas[:] = colors[1]
    for x in range(count):
        for y in range(count):
            canvas[y * step + 1:(y + 1) * step - 1, x * step + 1:(x + 1) * step - 1] = colors[0]


def _road(canvas: np.ndarray, colors: Tuple[Rgb, ...], count: int) -> None:
    size = len(canvas)
    canvas[:] = colors[0]
    for line in range(count + 1):
        x = round(4 + (size - 12) * line / count)
        canvas[:size if line in (0, count) else size // 2, x:x + 4] = colors[1]


def _checker(canvas: np.ndarray, colors: Tuple[Rgb, ...], _count: int) -> None:
    half = len(canvas) // 2
    canvas[:] = colors[0]
    canvas[:half, :half] = canvas[half:, half:] = colors[1]


_PAINTERS = {"plain": _fill, "planks": _planks, "bricks": _bricks, "tiles": _tiles,
             "road": _road, "checker": _checker}
