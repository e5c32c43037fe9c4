"""Put bodies to rest, and put those to sleep again that slept in a saved state."""
from __future__ import annotations

from typing import Any, Callable, Dict, Iterable, Optional, Sequence, Set, Tuple

import pybullet

from ...geometry import STILL, Pose, Vec3, norm, subtract
from ..body_plan import BASE
from ..run_state import RestPose
from .bodies import Body, set_axis_state, stop_ball_joints
from .body_events import COMMANDED, BodyEvent
from .step_helper import FAR, StepHelper

_AWAKE_STEPS = 16      # then the contact forces in a stack of six boxes are right within 5 %
_MOST_SHIFT = 1e-4     # m or rad in these steps: a body that moved farther was pushed


def read_rest_pose(body: Body, states: Optional[Sequence[Any]] = None) -> RestPose:
    """Return the base pose and the joint positions of a body.

    `states`: the states of its axes as PyBullet returns them, if they were read already.
    """
    if states is None:
        states = pybullet.getJointStates(body.uid, [axis.index for axis in body.axes]) or ()
    return RestPose(Pose(*pybullet.getBasePositionAndOrientation(body.uid))
                     if body.base is not None else None, tuple(state[0] for state in states))


def put_at_rest(body: Body, pose: RestPose) -> None:
    """Set the pose and joint positions of a body, at rest. Ball joints keep their orientations."""
    if pose.base is not None:
        pybullet.resetBasePositionAndOrientation(body.uid, *pose.base)
        pybullet.resetBaseVelocity(body.uid, *STILL)
    for axis, position in zip(body.axes, pose.positions):
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
        hold: holds an articulated body in a pose.
    """

    events = COMMANDED

    def __init__(self, hold: Callable[[Body, RestPose], None]) -> None:
        self._hold = hold
        self._commanded: Set[int] = set()      # changed by a command since the last step
        self._rests: Dict[int, Tuple[Body, RestPose]] = {}
        self._sleep_step: Optional[int] = None
        self.body_tables = (self._rests,)

    def put(self, rests: Iterable[Tuple[Body, RestPose]]) -> None:
        """Put these bodies to rest in these poses after a waiting time of some steps."""
        self._rests.clear()
        self._rests.update((body.uid, (body, pose)) for body, pose in rests)
        self._sleep_step = None

    def rest_pose_of(self, body: Body) -> Optional[RestPose]:
        """Return the pose in which a body sleeps, or will be put to rest; None for others.

        PyBullet does not report sleep. A body that flies or was just put somewhere is awake. One
        that stands as still as if it slept counts as asleep.
        """
        if body.uid in self._rests:
            return self._rests[body.uid][1]
        if (body.sleeps and body.uid not in self._commanded
                and pybullet.getBaseVelocity(body.uid) == STILL
                and pybullet.getContactPoints(bodyA=body.uid)):
            return read_rest_pose(body)
        return None

    def forget_commands(self) -> None:
        """Discard which bodies commands have changed; the next steps show their effects."""
        self._commanded.clear()

    def handle_event(self, event: BodyEvent, body: Body) -> None:
        """Do not put a body to rest that a command has changed."""
        self._rests.pop(body.uid, None)
        self._commanded.add(body.uid)

    def due(self, step: int) -> int:
        """The next step, which starts the waiting time, and the step that ends it."""
        if not self._rests:
            return FAR
        return step if self._sleep_step is None else max(step, self._sleep_step)

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Put the bodies to rest after the waiting time, unless they were pushed in it."""
        if self._sleep_step is None:
            self._sleep_step = step + _AWAKE_STEPS
        elif step >= self._sleep_step:
            rests = list(self._rests.values())
            self._rests.clear()
            for body, pose in rests:
                if _shift(pose, read_rest_pose(body)) > _MOST_SHIFT:
                    continue
                if body.rigid:
                    put_at_rest(body, pose)
                    pybullet.changeDynamics(body.uid, BASE,
                                            activationState=pybullet.ACTIVATION_STATE_SLEEP)
                else:
                    self._hold(body, pose)


def _shift(one: RestPose, other: RestPose) -> float:
    """Return the largest difference between the positions of a base and of its joints, m or rad."""
    moved = (norm(subtract(one.base.position, other.base.position))
             if one.base is not None and other.base is not None else 0.0)
    return max([moved, *(abs(a - b) for a, b in zip(one.positions, other.positions))])
