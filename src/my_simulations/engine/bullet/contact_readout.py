"""Read the contacts of the last step, by link row."""
from __future__ import annotations

from typing import Dict, List, Tuple

import pybullet

from ...geometry import add, scale
from ..body_plan import BASE
from ..commands import Contact
from .bodies import Body
from .contact_points import friction_force
from .edge_loads import NEAR
from .wheel_friction import WheelFriction

_MOST_CONTACTS = 2000


def read_contacts(bodies: Dict[int, Body], wheel_friction: WheelFriction) -> Tuple[Contact, ...]:
    """Return contacts between registered links; `bodies` by PyBullet's number.

    Friction and loads of `wheel_friction` replace Bullet's. Points of separated surfaces without a
    load are omitted: Gazebo's engines report contacts of overlapping shapes only.
    """
    found: List[Contact] = []
    for contact in pybullet.getContactPoints():
        rows = []
        _, one, other, link, other_link, point, other_point, normal, distance, load = contact[:10]
        places = ((one, link, point), (other, other_link, other_point))
        for uid, index, _ in places:
            body = bodies.get(uid)
            rows += [] if body is None else [
                part.row for part in body.colliders
                if part.index == index or (body.rigid and part.index == BASE)][:1]
        if len(rows) == 2:
            # Bullet does not solve points of separated surfaces: their forces are of an older step.
            force = load if distance <= 0.0 else 0.0
            acting = [wheel_friction.acting_at(*mine, (theirs[0], theirs[1]))
                      if distance < NEAR else None
                      for mine, theirs in zip(places, reversed(places))]
            force = next((each.load for each in acting if each is not None), force)
            if force <= 0.0 and distance > 0.0:
                continue
            friction = friction_force(contact)
            for each, sign in zip(acting, (1.0, -1.0)):
                friction = friction if each is None else add(friction, scale(each.force, sign))
            found.append(Contact(rows[0], rows[1], other_point, normal, -distance, force, friction))
        if len(found) >= _MOST_CONTACTS:
            break
    return tuple(found)
