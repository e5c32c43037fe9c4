"""Set surface properties in PyBullet besides one friction coefficient and restitution."""
from __future__ import annotations

import math
from typing import Any, Dict, Tuple

import pybullet

from ...description.link_surface import dominant_collision
from ...description.model import Link
from ...description.shapes import Collision
from ...geometry import Vec3, conjugate, norm, rotate, scale
from ..surface_pieces import by_friction
from .bodies import Body, Part
from .surface_coefficients import is_direction_dependent

SOFT = 1e6
"""N/m; a stiffer contact is a hard one: 1 kg goes less than 0.01 mm deep."""

_PUSHED_OUT = 5.0      # 1/s: overlaps of damped contacts shrink at this rate, as those of hard ones
_DEEP = 0.002          # m: an overlap of this depth parts at max_vel
_LEAST_SHARE = 1e-3    # of the larger coefficient, along the slippery direction
_TORSION = 3.0 * math.pi / 16.0
_ROLLING = 1e-9        # m: Bullet ignores torsional friction if rolling friction is 0
_VISIBLE = 2e-4        # m: contacts of a body that sinks in less by its weight count as hard
_WEIGHT = 9.8          # N/kg: gravity at which `_VISIBLE` is checked


def store(body: Body, dt: float) -> None:
    """Set direction-dependent, compliant and torsional contacts of the links of a body.

    These are mu2 and fdir1; kp, kd and max_vel; surface/friction/torsional (SDF 1.7). PyBullet has
    one surface per link, that of the `dominant_collision`. `dt`: step size, s.
    """
    for uid, part in body.surfaces:
        collision = dominant_collision(part.link)
        if collision is None:
            continue
        surface = collision.surface
        settings: Dict[str, Any] = {}
        if is_direction_dependent(surface):
            settings["anisotropicFriction"] = anisotropy(
                (surface.mu, surface.mu2), first_direction(collision, part))
        if surface.kp < SOFT and body.moves and not body.rigid:
            # kd, N s/m, or what keeps an overlap from springing out faster than max_vel.
            rate = max(_PUSHED_OUT, surface.max_vel / _DEEP)
            settings["contactStiffness"] = max(surface.kp, 1e-9)
            settings["contactDamping"] = max(surface.kd, surface.kp * (1.0 / rate - dt), 1e-9)
        if surface.torsion > 0.0 and surface.use_patch_radius and surface.patch_radius > 0.0:
            # Gazebo's limit: 3 pi / 16 times radius, coefficient and normal force.
            settings["spinningFriction"] = _TORSION * surface.patch_radius * surface.torsion
            settings["rollingFriction"] = _ROLLING
        if settings:
            pybullet.changeDynamics(uid, part.index, **settings)


def is_soft(link: Link) -> bool:
    """Whether a link without joints rests visibly deep in a soft contact.

    It must be an articulated body: contacts of rigid bodies part overlaps without forces
    (`contact_settling`), so they cannot be springs.
    """
    return any(link.collisions[group[0]].surface.kp * _VISIBLE < _WEIGHT * link.inertial.mass
               for group in by_friction(link))


def first_direction(collision: Collision, part: Part) -> Vec3:
    """Return the direction in which mu acts (fdir1), of length 1, in PyBullet's frame."""
    inward = rotate(conjugate(part.link_from_com.orientation),
                    rotate(collision.pose.orientation, collision.surface.fdir1))
    return scale(inward, 1.0 / norm(inward))


def anisotropy(mus: Tuple[float, float], first: Vec3, left: Tuple[float, float] = (1.0, 1.0),
               ) -> Vec3:
    """PyBullet's anisotropicFriction for coefficients along and across a direction of length 1.

    `left` are shares of them that count. Exact where the direction is one of PyBullet's axes; else
    the diagonal of the tensor.
    """
    most = max(mus)
    along, across = (share * (max(mu / most, _LEAST_SHARE) if most > 0.0 else 1.0)
                     for mu, share in zip(mus, left))
    x, y, z = (across + (along - across) * value ** 2 for value in first)
    return (x, y, z)
