"""Plots as inline SVG: points of what was varied against what was measured."""
from __future__ import annotations

import math
from html import escape
from typing import List, Sequence, Tuple

_WIDTH, _HEIGHT = 360, 240
_LEFT, _RIGHT, _TOP, _BOTTOM = 56, 12, 12, 40


def ticks(least: float, most: float, about: int = 5) -> List[float]:
    """Round numbers from `least` to `most`, about so many of them."""
    if not most > least:
        return [least]
    raw = (most - least) / about
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= raw)
    first = math.ceil(least / step - 1e-9)
    last = math.floor(most / step + 1e-9)
    return [index * step for index in range(first, last + 1)]


def scatter(points: Sequence[Tuple[float, float]], across: str, up: str) -> str:
    """A plot of points (x, y), all finite; both axes have their names and round numbers."""
    xs, ys = _range([x for x, _ in points]), _range([y for _, y in points])

    def at(x: float, y: float) -> Tuple[float, float]:
        return (_LEFT + (x - xs[0]) / (xs[1] - xs[0]) * (_WIDTH - _LEFT - _RIGHT),
                _HEIGHT - _BOTTOM - (y - ys[0]) / (ys[1] - ys[0]) * (_HEIGHT - _TOP - _BOTTOM))

    bottom, right = _HEIGHT - _BOTTOM, _WIDTH - _RIGHT
    parts = [f'<svg viewBox="0 0 {_WIDTH} {_HEIGHT}" width="{_WIDTH}" height="{_HEIGHT}" role="img"'
             f' aria-label="{escape(up)} by {escape(across)}">']
    for x in ticks(*xs):
        left = at(x, ys[0])[0]
        parts.append(f'<path class="grid" d="M{left:.1f} {_TOP}V{bottom}"/>'
                     f'<text x="{left:.1f}" y="{bottom + 14}" text-anchor="middle">{x:.4g}</text>')
    for y in ticks(*ys):
        top = at(xs[0], y)[1]
        parts.append(f'<path class="grid" d="M{_LEFT} {top:.1f}H{right}"/>'
                     f'<text x="{_LEFT - 4}" y="{top + 4:.1f}" text-anchor="end">{y:.4g}</text>')
    parts += [f'<circle cx="{at(x, y)[0]:.1f}" cy="{at(x, y)[1]:.1f}" r="2.5"/>' for x, y in points]
    parts.append(f'<text x="{(_LEFT + right) / 2}" y="{_HEIGHT - 6}" text-anchor="middle">'
                 f'{escape(across)}</text><text x="12" y="{(_TOP + bottom) / 2}"'
                 f' text-anchor="middle" transform="rotate(-90 12 {(_TOP + bottom) / 2})">'
                 f'{escape(up)}</text></svg>')
    return "".join(parts)


def _range(values: Sequence[float]) -> Tuple[float, float]:
    """Somewhat more than from the least to the greatest."""
    least, most = min(values), max(values)
    margin = 0.04 * (most - least) or 0.1 * abs(most) or 1.0
    return least - margin, most + margin
