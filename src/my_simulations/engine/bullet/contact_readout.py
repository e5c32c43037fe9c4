"""Read the contacts of the last step, by link row."""
from __future__ import annotations

from math import dist
from typing import Dict, List, Sequence, Tuple

import pybullet

from ...geometry import ZERO3, Vec3, add, scale
from ..body_plan import BASE
from ..commands import Contact
from .bodies import Body
from .contact_points import (
    BODY,
    DISTANCE,
    LINK,
    OTHER_BODY,
    OTHER_LINK,
    OTHER_POINT,
    POINT,
    ContactPoint,
    LinkKey,
    friction_force,
)
from .edge_loads import NEAR
from .wheel_friction import WheelFriction

_MOST_CONTACTS = 2000


def read_contacts(bodies: Dict[int, Body], wheel_friction: WheelFriction) -> Tuple[Contact, ...]:
    """Return contacts between registered links; `bodies` by PyBullet's number.

    Friction and loads of `wheel_friction` replace Bullet's. Points of separated surfaces without a
    load are omitted: Gazebo's engines report contacts of overlapping shapes only.
    """
    contacts = pybullet.getContactPoints()
    acting = _acting_friction(contacts, wheel_friction)
    found: List[Contact] = []
    for n, contact in enumerate(contacts):
        rows = []
        _, one, other, link, other_link, _, other_point, normal, distance, load = contact[:10]
        for uid, index in ((one, link), (other, other_link)):
            body = bodies.get(uid)
            rows += [] if body is None else [
                part.row for part in body.colliders
                if part.index == index or (body.rigid and part.index == BASE)][:1]
        if len(rows) == 2:
            # Bullet does not solve points of separated surfaces: their forces are of an older step.
            force, friction = acting.get(n, (load if distance <= 0.0 else 0.0, ZERO3))
            if force <= 0.0 and distance > 0.0:
                continue
            found.append(Contact(rows[0], rows[1], other_point, normal, -distance, force,
                                 add(friction_force(contact), friction)))
        if len(found) >= _MOST_CONTACTS:
            break
    return tuple(found)


def _acting_friction(contacts: Sequence[ContactPoint], wheel_friction: WheelFriction,
                     ) -> Dict[int, Tuple[float, Vec3]]:
    """Return load, N, and friction on the first link, N, of the contacts of sliding wheels.

    By place in `contacts`; each contact has what acts nearer to it than to the other ones of its
    links.
    """
    acting = list(wheel_friction.acting())
    if not acting:
        return {}
    pairs: Dict[Tuple[LinkKey, LinkKey], List[int]] = {}
    for n, contact in enumerate(contacts):
        if contact[DISTANCE] < NEAR:
            pairs.setdefault(((contact[BODY], contact[LINK]),
                              (contact[OTHER_BODY], contact[OTHER_LINK])), []).append(n)
    found: Dict[int, Tuple[float, Vec3]] = {}
    for key, friction in acting:
        for pair, side, sign in (((key, friction.other), POINT, 1.0),
                                 ((friction.other, key), OTHER_POINT, -1.0)):
            places = pairs.get(pair, ())
            found.update((n, (0.0, ZERO3)) for n in places if n not in found)
            if places:
                n = min(places, key=lambda n: dist(contacts[n][side], friction.at))
                load, force = found[n]
                found[n] = load + friction.load, add(force, scale(friction.force, sign))
    return found
