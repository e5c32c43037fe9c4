"""Puts bodies to sleep again that slept when the state of the world was saved.

A world that was built again has no contacts. A body that sleeps finds none, and what reads contacts
would miss it. So it stays awake for some steps, in which Bullet finds its contacts and their
forces, and is then put back to its pose, at rest and asleep. Bullet wakes it, as every sleeper, if
something that moves touches it.
"""
from __future__ import annotations

from typing import Dict, Iterable, Optional, Set

import pybullet

from ...geometry import Pose, Vec3, norm, subtract
from ..body_plan import BASE
from .bodies import Body
from .step_helper import FAR

_AWAKE_STEPS = 16      # contact forces of a pile of ten boxes are right within 1 % after these
_MOST_SHIFT = 1e-4     # m in these steps: a body that went farther was pushed
_AT_REST = (0.0, 0.0, 0.0)


class RestoredSleep:
    """Knows which bodies sleep, and puts bodies to sleep."""

    def __init__(self) -> None:
        self._commanded: Set[int] = set()      # reached by a command since the last step
        self._poses: Dict[int, Pose] = {}      # by PyBullet's number
        self._sleep_step: Optional[int] = None

    def put(self, bodies: Iterable[Body]) -> None:
        """Put these bodies to sleep some steps from now on, where they are."""
        self._poses = {body.uid: Pose(*pybullet.getBasePositionAndOrientation(body.uid))
                       for body in bodies}
        self._sleep_step = None

    def is_asleep(self, body: Body) -> bool:
        """Whether a body sleeps or is to sleep soon; or stands as still, which is the same.

        PyBullet does not report sleep. A body that flies or was just put somewhere is awake.
        """
        uid = body.uid
        return uid in self._poses or (
            body.sleeps and uid not in self._commanded
            and pybullet.getBaseVelocity(uid) == (_AT_REST, _AT_REST)
            and bool(pybullet.getContactPoints(bodyA=uid)))

    def stepped(self) -> None:
        """Steps are about to be made."""
        self._commanded.clear()

    def touched(self, body: Body) -> None:
        """A command has reached a body: it stays awake."""
        self._poses.pop(body.uid, None)
        self._commanded.add(body.uid)

    def forget(self, body: Body) -> None:
        """A body is gone."""
        self._poses.pop(body.uid, None)

    def clear(self) -> None:
        """All bodies are gone."""
        self._poses.clear()
        self._commanded.clear()

    def due(self, step: int) -> int:
        """The next step, and the one in which they fall asleep."""
        if not self._poses:
            return FAR
        return step if self._sleep_step is None else max(step, self._sleep_step)

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Put the bodies to sleep once the time has come."""
        if not self._poses:
            return
        if self._sleep_step is None:
            self._sleep_step = step + _AWAKE_STEPS
        elif step >= self._sleep_step:
            poses, self._poses = self._poses, {}
            for uid, pose in poses.items():
                at = pybullet.getBasePositionAndOrientation(uid)[0]
                if norm(subtract(at, pose.position)) <= _MOST_SHIFT:
                    _put_to_sleep(uid, pose)

    def after(self, step: int, dt: float, gravity: Vec3) -> None:
        """Do nothing after a step."""


def _put_to_sleep(uid: int, pose: Pose) -> None:
    pybullet.resetBasePositionAndOrientation(uid, pose.position, pose.orientation)
    pybullet.resetBaseVelocity(uid, _AT_REST, _AT_REST)
    pybullet.changeDynamics(uid, BASE, activationState=pybullet.ACTIVATION_STATE_SLEEP)
