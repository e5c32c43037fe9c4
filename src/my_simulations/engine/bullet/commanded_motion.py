"""Set the motion of models regardless of forces: planar velocities, and poses of pinned models."""
from __future__ import annotations

import math
from typing import Callable, Dict, Iterable, List, Mapping

import pybullet

from ...geometry import STILL, Pose, Vec3, cross, rpy_from_quat, subtract
from ..drive_commands import PlanarVelocity
from .bodies import Body, set_sleep
from .body_events import BodyEvent
from .state_restore import Entry
from .step_helper import FAR, StepHelper


class PlanarMotion(StepHelper):
    """Sets the commanded velocities of models in the horizontal plane before each step."""

    def __init__(self, models: Mapping[int, Entry], model_pose: Callable[[Entry], Pose],
                 wake: Callable[[List[Body]], None]) -> None:
        self._models = models
        self._model_pose = model_pose
        self._wake = wake
        self._velocities: Dict[int, PlanarVelocity] = {}

    def set(self, velocities: Iterable[PlanarVelocity]) -> None:
        """Move these models and stop all others; removed models are ignored."""
        before = self._velocities
        self._velocities = {one.model_id: one for one in velocities
                            if one.model_id in self._models}
        changed = [number for number, one in self._velocities.items() if before.get(number) != one]
        if changed:
            self._wake([body for number in changed for body in self._models[number].bodies])
        self._load(self._velocities.keys() - before.keys(), 1)
        self._load(before.keys() - self._velocities.keys(), -1)

    def _load(self, numbers: Iterable[int], change: int) -> None:
        """Keep bodies awake while they have planar velocities; allow sleep after it."""
        for number in sorted(numbers):
            for body in self._models[number].bodies:
                body.force_count += change
                set_sleep(body)

    def forget(self, body: Body) -> None:
        self._velocities.pop(body.model_id, None)

    def due(self, step: int) -> int:
        """Each step while a model has a commanded velocity, otherwise `FAR`."""
        return step if self._velocities else FAR

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        for number, wanted in self._velocities.items():
            entry = self._models[number]
            at, turn = self._model_pose(entry)
            yaw = rpy_from_quat(turn)[2]
            c, s = math.cos(yaw), math.sin(yaw)
            linear = (c * wanted.x - s * wanted.y, s * wanted.x + c * wanted.y, 0.0)
            angular = (0.0, 0.0, wanted.yaw_rate)
            for body in entry.bodies:
                if not body.moves or body.base is None:
                    continue
                com = pybullet.getBasePositionAndOrientation(body.uid)[0]
                lever = cross(angular, subtract(com, at))
                pybullet.resetBaseVelocity(
                    body.uid, (linear[0] + lever[0], linear[1] + lever[1], 0.0), angular)


class PinnedBodies(StepHelper):
    """Sets pinned bodies, such as dragged ones, back to their poses, at rest, after each step."""

    events = frozenset({BodyEvent.STATE_SET})

    def __init__(self, wake: Callable[[List[Body]], None]) -> None:
        self._wake = wake
        self._bodies: Dict[int, Body] = {}
        self._poses: Dict[int, Pose] = {}

    def set(self, bodies: Iterable[Body]) -> None:
        """Pin these bodies and release all others."""
        before = self._bodies
        self._bodies = {body.uid: body for body in bodies
                        if body.moves and body.base is not None}
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
        """Each step while a body is pinned, otherwise `FAR`."""
        return step if self._poses else FAR

    def after(self, step: int, dt: float, gravity: Vec3) -> None:
        """Restore the poses of pinned bodies, at rest."""
        for uid, pose in self._poses.items():
            pybullet.resetBasePositionAndOrientation(uid, pose.position, pose.orientation)
            pybullet.resetBaseVelocity(uid, *STILL)
