"""Read the contacts of the last step, by link row."""
from __future__ import annotations

from typing import Callable, Dict, List, Optional, Tuple

import pybullet

from ...geometry import Vec3, add, scale
from ..body_plan import BASE
from ..commands import Contact
from .bodies import Body
from .contact_points import (
    BODY,
    DISTANCE,
    LINK,
    LOAD,
    NORMAL,
    OTHER_BODY,
    OTHER_LINK,
    OTHER_PLACE,
    PLACE,
    friction_force,
)


def read_contacts(bodies: Dict[int, Body], limit: int,
                  load: Callable[[int, int, Vec3], Optional[float]],
                  *more_friction: Callable[[int, int, Vec3], Vec3]) -> Tuple[Contact, ...]:
    """Return at most `limit` contacts between registered links; `bodies` by PyBullet's number.

    Each function in `more_friction` returns the friction that this engine adds to Bullet's, N, at
    a point of a link (body number, link index, point). `load` returns the normal force, N, that
    replaces Bullet's, or None. Points of separated surfaces without a load are omitted: Gazebo's
    engines report contacts of overlapping shapes only.
    """
    found: List[Contact] = []
    for contact in pybullet.getContactPoints():
        rows = []
        places = ((contact[BODY], contact[LINK], contact[PLACE]),
                  (contact[OTHER_BODY], contact[OTHER_LINK], contact[OTHER_PLACE]))
        for uid, index, _ in places:
            body = bodies.get(uid)
            rows += [] if body is None else [
                part.row for part in body.colliders
                if part.index == index or (body.rigid and part.index == BASE)][:1]
        if len(rows) == 2:
            # Bullet does not solve points of separated surfaces: their forces are of an older step.
            force = contact[LOAD] if contact[DISTANCE] <= 0.0 else 0.0
            for place in places:
                told = load(*place)
                force = force if told is None else told
            if force <= 0.0 and contact[DISTANCE] > 0.0:
                continue
            friction = friction_force(contact)
            for more in more_friction:
                friction = add(friction, more(*places[0]))
                friction = add(friction, scale(more(*places[1]), -1))
            found.append(Contact(rows[0], rows[1], contact[OTHER_PLACE], contact[NORMAL],
                                 -contact[DISTANCE], force, friction))
        if len(found) >= limit:
            break
    return tuple(found)
