"""Coulomb friction along the line on which a wheel stands.

Bullet finds contacts at the two edges of a wide wheel only (`rims.py`). While a wheel turns about
the floor normal, its edges slide in opposite directions, and the line between them slides less. If
each edge took half of the friction, the outer edge would stick, and a base that turns in place
would do so at v / (b + w / 2); wheels of width w at +-b that load a line turn it at
v / sqrt(b^2 + w^2 / 4). So friction is computed at points of this line. Edges get forces with the
same sum and the same moment. An edge that slides in the direction of the other one needs no points.
"""
from __future__ import annotations

from typing import List, NamedTuple, Optional, Sequence

from ...geometry import Vec3, add, dot, rotate, scale
from .contact_points import NORMAL, POINT, ContactPoint
from .edge_loads import Loads
from .link_states import Motion

_TURNS = 1e-3             # rad/s: the edges of slower wheels slide as one
_NARROW = 4e-3            # m: narrower wheels have one edge
_SHARES = (0.125, 0.375)  # of the width: distances of points from their edge


class WheelEdges(NamedTuple):
    """The edges on which a wheel stands.

    Attributes:
        along: direction of the axle, world axes, times the width, m.
        upper: whether a contact is at the end of `along`.
        slip: of the edges against their middle, m/s, as the wheel turns about the floor normal.
    """

    along: Vec3
    upper: List[bool]
    slip: float

    def points(self, loaded: Loads) -> Loads:
        """Return points on the line between the edges, and the load of each, N."""
        contacts, loads = loaded
        a, b, c = self.along
        points: List[ContactPoint] = []
        for contact, upper in zip(contacts, self.upper):
            (x, y, z), before, after = contact[POINT], contact[:POINT], contact[POINT + 1:]
            for share in _SHARES:
                part = -share if upper else share
                points.append((*before, (x + part * a, y + part * b, z + part * c), *after))
        return points, [load / len(_SHARES) for load in loads for _ in _SHARES]

    def at_contacts(self, forces: Sequence[Vec3]) -> List[Vec3]:
        """Return forces at the contacts with the sum and the moment of forces at the points, N."""
        near, far = _SHARES
        # Forces of an edge's points differ, so each is divided between the edges by its place.
        kept: List[Vec3] = []
        given = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]
        for upper, (a, b, c), (u, v, w) in zip(self.upper, forces[::2], forces[1::2]):
            x, y, z = near * a + far * u, near * b + far * v, near * c + far * w
            kept.append((a + u - x, b + v - y, c + w - z))
            other = given[not upper]
            other[0] += x
            other[1] += y
            other[2] += z
        uppers = sum(self.upper)
        shares = [(x / count, y / count, z / count)
                  for (x, y, z), count in zip(given, (len(kept) - uppers, uppers))]
        return [add(own, shares[upper]) for own, upper in zip(kept, self.upper)]


def wheel_edges(axle: Optional[Vec3], moves: Motion, contacts: Sequence[ContactPoint],
                ) -> Optional[WheelEdges]:
    """Return the edges on which a turning wheel stands.

    None for a link without an axle, on one edge, or that does not turn about the floor normal.
    """
    if axle is None or len(contacts) < 2:
        return None
    spin = abs(dot(moves.angular, contacts[0][NORMAL]))
    if spin < _TURNS:
        return None
    along = rotate(moves.orientation, axle)
    places = [dot(contact[POINT], along) for contact in contacts]
    low, high = min(places), max(places)
    if high - low < _NARROW:
        return None
    middle = (low + high) / 2.0
    return WheelEdges(scale(along, high - low), [place > middle for place in places],
                      spin * (high - low) / 2.0)
