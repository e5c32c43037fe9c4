"""Read the motion and the contact loads of links whose friction `WheelFriction` computes."""
from __future__ import annotations

from typing import AbstractSet, Dict, List, Mapping, Tuple

import pybullet

from ..body_plan import BASE
from .contact_points import LINK, OTHER_BODY, OTHER_LINK, ContactPoint, LinkKey
from .edge_loads import Loads, distribute_loads, loaded_contacts
from .link_states import AT_REST, Motion, motion, motions
from .surface_links import SurfaceLink

Reading = Tuple[Motion, Loads]
"""Motion of a link, its contacts, and their loads, N."""


def read_loads(uid: int, links: Mapping[int, SurfaceLink], slipping: AbstractSet[LinkKey],
               ) -> Dict[int, Reading]:
    """Return the readings of links of a body, by PyBullet's index.

    Links without slip share their loads as equally stiff edges do. The motion of a link that
    touches nothing is not read.
    """
    touching: Dict[int, List[ContactPoint]] = {}
    for contact in pybullet.getContactPoints(bodyA=uid):
        if contact[LINK] in links:
            touching.setdefault(contact[LINK], []).append(contact)
    children = [index for index in touching if index != BASE]
    moves = dict(zip(children, motions(uid, children)))
    if BASE in touching:
        moves[BASE] = motion(uid, BASE)
    found: Dict[int, Reading] = {index: (AT_REST, ([], [])) for index in links}
    sharing = [index for index in links if (uid, index) not in slipping]
    sharing = [index for index in sharing if index in touching] if len(sharing) > 1 else []
    found.update((index, (moves[index], loaded_contacts(contacts)))
                 for index, contacts in touching.items() if index not in sharing)
    loads = distribute_loads([(moves[index], links[index].axle, links[index].corners,
                               touching[index]) for index in sharing])
    for index, each in zip(sharing, loads):
        found[index] = moves[index], each
    return found


def with_other(other: LinkKey, contacts: List[ContactPoint], loads: List[float]) -> Loads:
    """Return the contacts with one other link, and their loads."""
    found = [(contact, load) for contact, load in zip(contacts, loads)
             if (contact[OTHER_BODY], contact[OTHER_LINK]) == other]
    return [contact for contact, _ in found], [load for _, load in found]
