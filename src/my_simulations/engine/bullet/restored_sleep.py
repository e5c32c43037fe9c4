"""Puts bodies to sleep again that slept when the state of the world was saved.

A world that was built again has no contacts. A body that sleeps finds none, and what reads contacts
would miss it. So it stays awake for some steps, in which Bullet finds its contacts and their
forces, and is then put back to its pose, at rest and asleep. Bullet wakes it, as every sleeper, if
something that moves touches it. Articulated bodies do not sleep; those that `ContactSettling` held
are held again.
"""
from __future__ import annotations

from typing import Callable, Dict, Iterable, NamedTuple, Optional, Set, Tuple

import pybullet

from ...geometry import Vec3, norm, subtract
from ..body_plan import BASE
from ..run_state import RestPose
from .bodies import Body
from .body_events import COMMANDED, BodyEvent
from .rest_place import put_at_rest, read_place
from .step_helper import FAR, StepHelper

_AWAKE_STEPS = 16      # contact forces of six boxes on each other are right within 5 % after these
_MOST_SHIFT = 1e-4     # m, rad in these steps: a body that went farther was pushed
_AT_REST = (0.0, 0.0, 0.0)


class _Rest(NamedTuple):
    body: Body
    place: RestPose


class RestoredSleep(StepHelper):
    """Finds out which bodies sleep, and puts bodies to rest.

    Args:
        hold: holds an articulated body at a place.
    """

    events = COMMANDED

    def __init__(self, hold: Callable[[Body, RestPose], None]) -> None:
        self._hold = hold
        self._commanded: Set[int] = set()      # reached by a command since the last step
        self._rests: Dict[int, _Rest] = {}     # by PyBullet's number
        self._sleep_step: Optional[int] = None

    def put(self, rests: Iterable[Tuple[Body, RestPose]]) -> None:
        """Put these bodies to rest at these places some steps from now on."""
        self._rests = {body.uid: _Rest(body, place) for body, place in rests}
        self._sleep_step = None

    def place_of(self, body: Body) -> Optional[RestPose]:
        """Where a body sleeps, or is to be put to rest soon; None for others.

        PyBullet does not report sleep. A body that flies or was just put somewhere is awake. One
        that stands as still as if it slept counts as asleep.
        """
        if body.uid in self._rests:
            return self._rests[body.uid].place
        if (body.sleeps and body.uid not in self._commanded
                and pybullet.getBaseVelocity(body.uid) == (_AT_REST, _AT_REST)
                and pybullet.getContactPoints(bodyA=body.uid)):
            return read_place(body)
        return None

    def stepped(self) -> None:
        """Steps are about to be made."""
        self._commanded.clear()

    def handle_event(self, event: BodyEvent, body: Body) -> None:
        """A command has reached a body: it stays awake."""
        self._rests.pop(body.uid, None)
        self._commanded.add(body.uid)

    def forget(self, body: Body) -> None:
        self._rests.pop(body.uid, None)

    def due(self, step: int) -> int:
        """The next step, and the one in which they fall asleep."""
        if not self._rests:
            return FAR
        return step if self._sleep_step is None else max(step, self._sleep_step)

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Put the bodies to rest once the time has come."""
        if not self._rests:
            return
        if self._sleep_step is None:
            self._sleep_step = step + _AWAKE_STEPS
        elif step >= self._sleep_step:
            rests, self._rests = self._rests, {}
            for body, place in rests.values():
                if not _is_near(place, read_place(body)):
                    continue
                if body.rigid:
                    put_at_rest(body, place)
                    pybullet.changeDynamics(body.uid, BASE,
                                            activationState=pybullet.ACTIVATION_STATE_SLEEP)
                else:
                    self._hold(body, place)


def _is_near(one: RestPose, other: RestPose) -> bool:
    moved = (norm(subtract(one.base.position, other.base.position))
             if one.base is not None and other.base is not None else 0.0)
    turned = max([abs(a - b) for a, b in zip(one.positions, other.positions)], default=0.0)
    return max(moved, turned) <= _MOST_SHIFT
