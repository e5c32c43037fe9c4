"""The contacts of the last step, by link row."""
from __future__ import annotations

from typing import Dict, List, Tuple

import pybullet

from ...geometry import add, scale
from ..commands import Contact
from ..plan import BASE
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
            found.append(Contact(rows[0], rows[1], contact[6], contact[7],
                                 -contact[8], contact[9], add(scale(contact[11], contact[10]),
                                                              scale(contact[13], contact[12]))))
        if len(found) >= limit:
            break
    return tuple(found)
