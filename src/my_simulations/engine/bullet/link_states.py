"""Where the links of a body are and how they move: the one reader of PyBullet's link states.

PyBullet tells the place of a hung link as of its last forward kinematics, which whoever read it
before may have asked for or not. So they are asked for always: then an answer depends on the state
of the world alone.
"""
from __future__ import annotations

from typing import Any, List, NamedTuple, Sequence, Tuple

import pybullet

from ...geometry import Quat, Vec3
from ..body_plan import BASE


class Motion(NamedTuple):
    """Of a centre of mass and its principal axes, in world axes: m, m/s, rad/s."""

    position: Vec3
    orientation: Quat
    linear: Vec3
    angular: Vec3


def hung_states(uid: int, indices: Sequence[int], velocities: int = 1) -> Sequence[Tuple[Any, ...]]:
    """PyBullet's states of hung links; without `velocities` (0) they end after the pivot's pose."""
    if not indices:
        return ()
    found: Sequence[Tuple[Any, ...]] = pybullet.getLinkStates(
        uid, indices, computeLinkVelocity=velocities, computeForwardKinematics=1)
    return found


def motions(uid: int, indices: Sequence[int]) -> List[Motion]:
    """Of hung links of a body."""
    return [Motion(state[0], state[1], state[6], state[7]) for state in hung_states(uid, indices)]


def motion(uid: int, index: int) -> Motion:
    """Of one link of a body, the base or a hung one."""
    if index == BASE:
        return Motion(*pybullet.getBasePositionAndOrientation(uid), *pybullet.getBaseVelocity(uid))
    return motions(uid, (index,))[0]


def place(uid: int, index: int) -> Tuple[Vec3, Quat]:
    """The pose of one link of a body, the base or a hung one, as of `motion`."""
    if index == BASE:
        position, orientation = pybullet.getBasePositionAndOrientation(uid)
    else:
        position, orientation = hung_states(uid, (index,), 0)[0][:2]
    return position, orientation
