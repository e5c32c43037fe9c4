"""The contacts of the last step, by link row."""
from __future__ import annotations

from typing import Dict, List, Tuple

import pybullet

from ...geometry import add, scale
from ..body_plan import BASE
from ..commands import Contact
from .bodies import Body


def read_contacts(bodies: Dict[int, Body], limit: int) -> Tuple[Contact, ...]:
    """At most `limit` contacts between known links; `bodies` by PyBullet's number."""
    found: List[Contact] = []
    for contact in pybullet.getContactPoints():
        rows = []
        for uid, index in ((contact[1], contact[3]), (contact[2], contact[4])):
            body = bodies.get(uid)
            rows += [] if body is None else [
                part.row for part in body.parts
                if part.index == index or (body.rigid and part.index == BASE)][:1]
        if len(rows) == 2:
            # Bullet does not solve points that are apart: what they tell is of an older step.
            friction = add(scale(contact[11], contact[10]), scale(contact[13], contact[12]))
            force, friction = ((contact[9], friction) if contact[8] <= 0.0
                               else (0.0, (0.0, 0.0, 0.0)))
            found.append(Contact(rows[0], rows[1], contact[6], contact[7], -contact[8], force,
                                 friction))
        if len(found) >= limit:
            break
    return tuple(found)
