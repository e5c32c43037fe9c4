"""Compute the slip at contact points, and the friction that Coulomb's law allows."""
from __future__ import annotations

from math import hypot
from typing import List, Sequence, Tuple

from ...geometry import Vec3, dot, norm, scale, subtract
from .contact_points import NORMAL, PLACE, ContactPoint
from .link_states import AT_REST, Motion

_MOST_ROUNDS = 20
_EXACT = 1e-6


def slips_at(contacts: Sequence[ContactPoint], mine: Motion, theirs: Motion) -> List[Vec3]:
    """Return the velocity of a link along the surface of another one at each contact, m/s."""
    found = []
    for contact in contacts:
        at, normal = contact[PLACE], contact[NORMAL]
        velocity = mine.velocity_at(at)
        if theirs is not AT_REST:
            velocity = subtract(velocity, theirs.velocity_at(at))
        found.append(subtract(velocity, scale(normal, dot(velocity, normal))))
    return found


def mean_slip(slips: Sequence[Vec3], loads: Sequence[float]) -> Vec3:
    """Return the mean weighted by load: in a curve a wheel rolls on its loaded edge."""
    x = y = z = total = 0.0
    for (u, v, w), load in zip(slips, loads):
        x, y, z, total = x + load * u, y + load * v, z + load * w, total + load
    return x / total, y / total, z / total


def direction_across(normal: Vec3) -> Vec3:
    """Return some direction perpendicular to a normal, of length 1."""
    x, y, z = normal
    found = (0.0, -z, y) if abs(z) > 0.7 else (-y, x, 0.0)
    return scale(found, 1.0 / norm(found))


def limited(wanted: Tuple[float, float], mus: Tuple[float, float], soft: Tuple[float, float],
            load: float) -> Tuple[float, float]:
    """Return the friction nearest to a wanted one, N, with |M^-1 F| at most the load.

    M is the tensor of the coefficients `mus` in two directions. Nearest is what leaves the least
    slip; a missing force leaves `soft` times as much, m/(N s).
    """
    if hypot(wanted[0] / mus[0], wanted[1] / mus[1]) <= load:
        return wanted
    u, v = soft[0] * mus[0] ** 2, soft[1] * mus[1] ** 2
    a, b = u * wanted[0] / mus[0], v * wanted[1] / mus[1]
    # The size of (a / (u + x), b / (v + x)) is the load at one x > 0: Newton's method for 1 / size.
    x, size = 0.0, hypot(a / u, b / v)
    for _ in range(_MOST_ROUNDS):
        slope = (a * a / (u + x) ** 3 + b * b / (v + x) ** 3) / size ** 2
        x += (size / load - 1.0) / slope
        size = hypot(a / (u + x), b / (v + x))
        if abs(size - load) < _EXACT * load:
            break
    left = load / size
    return left * a / (u + x) * mus[0], left * b / (v + x) * mus[1]
