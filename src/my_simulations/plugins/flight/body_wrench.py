"""Wrenches that plugins give in the axes of a link."""
from __future__ import annotations

from typing import Tuple

from ...engine.wrench_laws import BodyWrench, Wrench
from ...geometry import Vec3, add, conjugate, cross, rotate
from ..context import Context, Link

NO_WRENCH: Wrench = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


def push_at_origin(context: Context, link: Link, wrench: Wrench) -> None:
    """Apply a wrench at the origin of a link, given in its present axes, which then stand still."""
    com = link.inertial.pose.position
    context.set_wrench(link.name, *BodyWrench(*wrench).wrench(link.pose, link.twist, com))


def hold_wrench(context: Context, link: Link, wrench: Wrench) -> None:
    """Apply a wrench at the origin of a link from now on; it turns with the link."""
    if wrench == NO_WRENCH:
        context.set_wrench(link.name, *wrench)   # without a law that keeps the link awake
    else:
        context.set_wrench_law(link.name, BodyWrench(*wrench))


def wrench_at_mass_centre(link: Link, force: Vec3, torque: Vec3) -> Wrench:
    """Convert a wrench at the centre of mass of a link to one at its origin, in its axes.

    Gazebo's `Link::AddRelativeForce` acts at the centre of mass.
    """
    return force, add(torque, cross(link.inertial.pose.position, force))


def body_twist(link: Link) -> Tuple[Vec3, Vec3]:
    """Linear and angular velocity of a link at its origin, in its axes, m/s and rad/s."""
    back, twist = conjugate(link.pose.orientation), link.twist
    return rotate(back, twist.linear), rotate(back, twist.angular)
