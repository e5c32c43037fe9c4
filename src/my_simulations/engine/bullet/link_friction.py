"""The friction on a link by another one: Coulomb's law, with slip, and with a joint that yields.

At the slip velocity v it is

    F = -v / (s + h) + B,  at most mu N,

with the slip s, and h such that the force ends the velocity within a few steps. If no motor holds
the joint of the link, h is a tensor that includes the mobility of the joint, and the velocity that
the effort on the joint causes in the step is added to v. So the friction on light wheels is stable,
also under loops that are unstable in the air. B takes up what the other forces on the body are: it
grows by a share of the force -(v + s F) / (s + h) until v = -s F. Without slip that holds a wheel
on a slope. At the limit only the part of B remains with which F reaches it. If mu applies along a
direction and mu2 across it, M is the tensor of both, and the limit is |M^-1 F| = N. A fast wheel
then meets -N M (M v) / |M v|: of all forces within this ellipse, the one that dissipates the most
power.
"""
from __future__ import annotations

from math import hypot
from typing import List, NamedTuple, Optional, Tuple

from ...geometry import Vec3, cross, dot, norm, scale
from .contact_points import NORMAL
from .contact_slip import (
    STIFF,
    direction_across,
    isotropic,
    limited,
    mean_slip,
    mean_velocity,
    remaining_share,
    slips_along,
    yielding,
    yielding_along,
)
from .edge_loads import Loads
from .link_states import AT_REST, Motion, motion
from .surface_links import ContactMobility, SurfaceLink
from .wheel_edges import wheel_edges

_SOFT = 1.5          # steps of braking: a slip that would end sooner is reduced in proportion
_GROWS = 1.0 / 16.0  # share of the missing force by which B grows in a step


class Drive(NamedTuple):
    """What acts on a link in a step besides contacts.

    Attributes:
        effort: of loops, dampers and commands on its joint, N m.
        held: with which a motor or brake holds the rate of its joint, N m.
        mobility: of its body at the contacts, without that joint; None for a rigid body, and on
            a body that moves.
    """

    effort: float
    held: float
    mobility: Optional[ContactMobility]


class LinkFriction(NamedTuple):
    """Friction on a link.

    Attributes:
        forces: at each contact, N, world axes.
        bias: the new B, N, world axes.
        slip: mean, m/s; of the edges of a wheel against their middle if that is more.
        ended: slip that Coulomb's limit ends until the next computation, m/s.
    """

    forces: List[Vec3]
    bias: Vec3
    slip: float
    ended: float


class _Law(NamedTuple):
    """Coefficients along and across the first direction.

    Attributes:
        mus: friction.
        slow: slip, m/(N s).
        soft: the same and the slip per force that friction ends.
    """

    mus: Tuple[float, float]
    slow: Tuple[float, float]
    soft: Tuple[float, float]


def link_friction(one: SurfaceLink, two: SurfaceLink, mine: Motion, loaded: Loads, bias: Vec3,
                  drive: Drive, dt: float, weight: float) -> LinkFriction:
    """Return the friction on the first of two links.

    Args:
        one: the link.
        two: the other one.
        mine: motion of the first one.
        loaded: its contacts with the second one, and their loads, N.
        bias: B, N, world axes.
        drive: what acts on the joint of the first one.
        dt: until the next computation, s.
        weight: gravity, m/s^2.
    """
    edges = None if two.body.moves else wheel_edges(one.axle, mine, loaded[0])
    if edges is None or edges.slip <= norm(mean_velocity(mine, *loaded)):
        return _at_points(one, two, mine, loaded, bias, drive, dt, weight)
    found = _at_points(one, two, mine, edges.points(loaded), bias, drive, dt, weight)
    return found._replace(forces=edges.at_contacts(found.forces), slip=edges.slip)


def _at_points(one: SurfaceLink, two: SurfaceLink, mine: Motion, loaded: Loads, bias: Vec3,
               drive: Drive, dt: float, weight: float) -> LinkFriction:
    """Return the friction at given points; arguments as for `link_friction`."""
    contacts, loads = loaded
    theirs = motion(two.uid, two.part.index) if two.body.moves else AT_REST
    mus = min(one.mus[0], two.mus[0]), min(one.mus[1], two.mus[1])
    slow = one.slips[0] + two.slips[0], one.slips[1] + two.slips[1]
    end = _end(one, two, mine, theirs, loaded, drive.mobility, dt, weight)
    lever = None if one.hinge is None or two.body.moves else one.hinge.lever(
        mine, contacts, loads, drive.held / (min(mus) * sum(loads)))
    rate_gain = 0.0 if one.hinge is None else _SOFT * dt * one.hinge.mobility
    if mus[0] == mus[1] and not any(slow) and theirs is AT_REST:
        yields = STIFF if lever is None else yielding(
            lever, rate_gain, drive.effort, mean_velocity(mine, contacts, loads), end)
        forces, slip, bias = isotropic(contacts, loads, mine, bias, mus[0], end, yields, _GROWS)
        return LinkFriction(forces, bias, slip, end * mus[0] * sum(loads))
    ends = end, end
    if mus[0] != mus[1] and not any(slow):   # friction is along M (M v), also where it is least
        most = max(mus)
        ends = end * (most / mus[0]) ** 2, end * (most / mus[1]) ** 2
    law = _Law(mus, slow, (slow[0] + ends[0], slow[1] + ends[1]))
    normal = contacts[0][NORMAL]
    along = one.direction(mine, normal) or two.direction(theirs, normal) or (
        direction_across(normal))
    axes = along, cross(normal, along)
    slips = slips_along(contacts, axes, mine, theirs)
    given, spared, whole = (0.0, 0.0), (0.0, 0.0), law.soft
    if lever is not None:
        arms = dot(lever, axes[0]), dot(lever, axes[1])
        given, spared = yielding_along(arms, rate_gain, drive.effort, mean_slip(slips, loads),
                                       law.soft)
        whole = (law.soft[0] + rate_gain * arms[0] ** 2, law.soft[1] + rate_gain * arms[1] ** 2)
    return _along_axes(axes, slips, loads, bias, law, given, spared, whole)


def _along_axes(axes: Tuple[Vec3, Vec3], slips: List[Tuple[float, float]], loads: List[float],
                bias: Vec3, law: _Law, given: Tuple[float, float], spared: Tuple[float, float],
                whole: Tuple[float, float]) -> LinkFriction:
    """Return the friction for slips along two axes.

    `given`, `spared`: see `Yielding`; `whole`: slip per force, with that of the joint, m/(N s).
    """
    mus, slow, soft = law
    holds = dot(bias, axes[0]), dot(bias, axes[1])
    slip, carried = mean_slip(slips, loads), sum(loads)
    forces, total, within = [], (0.0, 0.0), False
    for velocity, load in zip(slips, loads):
        share = load / carried
        wanted = (share * (holds[0] + given[0] - velocity[0] / soft[0]),
                  share * (holds[1] + given[1] - velocity[1] / soft[1]))
        parts = limited(wanted, mus, whole, load)
        within = within or parts is wanted
        forces.append(_combined(axes, parts))
        total = total[0] + parts[0], total[1] + parts[1]
    if within:
        bias = _combined(axes, limited(
            (holds[0] - _GROWS * ((slip[0] + slow[0] * total[0]) / soft[0] - spared[0]),
             holds[1] - _GROWS * ((slip[1] + slow[1] * total[1]) / soft[1] - spared[1])),
            mus, soft, carried))
    else:
        bias = _combined(axes, holds)
        bias = scale(bias, remaining_share(
            (holds[0] / mus[0], holds[1] / mus[1], 0.0),
            ((given[0] - slip[0] / soft[0]) / mus[0], (given[1] - slip[1] / soft[1]) / mus[1], 0.0),
            carried))
    return LinkFriction(forces, bias, hypot(*slip),
                        max(soft[0] * mus[0], soft[1] * mus[1]) * carried)


def _end(one: SurfaceLink, two: SurfaceLink, mine: Motion, theirs: Motion, loaded: Loads,
         mobility: Optional[ContactMobility], dt: float, weight: float) -> float:
    """Return the slip velocity per force, m/(N s), that friction ends; without the joint.

    A body on wheels moves as a rigid body of which the wheel bears its load; the mobility of the
    wheel alone is much larger.
    """
    contacts, loads = loaded
    if mobility is None:
        return dt * (one.mobility(mine, contacts) + two.mobility(theirs, contacts))
    rigid = max(_SOFT / one.total, mobility.rigid)
    return dt * (rigid * max(1.0, weight * one.total / sum(loads)) + _SOFT * mobility.chain)


def _combined(axes: Tuple[Vec3, Vec3], parts: Tuple[float, float]) -> Vec3:
    (a, b, c), (u, v, w) = axes
    x, y = parts
    return x * a + y * u, x * b + y * v, x * c + y * w
