"""Divides rectilinear polygons into few rectangles."""
from __future__ import annotations

from typing import Iterator, List, Sequence, Tuple

from .building_plan import Point

Interval = Tuple[float, float]
Rectangle = Tuple[float, float, float, float]
"""Least x and y, greatest x and y."""

TINY = 1e-6
"""Least width of a rectangle, m."""


def loop_of(rectangle: Rectangle) -> List[Point]:
    """The corners of a rectangle, counter-clockwise."""
    x0, y0, x1, y1 = rectangle
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


def is_rectilinear(loop: Sequence[Point]) -> bool:
    """True if every edge is along x or y."""
    return all(abs(a[0] - b[0]) < TINY or abs(a[1] - b[1]) < TINY for a, b in _edges(loop))


def rectangles(outline: Sequence[Point], holes: Sequence[Sequence[Point]]) -> List[Rectangle]:
    """Disjoint rectangles that cover an outline without its holes.

    All loops are rectilinear; holes may overlap and extend beyond the outline. The result consists
    of vertical strips between the corners' x; equal neighbours are merged, so that a door in a wall
    gives three rectangles and a window four.
    """
    xs = sorted({point[0] for loop in (outline, *holes) for point in loop})
    low, high = min(point[0] for point in outline), max(point[0] for point in outline)
    xs = [x for x in xs if low <= x <= high]
    open_: List[Tuple[Interval, float]] = []
    found: List[Rectangle] = []
    for x0, x1 in zip(xs, xs[1:]):
        if x1 - x0 < TINY:
            continue
        spans = _without(_inside(outline, (x0 + x1) / 2),
                         [span for hole in holes for span in _inside(hole, (x0 + x1) / 2)])
        kept = [entry for entry in open_ if entry[0] in spans]
        found += [(start, span[0], x0, span[1]) for span, start in open_ if span not in spans]
        known = {span for span, _ in kept}
        open_ = kept + [(span, x0) for span in spans if span not in known]
    found += [(start, span[0], xs[-1], span[1]) for span, start in open_]
    return sorted(found)


def _inside(loop: Sequence[Point], x: float) -> List[Interval]:
    """Intervals of the vertical line at x inside a rectilinear loop."""
    ys = sorted(a[1] for a, b in _edges(loop) if min(a[0], b[0]) < x < max(a[0], b[0]))
    return list(zip(ys[::2], ys[1::2]))


def _without(spans: List[Interval], cuts: List[Interval]) -> List[Interval]:
    left: List[Interval] = []
    for low, high in spans:
        at = low
        for start, end in sorted(cuts):
            if end <= at or start >= high:
                continue
            if start - at > TINY:
                left.append((at, start))
            at = max(at, end)
        if high - at > TINY:
            left.append((at, high))
    return left


def _edges(loop: Sequence[Point]) -> Iterator[Tuple[Point, Point]]:
    return zip(loop, [*loop[1:], *loop[:1]])
