"""The place where a body rests: read it, and put the body back there."""
from __future__ import annotations

from typing import Any, Optional, Sequence

import pybullet

from ...geometry import Pose
from ..run_state import RestPose
from .bodies import Body, put_axis

_AT_REST = (0.0, 0.0, 0.0)


def read_place(body: Body, states: Optional[Sequence[Any]] = None) -> RestPose:
    """Return where a body is; `states`: PyBullet's of its axes, if they were read already."""
    if states is None:
        states = pybullet.getJointStates(body.uid, [axis.index for axis in body.axes]) or ()
    return RestPose(Pose(*pybullet.getBasePositionAndOrientation(body.uid))
                     if body.base is not None else None, tuple(state[0] for state in states))


def put_at_rest(body: Body, place: RestPose) -> None:
    """Put a body with its joints at a place, at rest. Ball joints keep their orientations."""
    if place.base is not None:
        pybullet.resetBasePositionAndOrientation(body.uid, *place.base)
        pybullet.resetBaseVelocity(body.uid, _AT_REST, _AT_REST)
    for axis, position in zip(body.axes, place.positions):
        put_axis(body, axis, position)
    for ball in body.balls:
        turn = pybullet.getJointStateMultiDof(body.uid, ball.index)[0]
        pybullet.resetJointStateMultiDof(body.uid, ball.index, turn, _AT_REST)
