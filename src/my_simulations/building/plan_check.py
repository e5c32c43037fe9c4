"""Checks a plan: crossing walls, openings that do not fit."""
from __future__ import annotations

from typing import Dict, Iterator, List, Tuple

from ..errors import Issue, error, warning
from .building_plan import Level, Opening, Plan, Point, Wall

SHORTEST = 0.01
"""Least length of a wall, m; shorter ones are probably drawn by mistake."""

SLACK = 1e-6


def check_plan(plan: Plan) -> List[Issue]:
    """All faults of a plan; with an error no model can be created.

    Crossing or overlapping walls are warnings, because their model is valid.
    """
    issues: List[Issue] = []
    for number, level in enumerate(plan.levels):
        path = f"levels[{number}]"
        issues += _walls(level, path)
        issues += _openings(level, path)
        issues += _floors(level, path)
    return issues


def _walls(level: Level, path: str) -> Iterator[Issue]:
    sound = []
    for number, wall in enumerate(level.walls):
        if wall.length < SHORTEST:
            yield error("wall-zero-length", f"Wall_{wall.id} on {level.name!r} is"
                        f" {wall.length:g} m long; a wall needs at least {SHORTEST:g} m",
                        xpath=f"{path}.walls[{number}]", hint="delete it, or move one of its ends")
        else:
            sound.append(number)
    for a, b in _touching([level.walls[number] for number in sound]):
        first, second = level.walls[sound[a]], level.walls[sound[b]]
        how = _intersection(first, second)
        if how:
            yield warning("walls-" + how, f"Wall_{first.id} and Wall_{second.id} on {level.name!r}"
                          f" {how}", xpath=f"{path}.walls[{sound[b]}]",
                          hint="end both walls at the point where they meet, so that rooms and"
                          " openings are unambiguous")


def _touching(walls: List[Wall]) -> List[Tuple[int, int]]:
    """Pairs of walls whose centre lines have a common point, as indices."""
    if len(walls) < 2:
        return []
    import shapely

    lines = shapely.linestrings([(wall.start, wall.end) for wall in walls])
    pairs = shapely.STRtree(lines).query(lines, predicate="intersects").T.tolist()
    return sorted((a, b) for a, b in pairs if a < b)


def _intersection(a: Wall, b: Wall) -> str:
    """`cross`, `overlap`, or "" for two walls that only meet at their ends."""
    sides = [_side(a, b.start), _side(a, b.end)]
    if max(map(abs, sides)) < SLACK:
        along = sorted(_along(a, point) for point in (b.start, b.end))
        shared = min(along[1], a.length) - max(along[0], 0.0)
        return "overlap" if shared > SHORTEST else ""
    others = [_side(b, a.start), _side(b, a.end)]
    inside = all(min(pair) < -SHORTEST and max(pair) > SHORTEST for pair in (sides, others))
    return "cross" if inside else ""


def _side(wall: Wall, point: Point) -> float:
    """Signed distance of a point from a wall's centre line, positive on its left."""
    dx, dy = wall.end[0] - wall.start[0], wall.end[1] - wall.start[1]
    return (dx * (point[1] - wall.start[1]) - dy * (point[0] - wall.start[0])) / wall.length


def _along(wall: Wall, point: Point) -> float:
    dx, dy = wall.end[0] - wall.start[0], wall.end[1] - wall.start[1]
    return (dx * (point[0] - wall.start[0]) + dy * (point[1] - wall.start[1])) / wall.length


def _openings(level: Level, path: str) -> Iterator[Issue]:
    walls = {wall.id: wall for wall in level.walls}
    holes: Dict[int, List[Tuple[str, Opening]]] = {}
    for kind, opening in level.openings():
        if opening.wall is None:
            continue
        name = f"{kind}_{opening.id}"
        where = f"{path}.{kind.lower()}s"
        if opening.wall not in walls:
            yield error("opening-wall-unknown", f"{name} is in Wall_{opening.wall}, which"
                        f" {level.name!r} does not have", xpath=where)
            continue
        fault = opening_fault(opening, walls[opening.wall])
        if fault:
            yield error(fault[0], f"{name} in Wall_{opening.wall}: {fault[1]}", xpath=where,
                        hint="make it smaller, or move it along the wall")
        holes.setdefault(opening.wall, []).append((name, opening))
    for wall, found in holes.items():
        for n, (name, opening) in enumerate(found):
            for other_name, other in found[:n]:
                if openings_overlap(opening, other):
                    yield error("openings-overlap", f"{other_name} and {name} overlap in"
                                f" Wall_{wall}", xpath=path,
                                hint="move them apart, or make one smaller")


def opening_fault(opening: Opening, wall: Wall) -> Tuple[str, ...]:
    """Issue code and phrase for an opening that does not fit its wall; () if it fits."""
    left, right = opening.along - opening.width / 2, opening.along + opening.width / 2
    if opening.width > wall.length + SLACK:
        return ("opening-wider-than-wall", f"it is {opening.width:g} m wide, the wall"
                f" {wall.length:g} m long")
    if left < -SLACK or right > wall.length + SLACK:
        return ("opening-outside-wall", f"it reaches from {left:g} to {right:g} m of a wall"
                f" {wall.length:g} m long")
    if opening.elevation + opening.height > wall.height + SLACK:
        return ("opening-taller-than-wall", "its top is at"
                f" {opening.elevation + opening.height:g} m, that of the wall at {wall.height:g} m")
    return ()


def openings_overlap(a: Opening, b: Opening) -> bool:
    """True if two openings of one wall overlap."""
    return (abs(a.along - b.along) < (a.width + b.width) / 2 - SLACK
            and a.elevation + a.height > b.elevation + SLACK
            and b.elevation + b.height > a.elevation + SLACK)


def _floors(level: Level, path: str) -> Iterator[Issue]:
    if not level.floors:
        return
    from shapely.geometry import Polygon
    from shapely.validation import explain_validity

    for number, floor in enumerate(level.floors):
        shape = Polygon(floor.outline, floor.holes)
        if not shape.is_valid or shape.area < SHORTEST ** 2:
            why = explain_validity(shape) if not shape.is_valid else "it has no area"
            yield error("floor-outline", f"the outline of Floor_{floor.id} on {level.name!r} is"
                        f" not a simple polygon: {why}", xpath=f"{path}.floors[{number}]",
                        hint="its edges must not cross")
