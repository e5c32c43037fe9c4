"""Keep bodies at rest in place: separate initial overlaps, and choose the solver accuracy.

Figures and reasons: doc/dev/contacts.md, "Bodies at rest".

Split impulses act for at most 1 s after a body was added: with them Bullet separates overlapping
rigid bodies without a change of momentum. In this mode Bullet does not correct joints that are past
their limits; this module corrects them, also without velocity. Split impulses end once no overlap
is deep.

With Bullet's usual residual, sqrt(1e-7) m/s, a body at rest can drift, and contacts of articulated
bodies have no warm start. So the accuracy depends on the bodies:

- While a slow articulated body touches something, the residual is 3e-8 m/s, with more iterations.
- An articulated body is held after it has stood still for half a second, if only gravity and static
  bodies act on it and no motor moves an axis. Every 16 steps it and its joints are set back to the
  held pose, at rest. Until another body touches it, it does not affect the accuracy.
- While rigid bodies that may not sleep, or that a force or a tie keeps awake, lean on friction or
  are small, the residual is 3e-6 m/s.
- Bodies that move, sleep, or stand on a level floor cost nothing.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Callable, Dict, List, Optional, Sequence, Set

import pybullet

from ...geometry import Vec3
from ..run_state import SPLIT_IMPULSES_NOT_BEGUN, RestPose
from .bodies import Body, axis_states
from .body_events import COMMANDED, BodyEvent
from .contact_points import DISTANCE, FRICTION, FRICTION_2, LOAD, OTHER_BODY
from .rest import put_at_rest, read_rest_pose
from .step_helper import FAR, StepHelper, next_multiple
from .world_parameters import USUAL_ACCURACY, Accuracy, WorldParameters

EVERY = 16               # steps between two checks of articulated bodies
_RIGID_EVERY = 256       # the same for rigid bodies, of which there may be hundreds
_SLOW_SPEED = 0.02       # m/s and rad/s, of the base or a rigid body
_SLOW_RATE = 0.05        # rad/s or m/s, of all joints: braked wheels of 3 cm creep at 0.02
_STILL_SPEED = 2e-5      # m/s and rad/s, of the base: a faster one moves, it does not creep
_STILL_RATE = 3e-4       # rad/s or m/s: the rate of a wheel of 6 cm on a base at _STILL_SPEED
_SKIPPED = 3             # checks that an arm without contacts skips
_CHECKS_UNTIL_HELD = 32  # its acceleration is then below 4e-5 m/s^2
_PUSHED_SPEED = 2e-3     # m/s and rad/s: the base of a held body is slower between two checks
_PUSHED_RATE = 0.05      # rad/s or m/s: the same for its joints
_MOVING_SHARE = 0.1      # share of the commanded rate: an axis above it moves
_LEANING_RATIO = 0.02    # friction force / normal force: above it, a body leans
_SMALL_RADIUS = 0.06     # m, radius: a smaller body creeps on level floors too
_FOR_LEANING_BODIES = Accuracy(residual=1e-11)
_FOR_STANDING_ROBOTS = Accuracy(4, 1e-15)
_SPLIT_IMPULSE_TIME = 1.0  # s for which split impulses act, at most
_LEAST_TIME = 0.1          # s, at least: bodies placed just above a surface have landed by then
_TOLERATED_OVERLAP = 1e-4  # m: smaller overlaps may be separated with velocity
_OVERLAPS_EVERY = 64       # steps between two checks of overlaps
_PAST_LIMIT = 1e-6         # rad or m past a limit that are tolerated
_CORRECTION = 0.5          # share of the way back to the limit at each check


@dataclass
class _Tree:
    """An articulated body.

    Attributes:
        still_checks: consecutive checks at which it stood still.
        skip: number of the next checks that skip an arm without contacts.
        held: pose of its base, if that is free, and of its axes to restore; None: not held.
    """

    body: Body
    still_checks: int = 0
    skip: int = 0
    held: Optional[RestPose] = None


class ContactSettling(StepHelper):
    """Chooses the accuracy of Bullet's solver, and holds robots at rest.

    Args:
        parameters: solver parameters of the world.
        loaded: returns the bodies that timed forces act on in this step.
        driven: returns the rate, rad/s or m/s, to which the axis of a row is driven; 0 for none.
        notify: is called when a body is fixed at rest, or released.
    """

    events = COMMANDED

    def __init__(self, parameters: WorldParameters, loaded: Callable[[], Set[int]],
                 driven: Callable[[int], float], notify: Callable[[BodyEvent, Body], None]) -> None:
        self._parameters = parameters
        self._loaded, self._driven, self._notify = loaded, driven, notify
        self._trees: Dict[int, _Tree] = {}
        self._moving: Set[int] = set()
        self._rigid: Dict[int, Body] = {}     # awake, or changed by a command since the last check
        self._leaning = False
        self._has_new_bodies = False           # since the last step
        self._new_trees: List[_Tree] = []
        self._split_impulse_end: Optional[int] = None   # a step count; None: they do not act

    def add(self, body: Body) -> None:
        """Register a body; only articulated ones and those that may not sleep matter."""
        self._has_new_bodies = True
        if body.moves:
            self._moving.add(body.uid)
        if body.moves and not body.rigid:
            tree = _Tree(body)
            self._trees[body.uid] = tree
            self._new_trees.append(tree)
        elif body.moves and not body.sleeps:
            self._rigid[body.uid] = body

    def forget(self, body: Body) -> None:
        self._trees.pop(body.uid, None)
        self._new_trees = [tree for tree in self._new_trees if tree.body is not body]
        self._moving.discard(body.uid)
        self._rigid.pop(body.uid, None)
        if not self._trees and not self._rigid:
            self._leaning = False
            self._parameters.request_accuracy(USUAL_ACCURACY)

    def handle_event(self, event: BodyEvent, body: Body) -> None:
        """Release a body that a command changed: it can move, or must not sleep."""
        if body.rigid and body.moves:
            self._rigid[body.uid] = body
        tree = self._trees.get(body.uid)
        if tree is not None:
            held, tree.held = tree.held, None
            tree.still_checks, tree.skip = 0, 0
            if held is not None:
                self._notify(BodyEvent.RELEASED, body)

    @property
    def split_impulse_end(self) -> Optional[int]:
        """See `RunState.split_impulse_end`."""
        return SPLIT_IMPULSES_NOT_BEGUN if self._has_new_bodies else self._split_impulse_end

    def resume_split_impulses(self, end: Optional[int]) -> None:
        """Resume the split impulses of a saved state; added models do not start them again."""
        if end == SPLIT_IMPULSES_NOT_BEGUN:
            return
        self._has_new_bodies, self._split_impulse_end = False, end
        self._new_trees.clear()
        self._parameters.split_impulses(end is not None)

    @property
    def held(self) -> Dict[int, RestPose]:
        """The poses of held bodies, by their first link rows."""
        return {tree.body.lead_row: tree.held for tree in self._trees.values()
                if tree.held is not None}

    def hold(self, body: Body, place: RestPose) -> None:
        """Hold an articulated body at a pose, as if it had stood still long enough."""
        tree = self._trees[body.uid]
        tree.still_checks = _CHECKS_UNTIL_HELD + 1
        tree.held = place
        put_at_rest(body, place)
        self._notify(BodyEvent.FIXED_AT_REST, body)

    def due(self, step: int) -> int:
        """The next step if a body was added, otherwise the step of the next check."""
        if self._has_new_bodies:
            return step
        if self._trees or self._split_impulse_end is not None:
            return next_multiple(step, EVERY)
        return next_multiple(step, _RIGID_EVERY) if self._rigid else FAR

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """Check periodically which bodies are at rest, and request the solver accuracy."""
        if self._has_new_bodies:
            self._has_new_bodies = False
            self._split_impulse_end = step + round(_SPLIT_IMPULSE_TIME / dt)
            self._parameters.split_impulses(True)
            # At once: an arm whose zero pose is past its limits may be inside the ground there.
            for tree in self._new_trees if step % EVERY else ():
                _correct_limits(tree.body, axis_states(tree.body))
            self._new_trees.clear()
        if step % EVERY:
            return
        if self._split_impulse_end is not None and (step >= self._split_impulse_end or (
                step % _OVERLAPS_EVERY == 0 and self._is_separated(step, dt))):
            self._split_impulse_end = None
            self._parameters.split_impulses(False)
        if step % _RIGID_EVERY == 0:
            self._rigid = {uid: body for uid, body in self._rigid.items() if not body.sleeps}
            self._leaning = any(_creeps(body) for body in self._rigid.values())
        standing = False
        for tree in self._trees.values():
            states = axis_states(tree.body)
            if tree.held is None:
                _correct_limits(tree.body, states)
            held = tree.held is not None
            standing = self._stands(tree, states) or standing
            if held != (tree.held is not None):
                self._notify(BodyEvent.RELEASED if held else BodyEvent.FIXED_AT_REST, tree.body)
        self._parameters.request_accuracy(
            _FOR_STANDING_ROBOTS if standing else
            _FOR_LEANING_BODIES if self._leaning else USUAL_ACCURACY)

    def _is_separated(self, step: int, dt: float) -> bool:
        """Whether no contact overlaps by more than `_TOLERATED_OVERLAP`."""
        assert self._split_impulse_end is not None
        begin = self._split_impulse_end - round(_SPLIT_IMPULSE_TIME / dt)
        if step < begin + round(_LEAST_TIME / dt):
            return False
        return all(contact[DISTANCE] > -_TOLERATED_OVERLAP
                   for contact in pybullet.getContactPoints())

    def _stands(self, tree: _Tree, states: Sequence[Sequence[Any]]) -> bool:
        """Whether an articulated body is slow, touches something, and is not held."""
        body = tree.body
        held, tree.held = tree.held, None
        fastest = max([abs(state[1]) for state in states], default=0.0)
        speed = 0.0 if body.base is None else _speed(body.uid)
        if speed > _SLOW_SPEED or fastest > _SLOW_RATE and held is None:
            tree.still_checks = 0
            return False
        if tree.skip:
            tree.skip -= 1
            return False
        contacts = pybullet.getContactPoints(bodyA=body.uid)
        if not contacts:
            tree.still_checks, tree.skip = 0, _SKIPPED if body.base is None else 0
            return False
        alone = not (body.ties or body.ball_joints or body.uid in self._loaded()
                     or any(contact[OTHER_BODY] in self._moving for contact in contacts))
        if held is not None:
            if alone and speed < _PUSHED_SPEED and fastest < _PUSHED_RATE:
                tree.held = held
                put_at_rest(body, held)
                return False
            tree.still_checks = 0
        elif (alone and speed < _STILL_SPEED and fastest < _STILL_RATE
              and not self._is_driven(body, states)):
            tree.still_checks += 1
            if tree.still_checks > _CHECKS_UNTIL_HELD:
                tree.held = read_rest_pose(body, states)
                put_at_rest(body, tree.held)
                return False
        else:
            tree.still_checks = 0
        return True

    def _is_driven(self, body: Body, states: Sequence[Sequence[Any]]) -> bool:
        """Whether a motor or a servo moves an axis, however slowly.

        A blocked axis, as of a wheel against a wall, stays below a tenth of its commanded rate.
        """
        for axis, (_, rate, *_) in zip(body.axes, states):
            wanted = self._driven(axis.row)
            if wanted and abs(rate) > _MOVING_SHARE * abs(wanted):
                return True
        return False


def _correct_limits(body: Body, states: Sequence[Sequence[Any]]) -> None:
    """Move joints that are past a limit towards it, with unchanged rates."""
    for axis, (position, rate, *_) in zip(body.axes, states):
        past = position - min(max(position, axis.lower), axis.upper)
        if abs(past) > _PAST_LIMIT:
            pybullet.resetJointState(body.uid, axis.index, position - _CORRECTION * past, rate)


def _creeps(body: Body) -> bool:
    """Whether a rigid body is slow, and small or partly held by friction."""
    uid = body.uid
    if _speed(uid) > _SLOW_SPEED:
        return False
    if body.radius < _SMALL_RADIUS:
        return True
    normal = along = across = 0.0
    for contact in pybullet.getContactPoints(bodyA=uid):
        normal += contact[LOAD]
        along += abs(contact[FRICTION])
        across += abs(contact[FRICTION_2])
    return max(along, across) > _LEANING_RATIO * normal


def _speed(uid: int) -> float:
    """Return the largest component of a body's velocities, m/s or rad/s."""
    linear, angular = pybullet.getBaseVelocity(uid)
    return max(map(abs, (*linear, *angular)))
