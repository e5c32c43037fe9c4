"""Warnings about valid but suspicious models: flat shapes, implausible inertia, overlaps.

The checks are conservative: models that only touch, or whose exact shape is not known here, are
not reported.
"""
from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import islice
from typing import Dict, Iterator, List, Optional, Sequence, Set, Tuple

from ..errors import Severity
from ..geometry import IDENTITY, Pose, Vec3, compose, conjugate, dot, norm, rotate, scale
from .link_surface import dominant_collision, friction_coefficient
from .model import WORLD, Inertial, Link, Model
from .shapes import Box, Capsule, Collision, Cylinder, Ellipsoid, Geometry, Plane, Sphere
from .validate import Fault

MOST_PIECES = 127
"""Links with unlike friction are divided up to this number of links (`engine.surface_pieces`)."""

THINNEST_M = 1e-4
DEEPEST_M = 0.005
MOST_OVERLAPS, MOST_COMPARED = 10_000, 1_000_000
"""Limits of the search for overlapping collisions: pairs found, and pairs compared.

The search takes 2 microseconds for each pair found and 0.3 for each compared.
"""

_TOO_LARGE = 10.0
_TOO_SMALL = 0.01


def find_advice(models: Sequence[Model], only: str = "") -> Iterator[Fault]:
    """Find suspicious properties of the models of a world; each with its model and link.

    `only`: the name of the one model to report on; "" for all.
    """
    for model in models:
        if only not in ("", model.name):
            continue
        odd: List[Fault] = []
        shared: List[Fault] = []
        thin: List[Fault] = []
        is_divided = _count_pieces(model) <= MOST_PIECES
        for name, link, _pose, static in links_of(model):
            for collision in link.collisions:
                thin += _thin(collision, name)
            if not static and not is_divided:
                shared += _shared_friction(link, name)
            if not static:
                odd += _odd_inertia(link, name)
        yield from first_with_count(thin, "collisions")
        yield from first_with_count(odd, "links")
        yield from first_with_count(shared, "links")
    yield from _overlaps(models, only)


def first_with_count(alike: Sequence[Fault], parts: str) -> Iterator[Fault]:
    """Return the first of alike faults of one model; its message counts the others.

    `parts`: what has the faults, in the plural.
    """
    if alike:
        more = (f" (as is true of {len(alike) - 1} more of the model's {parts})"
                if len(alike) > 1 else "")
        yield replace(alike[0], message=alike[0].message + more)


def links_of(model: Model, above: Pose = IDENTITY, scope: str = "",
             static: bool = False) -> Iterator[Tuple[str, Link, Pose, bool]]:
    """(scoped name, link, world pose, whether it is fixed) of all links, including nested ones."""
    name = f"{scope}{model.name}::"
    base = compose(above, model.pose)
    static = static or model.static
    held = _links_fixed_to_world(model) if model.joints else set()
    for link in model.links:
        still = static or link.kinematic or link.name in held
        yield name + link.name, link, compose(base, link.pose), still
    for inner in model.models:
        yield from links_of(inner, base, name, static)


def _count_pieces(model: Model) -> int:
    """Return the number of links, counting each once for each friction of its collisions."""
    return (sum(max(1, len({friction_coefficient(one.surface) for one in link.collisions}))
                for link in model.links) + sum(map(_count_pieces, model.models)))


def _links_fixed_to_world(model: Model) -> Set[str]:
    """Names of the links that fixed joints connect to the world."""
    rigid = [joint for joint in model.joints if joint.type == "fixed" or (
        joint.axis is not None and joint.axis.lower == joint.axis.upper and joint.axis2 is None)]
    held: Set[str] = {WORLD}
    while True:
        more = {joint.child for joint in rigid if joint.parent in held} | {
            joint.parent for joint in rigid if joint.child in held and joint.child != WORLD}
        if more <= held:
            return held - {WORLD}
        held |= more


def half_extents(geometry: Geometry) -> Optional[Vec3]:
    """Half extents (m) of the bounding box in the shape's frame; None for meshes and planes."""
    if isinstance(geometry, Box):
        return scale(geometry.size, 0.5)
    if isinstance(geometry, Sphere):
        return (geometry.radius,) * 3
    if isinstance(geometry, Ellipsoid):
        return geometry.radii
    if isinstance(geometry, Capsule):
        return (geometry.radius, geometry.radius, geometry.length / 2 + geometry.radius)
    if isinstance(geometry, Cylinder):
        return (geometry.radius, geometry.radius, geometry.length / 2)
    return None


def reach_of(link: Link) -> float:
    """Radius about the link's origin, m, that contains its shapes; infinite for planes.

    Meshes are left out: `find_advice` does not check whether they overlap.
    """
    reach = 0.0
    for collision in link.collisions:
        if isinstance(collision.geometry, Plane):
            return math.inf
        half = half_extents(collision.geometry)
        if half is not None:
            reach = max(reach, norm(collision.pose.position) + norm(half))
    return reach


def _thin(collision: Collision, link: str) -> Iterator[Fault]:
    half = half_extents(collision.geometry)
    if half is not None and 2 * min(half) < THINNEST_M:
        yield Fault("shape-thin", f"collision {collision.name!r} of {link!r} is"
                    f" {2 * min(half):g} m thin; moving bodies can pass through it", collision,
                    Severity.WARNING, "give it a thickness of a millimetre or more")


def thin_mesh(collision: Collision, link: str, extents: Sequence[float]) -> Iterator[Fault]:
    """Warning about a flat collision mesh; `extents`: edge lengths of its bounding box, m."""
    if min(extents) < THINNEST_M:
        yield Fault("shape-thin", f"the mesh of collision {collision.name!r} of {link!r} is"
                    f" {min(extents):g} m thin; moving bodies can pass through it", collision,
                    Severity.WARNING, "use a box of a millimetre or more, or a mesh with two sides")


def _shared_friction(link: Link, name: str) -> Iterator[Fault]:
    """Collisions with unlike friction, of which one holds for all."""
    counting = dominant_collision(link)
    found = sorted({friction_coefficient(one.surface) for one in link.collisions})
    if counting is None or len(found) < 2:
        return
    listed = ", ".join(f"{mu:g}" for mu in found)
    yield Fault("friction-shared", f"the collisions of {name!r} have unlike friction (mu {listed});"
                f" mu {friction_coefficient(counting.surface):g} of {counting.name!r},"
                " which reaches lowest,"
                " holds for all of them", counting, Severity.WARNING,
                "give those with another friction a link of their own, joined to this one")


def _odd_inertia(link: Link, name: str) -> Iterator[Fault]:
    """Warning about moments that no mass distribution in the collisions' bounding box has."""
    extents = _extents(link)
    moments = _moments(link.inertial)
    mass = link.inertial.mass
    if extents is None or mass <= 0 or min(moments) <= 0:
        return
    x, y, z = (edge * edge for edge in extents)
    for axis, moment, square in zip("xyz", moments, (y + z, x + z, x + y)):
        # 1/4 for all mass in the edges of the box, 1/12 for uniform density.
        if moment > _TOO_LARGE * mass * square / 4:
            yield Fault("inertia-odd", f"i{axis}{axis} of {name!r} is {moment:.3g} kg m^2; {mass:g}"
                        f" kg within its collisions have {mass * square / 12:.3g} or so",
                        link.inertial, Severity.WARNING,
                        "compute the inertia from mass and size; without <inertial> SDF takes 1")
            return
        if moment < _TOO_SMALL * mass * square / 12:
            yield Fault("inertia-odd", f"i{axis}{axis} of {name!r} is {moment:.3g} kg m^2, far too"
                        f" little: {mass:g} kg of that size have {mass * square / 12:.3g} or so",
                        link.inertial, Severity.WARNING,
                        "compute the inertia from mass and size")
            return


def _moments(inertial: Inertial) -> Vec3:
    """Moments about the link axes for rotations by 90 degrees; else three times their mean."""
    diagonal = (inertial.ixx, inertial.iyy, inertial.izz)
    if inertial.pose.orientation == IDENTITY.orientation:
        return diagonal
    mean = sum(diagonal) / 3
    return (mean, mean, mean)


def _extents(link: Link) -> Optional[Vec3]:
    """Edge lengths of the collisions' bounding box in link axes, m; None if a size is unknown."""
    low, high = [math.inf] * 3, [-math.inf] * 3
    for collision in link.collisions:
        reach = _reach(collision.geometry, collision.pose)
        if reach is None:
            return None
        for n in range(3):
            low[n] = min(low[n], collision.pose.position[n] - reach[n])
            high[n] = max(high[n], collision.pose.position[n] + reach[n])
    if not link.collisions:
        return None
    return (high[0] - low[0], high[1] - low[1], high[2] - low[2])


def _reach(geometry: Geometry, pose: Pose) -> Optional[Vec3]:
    """Half extents of the shape's bounding box along the axes of the frame of `pose`."""
    half = half_extents(geometry)
    if half is None:
        return None
    q = pose.orientation
    x, y, z = (rotate(q, axis) for axis in ((half[0], 0.0, 0.0), (0.0, half[1], 0.0),
                                            (0.0, 0.0, half[2])))
    return (abs(x[0]) + abs(y[0]) + abs(z[0]), abs(x[1]) + abs(y[1]) + abs(z[1]),
            abs(x[2]) + abs(y[2]) + abs(z[2]))


@dataclass
class _Core:
    """An axis-aligned box (world frame) that lies completely inside a shape."""

    model: str
    link: str
    low: Vec3
    high: Vec3
    static: bool
    collision: Collision


def _overlaps(models: Sequence[Model], only: str) -> Iterator[Fault]:
    """Pairs of models that overlap at the start, each with its deepest collision."""
    deepest: Dict[Tuple[str, str], Tuple[float, str, Collision]] = {}
    for mover, still, depth, collision in _insides(models, only):
        pair = mover, _top_model(still)
        if depth > deepest.get(pair, (DEEPEST_M,))[0]:
            deepest[pair] = depth, still, collision
    pairs: Dict[Tuple[str, str], List[Tuple[float, Fault]]] = {}
    for (mover, other), (depth, still, collision) in deepest.items():
        pairs.setdefault((_top_model(mover), other), []).append(
            (depth, _inside(mover, still, depth, collision)))
    for found in pairs.values():
        found.sort(key=lambda one: -one[0])
        yield from first_with_count([fault for _depth, fault in found], "links")


def _top_model(scoped: str) -> str:
    return scoped.partition("::")[0]


def _insides(models: Sequence[Model], only: str) -> Iterator[Tuple[str, str, float, Collision]]:
    """Links that start in another model: the link, the one that it is in, metres, its shape."""
    cores: List[_Core] = []
    planes: List[Tuple[str, str, Pose, Plane]] = []
    movers: List[Tuple[str, str, Collision, Pose]] = []
    for model in models:
        for name, link, pose, static in links_of(model):
            for collision in link.collisions:
                if collision.surface.collide_without_contact:
                    continue
                at = compose(pose, collision.pose)
                if isinstance(collision.geometry, Plane):
                    planes.append((model.name, name, at, collision.geometry))
                    continue
                core = _core(collision.geometry, at)
                if core is not None:
                    cores.append(_Core(model.name, name, *core, static, collision))
                if not static:
                    movers.append((model.name, name, collision, at))
    yield from _in_planes(planes, movers, only)
    yield from _in_each_other(cores, only)


def _core(geometry: Geometry, pose: Pose) -> Optional[Tuple[Vec3, Vec3]]:
    half = half_extents(geometry)
    if half is None:
        return None
    inner = _inscribed(geometry, half)
    reach = _reach(Box(scale(inner, 2.0)), pose)
    if reach is None or not _is_along_axes(pose):
        # This cube is inside the inscribed sphere for any rotation.
        reach = (min(half) / math.sqrt(3),) * 3
    p = pose.position
    return ((p[0] - reach[0], p[1] - reach[1], p[2] - reach[2]),
            (p[0] + reach[0], p[1] + reach[1], p[2] + reach[2]))


def _inscribed(geometry: Geometry, half: Vec3) -> Vec3:
    if isinstance(geometry, Box):
        return half
    if isinstance(geometry, Cylinder):
        side = half[0] / math.sqrt(2)
        return (side, side, half[2])
    if isinstance(geometry, Capsule):
        side = half[0] / math.sqrt(2)
        return (side, side, geometry.length / 2)
    return scale(half, 1 / math.sqrt(3))


def _is_along_axes(pose: Pose) -> bool:
    axes = (rotate(pose.orientation, axis) for axis in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)))
    return all(max(map(abs, axis)) > 1 - 1e-9 for axis in axes)


def _in_planes(planes: Sequence[Tuple[str, str, Pose, Plane]],
               movers: Sequence[Tuple[str, str, Collision, Pose]],
               only: str) -> Iterator[Tuple[str, str, float, Collision]]:
    for ground_model, ground, at, plane in planes:
        normal = rotate(at.orientation, scale(plane.normal, 1 / norm(plane.normal)))
        level = dot(normal, at.position)
        for model, name, collision, pose in movers:
            if model == ground_model or (only and only not in (model, ground_model)):
                continue
            depth = level - dot(normal, pose.position) + _support(collision.geometry, pose, normal)
            if depth > DEEPEST_M:
                yield name, ground, depth, collision


def _support(geometry: Geometry, pose: Pose, normal: Vec3) -> float:
    """Extent of the shape from its centre against `normal`, or a lower bound."""
    half = half_extents(geometry)
    if half is None:
        return -math.inf
    n = rotate(conjugate(pose.orientation), normal)
    if isinstance(geometry, Sphere):
        return geometry.radius
    if isinstance(geometry, Cylinder):
        return math.hypot(n[0], n[1]) * geometry.radius + abs(n[2]) * geometry.length / 2
    if isinstance(geometry, Capsule):
        return geometry.radius + abs(n[2]) * geometry.length / 2
    if isinstance(geometry, Ellipsoid):
        return norm((n[0] * half[0], n[1] * half[1], n[2] * half[2]))
    return abs(n[0]) * half[0] + abs(n[1]) * half[1] + abs(n[2]) * half[2]


def _in_each_other(cores: List[_Core], only: str) -> Iterator[Tuple[str, str, float, Collision]]:
    """Overlapping pairs, by sweep and prune along x; at most `MOST_OVERLAPS` of them."""
    cores = sorted(cores, key=lambda core: core.low[0])
    found = compared = 0
    for n, one in enumerate(cores):
        if found >= MOST_OVERLAPS or compared >= MOST_COMPARED:
            return
        for other in islice(cores, n + 1, None):
            if other.low[0] > one.high[0] - DEEPEST_M:
                break
            compared += 1
            if other.low[1] > one.high[1] or one.low[1] > other.high[1]:
                continue
            if one.model == other.model or (one.static and other.static):
                continue
            if only and only not in (one.model, other.model):
                continue
            depth = min(min(one.high[i], other.high[i]) - max(one.low[i], other.low[i])
                        for i in range(3))
            if depth > DEEPEST_M and _may_touch(one.collision, other.collision):
                # The one that is asked for, where both can move.
                swap = one.static or (other.model == only and not other.static)
                mover, still = (other, one) if swap else (one, other)
                found += 1
                yield mover.link, still.link, depth, mover.collision


def _may_touch(one: Collision, other: Collision) -> bool:
    return bool(one.surface.collide_bitmask & other.surface.collide_bitmask)


def _inside(mover: str, still: str, depth: float, collision: Collision) -> Fault:
    length = f"{depth * 1000:.3g} mm" if depth < 0.9995 else f"{depth:.3g} m"
    return Fault("starts-inside", f"{mover!r} starts {length} or more inside {still!r}", collision,
                 Severity.WARNING, "move one of them; they will be pushed apart")
