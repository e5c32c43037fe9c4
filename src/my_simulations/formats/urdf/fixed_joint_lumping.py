"""Fixed joints of URDF: the child becomes part of the parent, mass and all.

Source: the behaviour of Gazebo's converter. Clients address the links that remain, so which ones
do, and the names of what was moved, are part of the interface.
"""
from __future__ import annotations

from typing import List, Optional, Tuple

from ...description.model import WORLD, Inertial
from ...geometry import Pose, Quat, Vec3, compose, rotate, scale, subtract, transform
from ..xml.values import POSE
from .kinematic_tree import LUMP, Body, Connection, parents_first

Matrix = Tuple[Vec3, Vec3, Vec3]


def lump(root: Body) -> List[str]:
    """Lump every body whose fixed joint is not kept; returns `<frame>`s that mark their places."""
    frames: List[str] = []
    for body in parents_first(root):
        if body.up is not None and is_lumped(body.up):
            parent = body.up.parent
            body.into = standing(parent)
            body.offset = compose(parent.offset, body.up.origin)
            _move(body, body.into)
            frames += _frames(body.up)
    return frames


def is_lumped(connection: Connection) -> bool:
    """True for a fixed joint that goes; one to a root called `world` always stays."""
    parent = connection.parent
    from_world = parent.up is None and parent.link.name == WORLD
    return connection.joint.type == "fixed" and not connection.keep and not from_world


def standing(body: Body) -> Body:
    """The body that `body` has become part of, itself where it stays."""
    return body.into if body.into is not None else body


def _move(child: Body, into: Body) -> None:
    """Shapes and mass of `child`, to the end of those of `into`."""
    for stem, collision in child.collisions:
        collision.pose = compose(child.offset, collision.pose)
        into.collisions.append((LUMP + stem, collision))
    for stem, visual in child.visuals:
        visual.pose = compose(child.offset, visual.pose)
        into.visuals.append((LUMP + stem, visual))
    into.inertial = merged(into.inertial, child.inertial, child.offset)


def _frames(connection: Connection) -> List[str]:
    from xml.sax.saxutils import quoteattr

    joint, parent = connection.joint.name, connection.parent.link.name
    pose = POSE.format(connection.origin)
    return [
        f"<frame name={quoteattr(joint)} attached_to={quoteattr(parent)}><pose>{pose}</pose>"
        "</frame>",
        f"<frame name={quoteattr(connection.child.link.name)} attached_to={quoteattr(joint)}/>",
    ]


def merged(a: Optional[Inertial], b: Optional[Inertial], b_pose: Pose) -> Optional[Inertial]:
    """Two rigidly joined bodies as one, in the frame of `a`.

    Args:
        a: None or mass 0 for no mass.
        b: likewise.
        b_pose: the link frame of `b` in that of `a`.

    Returns:
        the sum, its inertia about the common centre of mass along the axes of `a`'s link frame.
    """
    if b is None or b.mass <= 0:
        return a
    centre_b = transform(b_pose, b.pose.position)
    tensor_b = _turned(_tensor(b), compose(b_pose, b.pose).orientation)
    if a is None or a.mass <= 0:
        return _inertial(b.mass, centre_b, tensor_b)
    mass = a.mass + b.mass
    centre = (
        (a.mass * a.pose.position[0] + b.mass * centre_b[0]) / mass,
        (a.mass * a.pose.position[1] + b.mass * centre_b[1]) / mass,
        (a.mass * a.pose.position[2] + b.mass * centre_b[2]) / mass,
    )
    tensor_a = _turned(_tensor(a), a.pose.orientation)
    total = _sum(
        _shifted(tensor_a, a.mass, subtract(a.pose.position, centre)),
        _shifted(tensor_b, b.mass, subtract(centre_b, centre)),
    )
    return _inertial(mass, centre, total)


def _tensor(i: Inertial) -> Matrix:
    return ((i.ixx, i.ixy, i.ixz), (i.ixy, i.iyy, i.iyz), (i.ixz, i.iyz, i.izz))


def _inertial(mass: float, centre: Vec3, t: Matrix) -> Inertial:
    return Inertial(mass, Pose(centre), t[0][0], t[0][1], t[0][2], t[1][1], t[1][2], t[2][2])


def _turned(t: Matrix, q: Quat) -> Matrix:
    """R t R^T, as R applied to the columns, then to the rows; `t` is symmetric."""
    once = tuple(rotate(q, row) for row in t)
    columns = tuple((once[0][k], once[1][k], once[2][k]) for k in range(3))
    x, y, z = (rotate(q, column) for column in columns)
    return (x, y, z)


def _shifted(t: Matrix, mass: float, d: Vec3) -> Matrix:
    """The tensor about a point that lies -d from the centre of mass (Steiner)."""
    square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
    rows = []
    for k in range(3):
        own = scale(d, -d[k])
        row = [t[k][j] + mass * (own[j] + (square if j == k else 0.0)) for j in range(3)]
        rows.append((row[0], row[1], row[2]))
    return (rows[0], rows[1], rows[2])


def _sum(a: Matrix, b: Matrix) -> Matrix:
    x, y, z = (
        (a[k][0] + b[k][0], a[k][1] + b[k][1], a[k][2] + b[k][2]) for k in range(3)
    )
    return (x, y, z)
