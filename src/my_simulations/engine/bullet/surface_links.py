"""Collect the data of links for `WheelFriction`: coefficients, slips, axles and mobility."""
from __future__ import annotations

from dataclasses import dataclass
from math import dist
from typing import Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np
import pybullet

from ...description.link_surface import dominant_collision
from ...description.shapes import Cylinder, Surface
from ...geometry import Vec3, add, conjugate, cross, dot, norm, rotate, scale, subtract
from .bodies import Axis, Body, Part
from .contact_points import NORMAL, POINT, ContactPoint, LinkKey
from .contact_slip import direction_across, load_centre
from .edge_loads import Corners, axle_of, corners_of
from .extra_surfaces import first_direction
from .link_states import AT_REST, Motion, read_com_pose
from .mass_matrix import MassMatrix
from .surface_coefficients import is_direction_dependent

_LEAST_MU = 1e-6      # forces are divided by the coefficient
_LEAST_MOMENT = 1e-9  # kg m^2: the arm is divided by the moment of inertia


@dataclass(frozen=True)
class Hinge:
    """The revolute joint of a link.

    Attributes:
        axis: in PyBullet's frame of the link, of length 1.
        pivot: a point on the axis, in that frame, m.
        mobility: of the joint, other joints free, 1/(kg m^2).
    """

    axis: Vec3
    pivot: Vec3
    mobility: float

    def lever(self, moves: Motion, contacts: Sequence[ContactPoint], loads: Sequence[float],
              held: float) -> Optional[Vec3]:
        """Return the velocity along the surface at the loads by the rate of the joint, m.

        None if it is at most `held`, m: a motor holds the joint against the friction.
        """
        centre = load_centre(contacts, loads)
        if dist(centre, moves.position) + norm(self.pivot) <= held:
            return None
        turn = moves.orientation
        arm = subtract(centre, add(moves.position, rotate(turn, self.pivot)))
        moved = cross(rotate(turn, self.axis), arm)
        normal = contacts[0][NORMAL]
        lever = subtract(moved, scale(normal, dot(moved, normal)))
        return None if norm(lever) <= held else lever


@dataclass
class SurfaceLink:
    """A link that can touch something.

    Attributes:
        uid: PyBullet's number of the body that holds it.
        total: mass of its body, kg.
        first: direction of the first coefficients, in PyBullet's frame, of length 1; or None.
        axle: of a wheel (`edge_loads`), or None.
        corners: of a box, m, in PyBullet's frame; empty for other shapes.
        mus, slips: along and across `first`; slips in m/(N s).
        joint: row of its joint; -1 for none.
        hinge: its joint if that is revolute.
    """

    body: Body
    uid: int
    part: Part
    total: float
    first: Optional[Vec3]
    axle: Optional[Vec3]
    corners: Corners
    mus: Tuple[float, float]
    slips: Tuple[float, float]
    joint: int
    hinge: Optional[Hinge]

    @property
    def is_floor(self) -> bool:
        """Whether it is static and has one coefficient."""
        return not self.body.moves and self.mus[0] == self.mus[1] and bool(
            self.part.link.collisions)

    @property
    def radius(self) -> float:
        """Of a wheel, m."""
        shape = self.part.link.collisions[0].geometry
        return shape.radius if isinstance(shape, Cylinder) else 0.0

    def direction(self, moves: Motion, normal: Vec3) -> Optional[Vec3]:
        """Return the direction of the first coefficients, or of an axle, in a contact plane."""
        own = self.first or self.axle
        if own is None:
            return None
        turn = (moves.orientation if moves is not AT_REST
                else read_com_pose(self.uid, self.part.index)[1])
        turned = rotate(turn, own)
        flat = subtract(turned, scale(normal, dot(turned, normal)))
        size = norm(flat)
        return scale(flat, 1.0 / size) if size > 1e-6 else None

    def mobility(self, moves: Motion, contacts: Sequence[ContactPoint]) -> float:
        """Return an upper bound of its acceleration per force at a contact, 1/kg."""
        if not self.body.moves or self.part.mass <= 0.0:
            return 0.0
        arm = max(norm(subtract(contact[POINT], moves.position)) for contact in contacts)
        return 1.0 / self.part.mass + arm * arm / max(_LEAST_MOMENT, min(self.part.moments))


class ContactMobility(NamedTuple):
    """The mobility of a body at a contact, along the surface; its largest values, 1/kg.

    Attributes:
        rigid: as if all joints were locked, where all contacts of the body slip alike: along one
            direction, in which it also tilts, or turning about the normal.
        chain: what the joints between the base and the link of the contact add.
    """

    rigid: float
    chain: float


def contact_mobility(link: SurfaceLink, contact: ContactPoint, holds: Callable[[int, float], bool],
                     ) -> ContactMobility:
    """Return the mobility of a body at a contact of a link in the present configuration.

    Without the joint of the link itself if it is a hinge. `holds` returns whether the motor or
    brake of a joint row, at a distance, m, from the contact, holds against the friction.
    """
    matrix = MassMatrix(link.uid)
    masses, index = matrix.compute(), link.part.index
    at, normal = np.array(contact[POINT]), np.array(contact[NORMAL])
    along = direction_across(contact[NORMAL])
    surface = np.array((along, cross(contact[NORMAL], along)))
    base = 0 if link.body.base is None else 6

    def most(point: np.ndarray, freedoms: List[int]) -> float:
        moved = (surface @ matrix.jacobian(index, point))[:, freedoms]
        inverse = np.linalg.pinv(masses[np.ix_(freedoms, freedoms)])
        return float(np.linalg.eigvalsh(moved @ inverse @ moved.T)[-1])

    rigid = 1.0 / link.total
    if base:
        arm = at - matrix.centre()
        high = normal * (arm @ normal)
        turning = normal @ np.linalg.pinv(masses[:base, :base])[:3, :3] @ normal
        rigid = max(most(at - arm + high, list(range(base))), float(
            turning * ((arm - high) @ (arm - high))))
    moved = matrix.jacobian(index, at)
    free = [place for axis in link.body.axes for place in (matrix.columns.get(axis.index),)
            if place is not None and moved[:, place].any()
            and not (link.hinge is not None and axis.index == index)
            and not holds(axis.row, float(np.linalg.norm(moved[:, place])))]
    if not free:
        return ContactMobility(rigid, 0.0)
    locked = list(range(base))
    return ContactMobility(rigid, max(0.0, most(at, locked + free) - (
        most(at, locked) if locked else 0.0)))


def surface_links(body: Body) -> Dict[LinkKey, SurfaceLink]:
    """Return the links of a body that can touch something, each with the surface that counts."""
    found: Dict[LinkKey, SurfaceLink] = {}
    total = sum(part.mass for part in body.parts)
    joints = {axis.index: axis for axis in body.axes}
    for uid, part in body.surfaces:
        collision = dominant_collision(part.link)
        surface = Surface() if collision is None else collision.surface
        first, slips = None, (surface.slip1, surface.slip1)
        if collision is not None and any(surface.fdir1) and (
                surface.mu != surface.mu2 or surface.slip1 != surface.slip2):
            first, slips = first_direction(collision, part), (surface.slip1, surface.slip2)
        axis = joints.get(part.index)
        mu, mu2 = surface.mu, surface.mu2 if is_direction_dependent(surface) else surface.mu
        found[uid, part.index] = SurfaceLink(
            body, uid, part, total, first, axle_of(part, part.link) if axis is not None else None,
            corners_of(part, part.link), (max(_LEAST_MU, mu), max(_LEAST_MU, mu2)), slips,
            -1 if axis is None else axis.row, None if axis is None else _hinge_of(uid, axis))
    return found


def _hinge_of(uid: int, axis: Axis) -> Optional[Hinge]:
    joint = pybullet.getJointInfo(uid, axis.index)
    if joint[2] != pybullet.JOINT_REVOLUTE:
        return None
    centre, turn = pybullet.getDynamicsInfo(uid, axis.index)[3:5]
    return Hinge(joint[13], rotate(conjugate(turn), scale(centre, -1.0)), axis.mobility)
