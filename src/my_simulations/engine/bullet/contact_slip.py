"""Compute the slip at contact points, and the friction that Coulomb's law allows."""
from __future__ import annotations

from math import hypot, sqrt
from typing import List, NamedTuple, Sequence, Tuple

from ...geometry import Vec3, dot, scale, subtract
from .contact_points import NORMAL, POINT, ContactPoint
from .link_states import AT_REST, Motion

_MOST_ROUNDS = 20
_EXACT = 1e-6


def slips_along(contacts: Sequence[ContactPoint], axes: Tuple[Vec3, Vec3], mine: Motion,
                theirs: Motion) -> List[Tuple[float, float]]:
    """Return the velocity of a link against another one at each contact, m/s, along two axes."""
    centre, _, (u, v, w), (p, q, r) = mine
    (a, b, c), (d, e, f) = axes
    found = []
    for contact in contacts:
        x, y, z = contact[POINT]
        if theirs is not AT_REST:
            i, j, k = subtract((0.0, 0.0, 0.0), theirs.velocity_at((x, y, z)))
        else:
            i = j = k = 0.0
        x, y, z = x - centre[0], y - centre[1], z - centre[2]
        i, j, k = i + u + q * z - r * y, j + v + r * x - p * z, k + w + p * y - q * x
        found.append((i * a + j * b + k * c, i * d + j * e + k * f))
    return found


def mean_slip(slips: Sequence[Tuple[float, float]], loads: Sequence[float]) -> Tuple[float, float]:
    """Return the mean weighted by load: in a curve a wheel rolls on its loaded edge."""
    x = y = total = 0.0
    for (u, v), load in zip(slips, loads):
        x, y, total = x + load * u, y + load * v, total + load
    return x / total, y / total


def direction_across(normal: Vec3) -> Vec3:
    """Return some direction perpendicular to a normal, of length 1."""
    x, y, z = normal
    size = hypot(y, z) if abs(z) > 0.7 else hypot(x, y)
    return (0.0, -z / size, y / size) if abs(z) > 0.7 else (-y / size, x / size, 0.0)


def limited(wanted: Tuple[float, float], mus: Tuple[float, float], soft: Tuple[float, float],
            load: float) -> Tuple[float, float]:
    """Return the friction nearest to a wanted one, N, with |M^-1 F| at most the load.

    M is the tensor of the coefficients `mus` in two directions. Nearest is what leaves the least
    slip; a missing force leaves `soft` times as much, m/(N s).
    """
    if hypot(wanted[0] / mus[0], wanted[1] / mus[1]) <= load:
        return wanted
    u, v = soft[0] * mus[0] ** 2, soft[1] * mus[1] ** 2
    a, b = u * wanted[0] / mus[0], v * wanted[1] / mus[1]
    # The size of (a / (u + x), b / (v + x)) is the load at one x > 0: Newton's method for 1 / size.
    x, size = 0.0, hypot(a / u, b / v)
    for _ in range(_MOST_ROUNDS):
        slope = (a * a / (u + x) ** 3 + b * b / (v + x) ** 3) / size ** 2
        x += (size / load - 1.0) / slope
        size = hypot(a / (u + x), b / (v + x))
        if abs(size - load) < _EXACT * load:
            break
    left = load / size
    return left * a / (u + x) * mus[0], left * b / (v + x) * mus[1]


def mean_velocity(moves: Motion, contacts: Sequence[ContactPoint], loads: Sequence[float]) -> Vec3:
    """Return the velocity of a link along the surface at the centre of its loads, m/s."""
    velocity = moves.velocity_at(load_centre(contacts, loads))
    normal = contacts[0][NORMAL]
    return subtract(velocity, scale(normal, dot(velocity, normal)))


def load_centre(contacts: Sequence[ContactPoint], loads: Sequence[float]) -> Vec3:
    """Return the mean of contact points weighted by load, m; world axes."""
    if len(loads) == 1:
        return contacts[0][POINT]
    x = y = z = 0.0
    for contact, load in zip(contacts, loads):
        i, j, k = contact[POINT]
        x, y, z = x + load * i, y + load * j, z + load * k
    total = sum(loads)
    return x / total, y / total, z / total


class Yielding(NamedTuple):
    """How the joint of a link changes the friction that ends its mean slip; N, world axes.

    Friction -D v, with D the inverse of what other parts yield, would overshoot if the joint yields
    too. So the mean slip v meets -(D - E) v, and the effort t on the joint, which would make it
    slip in the step, is compensated.

    Attributes:
        total: the added friction: E v less the friction against the effort.
        spared: E v.
        direction: of the lever, length 1.
        extra: slip per force along it by the joint, as a share of that by the other parts.
    """

    total: Vec3
    spared: Vec3
    direction: Vec3
    extra: float


STIFF = Yielding((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0)
"""Of a link whose joint does not yield."""


def yielding(lever: Vec3, rate_gain: float, effort: float, slip: Vec3, end: float) -> Yielding:
    """Return the change for a joint and other parts that yield alike in both directions.

    The joint yields by g u u^T, with the lever u and g = `rate_gain`. With D = 1 / end, by Sherman
    and Morrison, E = g D u u^T D / (1 + g u^T D u).

    Args:
        lever: velocity of the contact by the rate of the joint, m.
        rate_gain: change of the rate in the step per torque on the joint, rad/(N m s).
        effort: on the joint, N m.
        slip: mean, m/s.
        end: slip per force that friction ends, m/(N s).
    """
    square = dot(lever, lever)
    share = rate_gain / (end + rate_gain * square)
    given = dot(lever, slip) / end
    return Yielding(scale(lever, share * (given - effort)), scale(lever, share * given),
                    scale(lever, 1.0 / max(sqrt(square), 1e-300)), rate_gain * square / end)


def sliding(wanted: Vec3, yields: Yielding, most: float) -> Vec3:
    """Return the friction against what is left of a slip that needs more than `most`, N.

    `wanted` ends the slip in the step. Less of it leaves more slip along the lever than across it.
    """
    along = dot(wanted, yields.direction)
    across = subtract(wanted, scale(yields.direction, along))
    size = sqrt(dot(across, across))
    first, second = limited((along, size), (1.0, 1.0), (1.0 + yields.extra, 1.0), most)
    x, y, z = scale(across, second / max(size, 1e-300))
    u, v, w = scale(yields.direction, first)
    return x + u, y + v, z + w


def yielding_along(lever: Tuple[float, float], rate_gain: float, effort: float,
                   slip: Tuple[float, float], soft: Tuple[float, float],
                   ) -> Tuple[Tuple[float, float], Tuple[float, float]]:
    """Return `total` and `spared` along two axes with different slips per force, `soft`."""
    u, v = lever[0] / soft[0], lever[1] / soft[1]
    share = rate_gain / (1.0 + rate_gain * (u * lever[0] + v * lever[1]))
    given = u * slip[0] + v * slip[1]
    total, spared = share * (given - effort), share * given
    return (u * total, v * total), (u * spared, v * spared)


def remaining_share(bias: Vec3, other: Vec3, most: float) -> float:
    """Return the share of a bias with which it and the other friction reach the limit.

    0 if the other friction alone exceeds the limit, or if both together do not: then the edges of a
    wheel that turns slide, not the wheel. `most`: the limit, N, or the load for forces per mu.
    """
    square, along, rest = dot(bias, bias), dot(bias, other), dot(other, other) - most * most
    if rest >= 0.0 or square + 2.0 * along + rest <= 0.0:
        return 0.0
    return (sqrt(along * along - square * rest) - along) / square


def isotropic(contacts: Sequence[ContactPoint], loads: Sequence[float], mine: Motion, bias: Vec3,
              mu: float, soft: float, yields: Yielding, grows: float,
              ) -> Tuple[List[Vec3], float, Vec3]:
    """Return friction by contact with something at rest, N, the mean slip, m/s, and the new bias.

    The law of `wheel_friction` for one coefficient and no slip, in a third of the time.
    """
    (cx, cy, cz), _, (u, v, w), (p, q, r) = mine
    (bx, by, bz), (tx, ty, tz), (ex, ey, ez) = bias, yields.total, yields.spared
    hx, hy, hz = bx + tx, by + ty, bz + tz
    total, within = sum(loads), False
    mx = my = mz = 0.0
    forces: List[Vec3] = []
    for contact, load in zip(contacts, loads):
        (x, y, z), (a, b, c) = contact[POINT], contact[NORMAL]
        x, y, z = x - cx, y - cy, z - cz
        i, j, k = u + q * z - r * y, v + r * x - p * z, w + p * y - q * x
        away = i * a + j * b + k * c
        i, j, k = i - away * a, j - away * b, k - away * c
        mx, my, mz = mx + load * i, my + load * j, mz + load * k
        share = load / total
        i, j, k = share * (hx - i / soft), share * (hy - j / soft), share * (hz - k / soft)
        size, most = sqrt(i * i + j * j + k * k), mu * load
        if size > most and yields.extra:
            i, j, k = sliding((i, j, k), yields, most)
        elif size > most:
            i, j, k = i * most / size, j * most / size, k * most / size
        else:
            within = True
        forces.append((i, j, k))
    mx, my, mz = mx / total, my / total, mz / total
    slip = sqrt(mx * mx + my * my + mz * mz)
    if not within:
        return forces, slip, scale(bias, remaining_share(
            bias, (tx - mx / soft, ty - my / soft, tz - mz / soft), mu * total))
    bx, by, bz = (bx - grows * (mx / soft - ex), by - grows * (my / soft - ey),
                  bz - grows * (mz / soft - ez))
    left = min(1.0, mu * total / max(sqrt(bx * bx + by * by + bz * bz), 1e-300))
    return forces, slip, (left * bx, left * by, left * bz)
