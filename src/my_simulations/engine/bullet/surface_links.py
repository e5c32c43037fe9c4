"""What wheel friction needs of the links of a body: coefficients, slips, axles and mobility."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Dict, Optional, Sequence, Tuple

from ...description.link_surface import dominant_collision
from ...description.shapes import Cylinder, Surface
from ...geometry import Vec3, dot, norm, rotate, scale, subtract
from .bodies import Body, Part
from .contact_points import PLACE, ContactPoint, LinkKey
from .edge_loads import axle_of
from .extra_surfaces import first_direction
from .link_states import AT_REST, Motion, place
from .surface_coefficients import is_direction_dependent

_LEAST_MU = 1e-6
_LEAST_MOMENT = 1e-9  # kg m^2


@dataclass
class SurfaceLink:
    """A link that can touch something.

    Attributes:
        uid: PyBullet's number of the body that holds it.
        total: mass of its body, kg.
        first: direction of the first coefficients, in PyBullet's frame, of length 1; or None.
        axle: of a wheel (`edge_loads`), or None.
        mus, slips: along and across `first`; slips in m/(N s).
        joint: row of its joint; -1 for none.
    """

    body: Body
    uid: int
    part: Part
    total: float
    first: Optional[Vec3]
    axle: Optional[Vec3]
    mus: Tuple[float, float]
    slips: Tuple[float, float]
    joint: int

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
        turn = moves.orientation if moves is not AT_REST else place(self.uid, self.part.index)[1]
        turned = rotate(turn, own)
        flat = subtract(turned, scale(normal, dot(turned, normal)))
        size = norm(flat)
        return scale(flat, 1.0 / size) if size > 1e-6 else None

    def mobility(self, moves: Motion, contacts: Sequence[ContactPoint]) -> float:
        """Return an upper bound of its acceleration per force at a contact, 1/kg."""
        if not self.body.moves or self.part.mass <= 0.0:
            return 0.0
        arm = max(norm(subtract(contact[PLACE], moves.position)) for contact in contacts)
        return 1.0 / self.part.mass + arm * arm / max(_LEAST_MOMENT, min(self.part.moments))


def surface_links(body: Body) -> Dict[LinkKey, SurfaceLink]:
    """Return the links of a body that can touch something, each with the surface that counts."""
    found: Dict[LinkKey, SurfaceLink] = {}
    total = sum(part.mass for part in body.parts)
    joints = {axis.index: axis.row for axis in body.axes}
    for uid, part in body.surfaces:
        collision = dominant_collision(part.link)
        surface = Surface() if collision is None else collision.surface
        first, slips = None, (surface.slip1, surface.slip1)
        if collision is not None and any(surface.fdir1):
            first, slips = first_direction(collision, part), (surface.slip1, surface.slip2)
        joint = joints.get(part.index, -1)
        mu, mu2 = surface.mu, surface.mu2 if is_direction_dependent(surface) else surface.mu
        found[uid, part.index] = SurfaceLink(
            body, uid, part, total, first, axle_of(part, part.link) if joint >= 0 else None,
            (max(_LEAST_MU, mu), max(_LEAST_MU, mu2)), slips, joint)
    return found
