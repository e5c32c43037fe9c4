"""Polygons with holes as triangles, and as convex pieces."""
from __future__ import annotations

import math
from typing import Dict, Iterator, List, Optional, Sequence, Set, Tuple

Point = Tuple[float, float]
Triangle = Tuple[int, int, int]


def signed_area(loop: Sequence[Point]) -> float:
    """The area inside a loop; positive if it is counter-clockwise."""
    return sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(loop, [*loop[1:], *loop[:1]])) / 2


def orient_loops(loops: Sequence[Sequence[Point]]) -> List[List[Point]]:
    """Make the first loop counter-clockwise and the others, its holes, clockwise."""
    return [list(loop) if (signed_area(loop) > 0) == (number == 0) else list(reversed(loop))
            for number, loop in enumerate(loops)]


def triangulate(loops: Sequence[Sequence[Point]]) -> Tuple[List[Point], List[Triangle]]:
    """Triangulate the first loop with the others as holes.

    Args:
        loops: as returned by `orient_loops`. Time grows with the square of the number of points.

    Returns:
        All points, loop after loop, and counter-clockwise triangles that index them. For a loop
        that crosses itself the covered area may differ from the intended one.
    """
    points = [point for loop in loops for point in loop]
    ends: List[List[int]] = []
    for loop in loops:
        first = len(ends[-1]) + ends[-1][0] if ends else 0
        ends.append(list(range(first, first + len(loop))))
    return points, _clip_ears(_bridge_holes(ends, points), points)


def _bridge_holes(loops: List[List[int]], points: List[Point]) -> List[int]:
    """One loop of indices; each hole is connected by a bridge that is passed twice.

    Source: Eberly, Triangulation by Ear Clipping, section 5. Holes that lie farther in x come
    first, so that nothing but the ring is on the way from a hole in that direction.
    """
    ring = loops[0]
    for hole in sorted(loops[1:], key=lambda hole: -max(points[i][0] for i in hole)):
        start = max(range(len(hole)), key=lambda k: points[hole[k]])
        turned = hole[start:] + hole[:start]
        at = _visible(points[turned[0]], ring, points)
        ring = ring[:at + 1] + turned + turned[:1] + ring[at:]
    return ring


def _visible(start: Point, ring: List[int], points: List[Point]) -> int:
    """Index in the ring of a corner that can be seen from a point inside, in the direction of x."""
    met = _edge_ahead(start, ring, points)
    if met is None:
        return min(range(len(ring)), key=lambda k: math.dist(start, points[ring[k]]))
    x, k = met
    farther = max(points[ring[k]], points[ring[(k + 1) % len(ring)]])
    triangle = [start, (x, start[1]), farther]
    if signed_area(triangle) < 0:
        triangle.reverse()
    seen = [n for n, i in enumerate(ring) if _opens_to(ring, n, start, points) and (
        points[i] == farther or _covers(triangle, points[i]) and points[i] != start)]
    if not seen:
        return k if points[ring[k]] == farther else (k + 1) % len(ring)
    # Of the corners in between, the one nearest to the direction of x hides the others.
    return min(seen, key=lambda n: (_steepness(start, points[ring[n]]),
                                    math.dist(start, points[ring[n]])))


def _edge_ahead(start: Point, ring: List[int], points: List[Point]) -> Optional[Tuple[float, int]]:
    """The place (x) and number of the first edge that a ray along x meets from inside."""
    met: Optional[Tuple[float, int]] = None
    for k, (a, b) in enumerate(_edges(ring)):
        (ax, ay), (bx, by) = points[a], points[b]
        if ay < by and ay <= start[1] <= by:
            x = ax + (start[1] - ay) / (by - ay) * (bx - ax)
            if x >= start[0] and (met is None or x < met[0]):
                met = x, k
    return met


def _covers(triangle: Sequence[Point], point: Point) -> bool:
    """True if a counter-clockwise triangle has the point inside or on its edges."""
    a, b, c = triangle
    return _turn(a, b, point) >= 0 and _turn(b, c, point) >= 0 and _turn(c, a, point) >= 0


def _steepness(start: Point, end: Point) -> float:
    """Return |dy| / dx of a segment; infinite if it does not lead in the direction of x."""
    ahead, aside = end[0] - start[0], abs(end[1] - start[1])
    return aside / ahead if ahead > 0 else math.inf


def _opens_to(ring: List[int], k: int, target: Point, points: List[Point]) -> bool:
    """True if the inside of the ring at corner `k` is towards `target`."""
    before, here = points[ring[k - 1]], points[ring[k]]
    after = points[ring[(k + 1) % len(ring)]]
    if _turn(before, here, after) >= 0:
        return _turn(before, here, target) >= 0 and _turn(here, after, target) >= 0
    return _turn(before, here, target) >= 0 or _turn(here, after, target) >= 0


def _edges(loop: List[int]) -> Iterator[Tuple[int, int]]:
    return zip(loop, [*loop[1:], *loop[:1]])


def _turn(a: Point, b: Point, c: Point) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _clip_ears(ring: List[int], points: List[Point]) -> List[Triangle]:
    triangles: List[Triangle] = []
    ring = list(ring)
    at, waited = 0, 0
    while len(ring) > 3:
        at %= len(ring)
        if _is_ear(ring, at, points) or waited > len(ring):
            corner = (ring[at - 1], ring[at], ring[(at + 1) % len(ring)])
            if _turn(*(points[i] for i in corner)) > 0:
                triangles.append(corner)
            del ring[at]
            at, waited = max(at - 1, 0), 0
        else:
            at, waited = at + 1, waited + 1
    if len(ring) == 3 and _turn(*(points[i] for i in ring)) > 0:
        triangles.append((ring[0], ring[1], ring[2]))
    return triangles


def _is_ear(ring: List[int], at: int, points: List[Point]) -> bool:
    a, b, c = points[ring[at - 1]], points[ring[at]], points[ring[(at + 1) % len(ring)]]
    if _turn(a, b, c) <= 0:
        return False
    corners = (a, b, c)
    return not any(_covers(corners, p) for p in (points[i] for i in ring) if p not in corners)


def convex_pieces(points: Sequence[Point], triangles: Sequence[Triangle]) -> List[List[int]]:
    """Convex pieces: triangles merged across their edges as long as the result is convex.

    Source: Hertel and Mehlhorn; at most four times the minimal number of pieces.
    """
    pieces: Dict[int, List[int]] = {n: list(triangle) for n, triangle in enumerate(triangles)}
    owner = {edge: n for n, piece in pieces.items() for edge in _edges(piece)}
    for a, b in list(owner):
        first, second = owner.get((a, b)), owner.get((b, a))
        if first is None or second is None or first == second:
            continue
        joined = _join_loops(pieces[first], pieces[second], a, b)
        if _is_convex(joined, points):
            pieces[first] = joined
            for edge in _edges(pieces.pop(second)):
                owner[edge] = first
            owner.pop((a, b))
            owner.pop((b, a))
    return list(pieces.values())


def _join_loops(first: List[int], second: List[int], a: int, b: int) -> List[int]:
    """Merge two counter-clockwise loops across their common edge a-b."""
    i, j = first.index(b), second.index(a)
    return first[i:] + first[:i] + (second[j:] + second[:j])[1:-1]


def _is_convex(loop: List[int], points: Sequence[Point]) -> bool:
    if len(set(loop)) < len(loop):
        return False
    seen: Set[int] = set()
    for k, index in enumerate(loop):
        seen.add(index)
        if _turn(points[loop[k - 1]], points[index], points[loop[(k + 1) % len(loop)]]) < 0:
            return False
    return True
