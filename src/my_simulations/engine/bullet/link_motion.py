"""Compute velocities and accelerations of the links of an articulated body in one step.

Bullet computes joint accelerations from the forces in the configuration at the start of a step. The
difference of a link's world velocities over the step also contains the rotation of the links in it.
This error is proportional to the step size (1 % of the torques of an arm in fast motion). So the
accelerations at the start are computed link by link, from the root. Each link adds the change of
its velocity relative to its parent, in the parent's axes.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from ...geometry import (
    ZERO3,
    Vec3,
    add,
    conjugate,
    cross,
    inverse,
    rotate,
    scale,
    subtract,
    transform,
)
from ..body_plan import BASE, NO_LINK, TreeLink
from .bodies import Part
from .link_states import AT_REST, Motion


class Acceleration(NamedTuple):
    """Accelerations of the centre of mass, m/s^2, and angular, rad/s^2; world axes."""

    linear: Vec3
    angular: Vec3


@dataclass(frozen=True)
class Chain:
    """The links of a body, parents first: each with its parent and the joint between them.

    The joint is a point relative to the link's centre of mass, in its principal axes. The parent of
    a root, and of the first links on a fixed base, is None.
    """

    links: Tuple[Tuple[Part, Optional[Part], Vec3], ...]

    @classmethod
    def of(cls, parts: Mapping[int, Part], links: Sequence[TreeLink]) -> "Chain":
        """Return the chain of a body; `parts` by the link's index in the model."""
        found: List[Tuple[Part, Optional[Part], Vec3]] = []
        for link in links:
            if link.index == NO_LINK:
                continue
            above = link.parent
            while above != BASE and links[above].index == NO_LINK:
                above = links[above].parent
            part = parts[link.index]
            found.append((part, None if above == BASE else parts[links[above].index],
                          transform(inverse(part.link_from_com), link.link_from_frame.position)))
        return cls(tuple(found))


def accelerations(chain: Chain, before: Mapping[int, Motion], after: Mapping[int, Motion],
                  dt: float) -> Dict[int, Acceleration]:
    """Return the accelerations of all links at the start of a step of `dt` s, by index."""
    found: Dict[int, Acceleration] = {}
    for part, parent, joint in chain.links:
        state, later = before[part.index], after[part.index]
        if parent is None and part.index == BASE:
            found[BASE] = Acceleration(scale(subtract(later.linear, state.linear), 1.0 / dt),
                                       scale(subtract(later.angular, state.angular), 1.0 / dt))
            continue
        over = AT_REST if parent is None else before[parent.index]
        over_later = AT_REST if parent is None else after[parent.index]
        above = _STILL if parent is None else found[parent.index]
        sliding, turning = _against(over, state, joint)
        sliding_later, turning_later = _against(over_later, later, joint)
        gain = rotate(over.orientation, scale(subtract(sliding_later, sliding), 1.0 / dt))
        twist = rotate(over.orientation, scale(subtract(turning_later, turning), 1.0 / dt))
        arm = rotate(state.orientation, joint)          # from the centre of mass to the joint
        reach = subtract(add(state.position, arm), over.position)
        angular = add(above.angular, add(twist, cross(over.angular,
                                                      subtract(state.angular, over.angular))))
        linear = add(above.linear, _about(above.angular, over.angular, reach))
        drift = rotate(over.orientation, sliding)
        linear = add(linear, add(gain, scale(cross(over.angular, drift), 2.0)))
        linear = subtract(linear, _about(angular, state.angular, arm))
        found[part.index] = Acceleration(linear, angular)
    return found


def inertial_wrench(part: Part, state: Motion, acceleration: Acceleration,
                    gravity: Vec3) -> Tuple[Vec3, Vec3]:
    """Return the wrench, without gravity, that gives a link its acceleration.

    Force, N, and torque about the centre of mass, N m, world axes.
    """
    back = conjugate(state.orientation)
    spin, gain = rotate(back, state.angular), rotate(back, acceleration.angular)
    a, b, c = part.moments
    momentum = (a * spin[0], b * spin[1], c * spin[2])
    torque = add((a * gain[0], b * gain[1], c * gain[2]), cross(spin, momentum))
    return (scale(subtract(acceleration.linear, gravity), part.mass),
            rotate(state.orientation, torque))


_STILL = Acceleration(ZERO3, ZERO3)


def _against(over: Motion, state: Motion, joint: Vec3) -> Tuple[Vec3, Vec3]:
    """Return the linear and angular velocity of a joint relative to the parent, in its axes."""
    arm = rotate(state.orientation, joint)
    reach = subtract(add(state.position, arm), over.position)
    sliding = subtract(add(state.linear, cross(state.angular, arm)),
                       add(over.linear, cross(over.angular, reach)))
    back = conjugate(over.orientation)
    return rotate(back, sliding), rotate(back, subtract(state.angular, over.angular))


def _about(angular: Vec3, rate: Vec3, arm: Vec3) -> Vec3:
    """Return the acceleration of a point of a body relative to another one, `arm` away."""
    return add(cross(angular, arm), cross(rate, cross(rate, arm)))
