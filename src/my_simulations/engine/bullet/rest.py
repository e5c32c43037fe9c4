"""Put bodies to rest: where they rest, and which are to sleep again in a restored world."""
from __future__ import annotations

from typing import Any, Callable, Dict, Iterable, Optional, Sequence, Set, Tuple

import pybullet

from ...geometry import STILL, Pose, Vec3, norm, subtract
from ..body_plan import BASE
from ..run_state import RestPose
from .bodies import Body, set_axis_state, stop_ball_joints
from .body_events import COMMANDED, BodyEvent
from .step_helper import FAR, StepHelper

_AWAKE_STEPS = 16      # contact forces of six boxes on each other are right within 5 % after these
_MOST_SHIFT = 1e-4     # m, rad in these steps: a body that went farther was pushed


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
        pybullet.resetBaseVelocity(body.uid, *STILL)
    for axis, position in zip(body.axes, place.positions):
        set_axis_state(body, axis, position)
    stop_ball_joints(body)


class RestoredSleep(StepHelper):
    """Finds out which bodies sleep, and puts bodies to sleep that slept in a saved state.

    A world that was built again has no contacts. A body that sleeps finds none, and what reads
    contacts would miss it. So it stays awake for some steps, in which Bullet finds its contacts and
    their forces, and is then put back to its pose, at rest and asleep. Bullet wakes it, as every
    sleeper, if something that moves touches it. Articulated bodies do not sleep; those that
    `ContactSettling` held are held again.

    Args:
        hold: holds an articulated body at a place.
    """

    events = COMMANDED

    def __init__(self, hold: Callable[[Body, RestPose], None]) -> None:
        self._hold = hold
        self._commanded: Set[int] = set()      # reached by a command since the last step
        self._rests: Dict[int, Tuple[Body, RestPose]] = {}
        self._sleep_step: Optional[int] = None
        self.body_tables = (self._rests,)

    def put(self, rests: Iterable[Tuple[Body, RestPose]]) -> None:
        """Put these bodies to rest at these places some steps from now on."""
        self._rests.clear()
        self._rests.update((body.uid, (body, place)) for body, place in rests)
        self._sleep_step = None

    def place_of(self, body: Body) -> Optional[RestPose]:
        """Where a body sleeps, or is to be put to rest soon; None for others.

        PyBullet does not report sleep. A body that flies or was just put somewhere is awake. One
        that stands as still as if it slept counts as asleep.
        """
        if body.uid in self._rests:
            return self._rests[body.uid][1]
        if (body.sleeps and body.uid not in self._commanded
                and pybullet.getBaseVelocity(body.uid) == STILL
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

    def due(self, step: int) -> int:
        """The next step, and the one in which they fall asleep."""
        if not self._rests:
            return FAR
        return step if self._sleep_step is None else max(step, self._sleep_step)

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Put the bodies to rest once the time has come."""
        if self._sleep_step is None:
            self._sleep_step = step + _AWAKE_STEPS
        elif step >= self._sleep_step:
            rests = list(self._rests.values())
            self._rests.clear()
            for body, place in rests:
                if _shift(place, read_place(body)) > _MOST_SHIFT:
                    continue
                if body.rigid:
                    put_at_rest(body, place)
                    pybullet.changeDynamics(body.uid, BASE,
                                            activationState=pybullet.ACTIVATION_STATE_SLEEP)
                else:
                    self._hold(body, place)


def _shift(one: RestPose, other: RestPose) -> float:
    """Return how far a body is from a place, m or rad; the most of its base and its joints."""
    moved = (norm(subtract(one.base.position, other.base.position))
             if one.base is not None and other.base is not None else 0.0)
    return max([moved, *(abs(a - b) for a, b in zip(one.positions, other.positions))])
