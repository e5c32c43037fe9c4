"""What keeps standing things where they stand.

After something was put into the world overlaps are parted without giving velocity, for a second at
most: with split impulses Bullet moves rigid bodies apart and leaves their momentum alone, so that a
body that starts in a shelf does not jump out of it, and one with a large moment of inertia does not
turn on for ever. Their price is that Bullet forgets to put joints back that went past their stops,
so that is done here, without velocity too.

With that, contacts may begin with 0.99 of the impulse that they had in the step before. The split
impulses end once nothing is deep: with them a stack of ten boxes leans by 1 mm a second, and a wall
of 200 bricks moves 1.7 mm in one (measured).

Bullet ends its iterations once no row changes a velocity by more than sqrt(1e-7) m/s, at which a
thing that stands may drift. Contacts of articulated bodies start from nothing in each step (there
is no warm start for them): a parked robot went 1 mm and 0.8 degrees in a minute, or slid where its
wheels were not solved in 50 iterations (measured). While one that touches something is slow, the
world is solved to 3e-8 m/s and with more iterations, which takes five times as long. One that has
then stood still for half a second, that nothing acts on but gravity and static bodies, and of which
no motor moves an axis, is held: put back with its joints every 16 steps, at rest. Until something
touches it, the world is solved as if it were not there. Rigid bodies that may not sleep, or that a
force or a tie keeps awake, creep where friction holds them; while there are such, it is solved to
3e-6 m/s. What moves, sleeps, or stands on the level costs nothing. Small ones that may not sleep
creep on the level too, for which 3e-4 m/s is much: twenty cards of 2 mm went 2.7 mm apart in 20 s,
solved so 0.3 mm.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Callable, Dict, List, Optional, Sequence, Set

import pybullet

from ...geometry import Vec3
from ..run_state import PARTING_NOT_BEGUN, RestPlace
from .bodies import Body
from .body_events import COMMANDED, BodyEvent
from .rest_place import put_at_rest, read_place
from .step_helper import FAR, StepHelper, next_multiple
from .world_parameters import USUAL_ACCURACY, Accuracy, WorldParameters

JointStates = Sequence[Any]  # as PyBullet tells them

EVERY = 16            # steps between two looks at articulated bodies
_RIGID_EVERY = 256    # and at rigid ones, of which there may be hundreds
_SLOW = 0.02          # m/s and rad/s: of the base, and of all joints
_STILL = 2e-5         # m/s and rad/s, of the base: more is a motion of its own
_STILL_JOINT = 3e-4   # rad/s or m/s: of a wheel of 6 cm whose base creeps so fast
_CLEAR = 3            # looks
_STANDS = 32          # looks: to be held, an acceleration must be below 4e-5 m/s^2
_PUSHED = 2e-3        # m/s and rad/s, of the base: one that is held has less between two looks
_PUSHED_JOINT = 0.05  # rad/s or m/s
_ON_ITS_WAY = 0.1     # share of the rate that is wanted of an axis
_LEANS = 0.02         # friction by normal force
_SMALL = 0.06         # m, radius: such a body creeps on the level too
_FOR_LEANING_BODIES = Accuracy(residual=1e-11)
_FOR_STANDING_ROBOTS = Accuracy(4, 1e-15)
_PARTING = 1.0        # s, at most
_LEAST = 0.1          # s, at least: what is put down a little higher has landed
_SHALLOW = 1e-4       # m: overlaps that may part with velocity
_OVERLAPS_EVERY = 64  # steps between two looks at them
_PAST_STOP = 1e-6     # rad or m past a stop that do not matter
_PUT_BACK = 0.5       # share of the way back to the stop at each look


@dataclass
class _Tree:
    """An articulated body.

    Attributes:
        indices: of its axes.
        looks: in a row at which it stood still.
        clear: looks for which an arm that touched nothing need not be asked what it touches.
        held: where its base, if it has a free one, and its axes are put back to; None: it is not.
    """

    body: Body
    indices: List[int]
    looks: int = 0
    clear: int = 0
    held: Optional[RestPlace] = None


class ContactSettling(StepHelper):
    """Chooses how exactly Bullet solves, and holds robots that stand.

    Args:
        parameters: of the world.
        loaded: tells the bodies that timed forces act on in this step.
        driven: tells the rate to which the axis of a row is driven; 0 for none.
        notify: is called when a body is fixed at rest, or released.
    """

    events = COMMANDED

    def __init__(self, parameters: WorldParameters, loaded: Callable[[], Set[int]],
                 driven: Callable[[int], float], notify: Callable[[BodyEvent, Body], None]) -> None:
        self._parameters = parameters
        self._loaded, self._driven, self._notify = loaded, driven, notify
        self._trees: Dict[int, _Tree] = {}
        self._moving: Set[int] = set()
        self._rigid: Dict[int, Body] = {}     # awake, or reached by a command since the last look
        self._leaning = False
        self._parting_steps, self._least_steps = 1000, 100
        self._new = False                     # something was put in since the last look
        self._arrived: List[_Tree] = []       # of that, what has axes
        self._until: Optional[int] = None     # the step at which split impulses end

    def configure(self, dt: float) -> None:
        """Use steps of `dt` s."""
        self._parting_steps, self._least_steps = round(_PARTING / dt), round(_LEAST / dt)

    def add(self, body: Body) -> None:
        """Know a body; only articulated ones and those that may not sleep matter."""
        self._new = True
        if body.moves:
            self._moving.add(body.uid)
        if body.moves and not body.rigid:
            tree = _Tree(body, [axis.index for axis in body.axes])
            self._trees[body.uid] = tree
            self._arrived.append(tree)
        elif body.moves and not body.sleeps:
            self._rigid[body.uid] = body

    def forget(self, body: Body) -> None:
        """A body is gone."""
        self._trees.pop(body.uid, None)
        self._arrived = [tree for tree in self._arrived if tree.body is not body]
        self._moving.discard(body.uid)
        self._rigid.pop(body.uid, None)
        if not self._trees and not self._rigid:
            self._leaning = False
            self._parameters.request_accuracy(USUAL_ACCURACY)

    def clear(self) -> None:
        """All bodies are gone."""
        self._trees.clear()
        self._arrived.clear()
        self._moving.clear()
        self._rigid.clear()
        self._leaning = False
        self._new, self._until = False, None

    def handle_event(self, event: BodyEvent, body: Body) -> None:
        """A command reached a body: it may move from now on, or may not sleep any more."""
        if body.rigid and body.moves:
            self._rigid[body.uid] = body
        tree = self._trees.get(body.uid)
        if tree is not None:
            held, tree.held = tree.held, None
            tree.looks, tree.clear = 0, 0
            if held is not None:
                self._notify(BodyEvent.RELEASED, body)

    @property
    def parting_end(self) -> Optional[int]:
        """See `RunState.parting_end`."""
        return PARTING_NOT_BEGUN if self._new else self._until

    def resume_parting(self, end: Optional[int]) -> None:
        """Part overlaps as at the time of a saved state, not as of models just put in."""
        if end == PARTING_NOT_BEGUN:
            return
        self._new, self._until = False, end
        self._arrived.clear()
        self._parameters.split_impulses(end is not None)

    @property
    def held(self) -> Dict[int, RestPlace]:
        """Where bodies are held, by their first link rows."""
        return {tree.body.lead_row: tree.held for tree in self._trees.values()
                if tree.held is not None}

    def hold(self, body: Body, place: RestPlace) -> None:
        """Hold an articulated body at a place, like one that has stood still for long."""
        tree = self._trees[body.uid]
        tree.looks = _STANDS + 1
        tree.held = place
        put_at_rest(body, place)
        self._notify(BodyEvent.FIXED_AT_REST, body)

    def due(self, step: int) -> int:
        """At once when something was put in, else the next look."""
        if self._new:
            return step
        if self._trees or self._until is not None:
            return next_multiple(step, EVERY)
        return next_multiple(step, _RIGID_EVERY) if self._rigid else FAR

    def before(self, step: int, dt: float, gravity: Vec3) -> None:
        """See now and then whether something stands."""
        if self._new:
            self._new, self._until = False, step + self._parting_steps
            self._parameters.split_impulses(True)
            # At once: an arm whose zero pose is past its stops may stand in the ground there.
            for tree in self._arrived if step % EVERY else ():
                _put_back(tree.body, _states(tree))
            self._arrived.clear()
        if step % EVERY:
            return
        if self._until is not None and (step >= self._until or (
                step % _OVERLAPS_EVERY == 0 and self._is_parted(step))):
            self._until = None
            self._parameters.split_impulses(False)
        if step % _RIGID_EVERY == 0:
            self._rigid = {uid: body for uid, body in self._rigid.items() if not body.sleeps}
            self._leaning = any(_creeps(body) for body in self._rigid.values())
        standing = False
        for tree in self._trees.values():
            states = _states(tree)
            if tree.held is None:
                _put_back(tree.body, states)
            held = tree.held is not None
            standing = self._stands(tree, states) or standing
            if held != (tree.held is not None):
                self._notify(BodyEvent.RELEASED if held else BodyEvent.FIXED_AT_REST, tree.body)
        self._parameters.request_accuracy(
            _FOR_STANDING_ROBOTS if standing else
            _FOR_LEANING_BODIES if self._leaning else USUAL_ACCURACY)

    def _is_parted(self, step: int) -> bool:
        """Whether nothing lies deep in anything else any more."""
        assert self._until is not None
        if step < self._until - self._parting_steps + self._least_steps:
            return False
        return all(contact[8] > -_SHALLOW for contact in pybullet.getContactPoints())

    def _stands(self, tree: _Tree, states: JointStates) -> bool:
        """Whether an articulated body is slow, touches something, and is not held."""
        body = tree.body
        held, tree.held = tree.held, None
        fastest = max([abs(state[1]) for state in states], default=0.0)
        speed = 0.0 if body.base is None else _speed(body.uid)
        if speed > _SLOW or fastest > _SLOW and held is None:
            tree.looks = 0
            return False
        if tree.clear:
            tree.clear -= 1
            return False
        contacts = pybullet.getContactPoints(bodyA=body.uid)
        if not contacts:
            tree.looks, tree.clear = 0, _CLEAR if body.base is None else 0
            return False
        alone = not (body.ties or body.balls or body.uid in self._loaded()
                     or any(contact[2] in self._moving for contact in contacts))
        if held is not None:
            if alone and speed < _PUSHED and fastest < _PUSHED_JOINT:
                tree.held = held
                put_at_rest(body, held)
                return False
            tree.looks = 0
        elif (alone and speed < _STILL and fastest < _STILL_JOINT
              and not self._is_driven(body, states)):
            tree.looks += 1
            if tree.looks > _STANDS:
                tree.held = read_place(body, states)
                put_at_rest(body, tree.held)
                return False
        else:
            tree.looks = 0
        return True

    def _is_driven(self, body: Body, states: JointStates) -> bool:
        """Whether a motor or a servo moves an axis: slow as it is, it is on its way.

        One that is blocked, as a wheel against a wall, has none of the rate that it is to have.
        """
        for axis, (_, rate, *_) in zip(body.axes, states):
            wanted = self._driven(axis.row)
            if wanted and abs(rate) > _ON_ITS_WAY * abs(wanted):
                return True
        return False


def _states(tree: _Tree) -> JointStates:
    """Of its axes."""
    found: JointStates = pybullet.getJointStates(tree.body.uid, tree.indices) or ()
    return found


def _put_back(body: Body, states: JointStates) -> None:
    """Move joints that are past a stop towards it, their rates unchanged."""
    for axis, (position, rate, *_) in zip(body.axes, states):
        past = position - min(max(position, axis.lower), axis.upper)
        if abs(past) > _PAST_STOP:
            pybullet.resetJointState(body.uid, axis.index, position - _PUT_BACK * past, rate)


def _creeps(body: Body) -> bool:
    """A rigid body is slow, and small, or friction carries a share of its weight."""
    uid = body.uid
    if _speed(uid) > _SLOW:
        return False
    if body.radius < _SMALL:
        return True
    normal = along = across = 0.0
    for contact in pybullet.getContactPoints(bodyA=uid):
        normal += contact[9]
        along += abs(contact[10])
        across += abs(contact[12])
    return max(along, across) > _LEANS * normal


def _speed(uid: int) -> float:
    """The largest part of the velocities of a body, m/s or rad/s."""
    linear, angular = pybullet.getBaseVelocity(uid)
    return max(map(abs, (*linear, *angular)))
