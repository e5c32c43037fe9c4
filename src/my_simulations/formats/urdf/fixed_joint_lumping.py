"""Fixed joint lumping: merges the child of a fixed joint into its parent.

Source: Gazebo behaviour (sdformat's URDF converter). Clients address the remaining links by name,
so the choice of links and the names of moved elements are part of the interface.
"""
from __future__ import annotations

from typing import List

from ...description.model import WORLD
from ...geometry import compose
from ..combined_inertia import combined_inertia
from ..xml.values import POSE
from .kinematic_tree import LUMP, Body, Connection, parents_first


def lump(root: Body) -> List[str]:
    """Lump every body whose fixed joint is not kept; returns `<frame>` elements at their poses."""
    frames: List[str] = []
    for body in parents_first(root):
        if body.up is not None and is_lumped(body.up):
            parent = body.up.parent
            body.into = lumped_into(parent)
            body.offset = compose(parent.offset, body.up.origin)
            _move(body, body.into)
            frames += _frames(body.up)
    return frames


def is_lumped(connection: Connection) -> bool:
    """True for a fixed joint that is lumped; one to a root called `world` is always kept."""
    parent = connection.parent
    from_world = parent.up is None and parent.link.name == WORLD
    return connection.joint.type == "fixed" and not connection.keep and not from_world


def lumped_into(body: Body) -> Body:
    """The body that `body` was lumped into; `body` itself if it was not."""
    return body.into if body.into is not None else body


def _move(child: Body, into: Body) -> None:
    """Append shapes and add the mass of `child` to those of `into`."""
    for stem, collision in child.collisions:
        collision.pose = compose(child.offset, collision.pose)
        into.collisions.append((LUMP + stem, collision))
    for stem, visual in child.visuals:
        visual.pose = compose(child.offset, visual.pose)
        into.visuals.append((LUMP + stem, visual))
    into.inertial = combined_inertia(into.inertial, child.inertial, child.offset)


def _frames(connection: Connection) -> List[str]:
    from xml.sax.saxutils import quoteattr

    joint, parent = connection.joint.name, connection.parent.link.name
    pose = POSE.format(connection.origin)
    return [
        f"<frame name={quoteattr(joint)} attached_to={quoteattr(parent)}><pose>{pose}</pose>"
        "</frame>",
        f"<frame name={quoteattr(connection.child.link.name)} attached_to={quoteattr(joint)}/>",
    ]
