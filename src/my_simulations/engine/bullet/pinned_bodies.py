"""Bodies that are held: dragged by hand, they go where they are put and nowhere else."""
from __future__ import annotations

from typing import Callable, Dict, Iterable, List

import pybullet

from ...geometry import Pose, Vec3
from .bodies import Body
from .body_events import BodyEvent
from .step_helper import FAR, StepHelper

_STILL = (0.0, 0.0, 0.0)


class PinnedBodies(StepHelper):
    """Puts held bodies back, at rest, after every step."""

    events = frozenset({BodyEvent.STATE_SET})

    def __init__(self, wake: Callable[[List[Body]], None]) -> None:
        self._wake = wake
        self._bodies: Dict[int, Body] = {}
        self._poses: Dict[int, Pose] = {}

    def set(self, bodies: Iterable[Body]) -> None:
        """Hold these bodies and release all others."""
        before = self._bodies
        self._bodies = {body.uid: body for body in bodies
                        if body.moves and (body.rigid or body.base is not None)}
        self._poses.clear()
        for body in self._bodies.values():
            self._store_pose(body)
        self._wake([body for uid, body in before.items() if uid not in self._bodies])

    def handle_event(self, event: BodyEvent, body: Body) -> None:
        """Keep a body at the pose that a command has set."""
        if body.uid in self._bodies:
            self._store_pose(body)

    def _store_pose(self, body: Body) -> None:
        self._poses[body.uid] = Pose(*pybullet.getBasePositionAndOrientation(body.uid))

    def forget(self, body: Body) -> None:
        self._bodies.pop(body.uid, None)
        self._poses.pop(body.uid, None)

    def due(self, step: int) -> int:
        """Each step while a body is held, otherwise `FAR`."""
        return step if self._poses else FAR

    def after(self, step: int, dt: float, gravity: Vec3) -> None:
        """Restore the poses of held bodies after a step, at rest."""
        for uid, pose in self._poses.items():
            pybullet.resetBasePositionAndOrientation(uid, pose.position, pose.orientation)
            pybullet.resetBaseVelocity(uid, _STILL, _STILL)
