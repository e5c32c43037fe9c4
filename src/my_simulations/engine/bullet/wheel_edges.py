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
        points: List[ContactPoint] = []
        for contact, upper in zip(contacts, self.upper):
            for share in _SHARES:
                place = add(contact[POINT], scale(self.along, -share if upper else share))
                points.append((*contact[:POINT], place, *contact[POINT + 1:]))
        return points, [load / len(_SHARES) for load in loads for _ in _SHARES]

    def at_contacts(self, forces: Sequence[Vec3]) -> List[Vec3]:
        """Return forces at the contacts with the sum and the moment of forces at the points, N."""
        count = len(_SHARES)
        # Forces of an edge's points differ, so each is divided between the edges by its place.
        kept: List[Vec3] = []
        given = {True: (0.0, 0.0, 0.0), False: (0.0, 0.0, 0.0)}
        for n, upper in enumerate(self.upper):
            own = (0.0, 0.0, 0.0)
            for share, force in zip(_SHARES, forces[count * n:count * (n + 1)]):
                own = add(own, scale(force, 1.0 - share))
                given[not upper] = add(given[not upper], scale(force, share))
            kept.append(own)
        return [add(own, scale(given[upper], 1.0 / self.upper.count(upper)))
                for own, upper in zip(kept, self.upper)]


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
