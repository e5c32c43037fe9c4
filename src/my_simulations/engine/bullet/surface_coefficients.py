"""What PyBullet stores for a surface so that pairs come out as Gazebo's.

PyBullet multiplies the coefficients of the two surfaces; Gazebo takes the smaller one. As stored
here, pairs of moving surfaces with mu 1 (the default) and static ones are exact; `friction` mends
the others.
"""
from __future__ import annotations

from ...description.model import Link
from ...description.shapes import Surface

NEVER_BOUNCES = 1e4
"""A bounce threshold from here on (SDF's default is 100000 m/s) means no restitution."""


def of_link(link: Link) -> Surface:
    """The surface of a link: PyBullet knows one a link; the first collision's is taken."""
    return link.collisions[0].surface if link.collisions else Surface()


def coefficient(surface: Surface) -> float:
    """The coefficient that counts in pairs: the larger one where both have a direction."""
    return max(surface.mu, surface.mu2) if directed(surface) else surface.mu


def friction(surface: Surface, static: bool) -> float:
    """The lateral friction to store."""
    return min(coefficient(surface), 1.0) if static else coefficient(surface)


def restitution(surface: Surface) -> float:
    """The restitution to store: 0 unless the surface can reach its threshold."""
    return surface.restitution if surface.bounce_threshold < NEVER_BOUNCES else 0.0


def directed(surface: Surface) -> bool:
    """Whether mu and mu2 differ by direction; without fdir1 mu holds in all of them."""
    return surface.mu != surface.mu2 and any(surface.fdir1)
