"""Read poses and velocities of links; all reads of PyBullet's link states are here.

PyBullet returns the pose of a link, other than the base, as of its last forward kinematics. An
earlier read may have updated them or not. So these functions always request forward kinematics, and
a result depends only on the state of the world.
"""
from __future__ import annotations

from typing import Any, Dict, List, NamedTuple, Sequence, Tuple

import pybullet

from ...geometry import Quat, Vec3, add, cross, subtract
from ..body_plan import BASE
from .bodies import Body


class Motion(NamedTuple):
    """Pose and velocities of a centre of mass and its principal axes; world axes, m, m/s, rad/s."""

    position: Vec3
    orientation: Quat
    linear: Vec3
    angular: Vec3

    def velocity_at(self, point: Vec3) -> Vec3:
        """Return the velocity of a point that moves with the link, m/s; world axes."""
        return add(self.linear, cross(self.angular, subtract(point, self.position)))


AT_REST = Motion((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
"""Of the world, and of what does not move."""


def child_states(uid: int, indices: Sequence[int], velocities: int = 1,
                 ) -> Sequence[Tuple[Any, ...]]:
    """Return PyBullet's states of links other than the base; with `velocities` 0 poses only."""
    if not indices:
        return ()
    found: Sequence[Tuple[Any, ...]] = pybullet.getLinkStates(
        uid, indices, computeLinkVelocity=velocities, computeForwardKinematics=1)
    return found


def motions(uid: int, indices: Sequence[int]) -> List[Motion]:
    """Return the motions of links of a body other than the base."""
    return [Motion(state[0], state[1], state[6], state[7]) for state in child_states(uid, indices)]


def motion(uid: int, index: int) -> Motion:
    """Return the motion of one link of a body, the base or another one."""
    if index == BASE:
        return Motion(*pybullet.getBasePositionAndOrientation(uid), *pybullet.getBaseVelocity(uid))
    return motions(uid, (index,))[0]


def link_motions(body: Body) -> Dict[int, Motion]:
    """Return the motions of all links of a body, by PyBullet's index."""
    children = [part.index for part in body.parts if part.index != BASE]
    found = {} if body.base is None else {BASE: motion(body.uid, BASE)}
    found.update(zip(children, motions(body.uid, children)))
    return found


def read_com_pose(uid: int, index: int) -> Tuple[Vec3, Quat]:
    """Return the pose of `motion`: of the centre of mass, along the principal axes."""
    if index == BASE:
        position, orientation = pybullet.getBasePositionAndOrientation(uid)
    else:
        position, orientation = child_states(uid, (index,), 0)[0][:2]
    return position, orientation
