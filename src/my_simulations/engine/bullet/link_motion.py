"""Compute velocities and accelerations of the links of an articulated body in one step.

Bullet computes joint accelerations from the forces in the configuration at the start of a step. The
difference of a link's world velocities over the step also contains the rotation of the links in it.
This error is proportional to the step size (1 % of the torques of an arm in fast motion). So the
accelerations at the start are computed link by link, from the root. Each link adds the change of
its velocity relative to its parent, in the parent's axes.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

import pybullet

from ...geometry import (
    ZERO3,
    Quat,
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
from .bodies import Body, Part


class State(NamedTuple):
    """Centre of mass, orientation of the principal axes, and velocities; world axes."""

    position: Vec3
    turn: Quat
    linear: Vec3
    angular: Vec3


class Motion(NamedTuple):
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


Look = Tuple[Any, Any, Sequence[Any]]
"""PyBullet's states of a body: pose and velocity of the base, states of the other links."""


def look(body: Body) -> Look:
    """Read the states of all links of a body; `states` converts them."""
    indices = [part.index for part in body.parts if part.index != BASE]
    return (pybullet.getBasePositionAndOrientation(body.uid), pybullet.getBaseVelocity(body.uid),
            pybullet.getLinkStates(body.uid, indices, computeLinkVelocity=1,
                                   computeForwardKinematics=1) if indices else ())


def states(body: Body, seen: Look) -> Dict[int, State]:
    """Convert the result of `look` to states by PyBullet's link index."""
    found: Dict[int, State] = {}
    if body.base is not None:
        found[BASE] = State(*seen[0], *seen[1])
    for index, state in zip((part.index for part in body.parts if part.index != BASE), seen[2]):
        found[index] = State(state[0], state[1], state[6], state[7])
    return found


def accelerations(chain: Chain, before: Mapping[int, State], after: Mapping[int, State],
                  dt: float) -> Dict[int, Motion]:
    """Return the accelerations of all links at the start of a step of `dt` s, by index."""
    found: Dict[int, Motion] = {}
    for part, parent, joint in chain.links:
        state, later = before[part.index], after[part.index]
        if parent is None and part.index == BASE:
            found[BASE] = Motion(scale(subtract(later.linear, state.linear), 1.0 / dt),
                                 scale(subtract(later.angular, state.angular), 1.0 / dt))
            continue
        over = _FIXED if parent is None else before[parent.index]
        over_later = _FIXED if parent is None else after[parent.index]
        above = _STILL if parent is None else found[parent.index]
        sliding, turning = _against(over, state, joint)
        sliding_later, turning_later = _against(over_later, later, joint)
        gain = rotate(over.turn, scale(subtract(sliding_later, sliding), 1.0 / dt))
        twist = rotate(over.turn, scale(subtract(turning_later, turning), 1.0 / dt))
        arm = rotate(state.turn, joint)          # from the centre of mass to the joint
        reach = subtract(add(state.position, arm), over.position)
        angular = add(above.angular, add(twist, cross(over.angular,
                                                      subtract(state.angular, over.angular))))
        linear = add(above.linear, _about(above.angular, over.angular, reach))
        linear = add(linear, add(gain, scale(cross(over.angular, rotate(over.turn, sliding)), 2.0)))
        found[part.index] = Motion(subtract(linear, _about(angular, state.angular, arm)), angular)
    return found


def inertial_wrench(part: Part, state: State, motion: Motion, gravity: Vec3) -> Tuple[Vec3, Vec3]:
    """Return the wrench, without gravity, that gives a link its acceleration.

    Force, N, and torque about the centre of mass, N m, world axes.
    """
    back = conjugate(state.turn)
    spin, gain = rotate(back, state.angular), rotate(back, motion.angular)
    a, b, c = part.moments
    momentum = (a * spin[0], b * spin[1], c * spin[2])
    torque = add((a * gain[0], b * gain[1], c * gain[2]), cross(spin, momentum))
    return (scale(subtract(motion.linear, gravity), part.mass), rotate(state.turn, torque))


_FIXED = State(ZERO3, (0.0, 0.0, 0.0, 1.0), ZERO3, ZERO3)
_STILL = Motion(ZERO3, ZERO3)


def _against(over: State, state: State, joint: Vec3) -> Tuple[Vec3, Vec3]:
    """Return the linear and angular velocity of a joint relative to the parent, in its axes."""
    arm = rotate(state.turn, joint)
    reach = subtract(add(state.position, arm), over.position)
    sliding = subtract(add(state.linear, cross(state.angular, arm)),
                       add(over.linear, cross(over.angular, reach)))
    back = conjugate(over.turn)
    return rotate(back, sliding), rotate(back, subtract(state.angular, over.angular))


def _about(angular: Vec3, rate: Vec3, arm: Vec3) -> Vec3:
    """Return the acceleration of a point of a body relative to another one, `arm` away."""
    return add(cross(angular, arm), cross(rate, cross(rate, arm)))
