"""Compute the coefficients to store in PyBullet, so that pairs match Gazebo.

PyBullet multiplies the coefficients of the two surfaces; Gazebo takes the smaller one. With these
values, pairs of moving surfaces with mu 1 (the default) and static ones are exact;
`pair_coefficients` corrects the others.
"""
from __future__ import annotations

from ...description.link_surface import dominant_collision
from ...description.link_surface import friction_coefficient as friction_coefficient
from ...description.link_surface import is_direction_dependent as is_direction_dependent
from ...description.model import Link
from ...description.shapes import Surface

NEVER_BOUNCES = 1e4
"""A bounce threshold from here on (SDF's default is 100000 m/s) means no restitution."""


def of_link(link: Link) -> Surface:
    """Return the surface of a link; PyBullet has one per link (see `dominant_collision`)."""
    found = dominant_collision(link)
    return Surface() if found is None else found.surface


def friction(surface: Surface, static: bool) -> float:
    """Return the lateral friction to store."""
    return min(friction_coefficient(surface), 1.0) if static else friction_coefficient(surface)


def restitution(surface: Surface) -> float:
    """The restitution of a surface by itself: 0 unless it can reach its threshold.

    `PairRestitution` adjusts it to the other surfaces of the world.
    """
    return surface.restitution if surface.bounce_threshold < NEVER_BOUNCES else 0.0
