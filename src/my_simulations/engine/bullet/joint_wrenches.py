"""Compute the wrenches that joints transmit, by d'Alembert's principle.

The wrench of a joint on its outboard links is their inertial wrench minus all other forces on them:
gravity, contacts, external wrenches, and constraints to other links. Bullet's own joint sensors are
not used (doc/dev/contacts.md, "Joint wrenches").

The last step before a read-out is measured, including all helpers that act before and after it. So
the forces of a model that is held or moved by command match its visible motion.

Bullet computes joint accelerations from the forces in the configuration at the start of a step. The
difference of a link's world velocities over the step also contains the rotation of the links in it.
This error is proportional to the step size (1 % of the torques of an arm in fast motion). So the
accelerations at the start are computed link by link, from the root. Each link adds the change of
its velocity relative to its parent, in the parent's axes.
"""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from ...description.model import Joint
from ...geometry import (
    IDENTITY,
    IDENTITY_QUAT,
    ZERO3,
    Pose,
    Vec3,
    add,
    compose,
    conjugate,
    cross,
    inverse,
    multiply,
    rotate,
    scale,
    subtract,
    transform,
)
from ..body_plan import BASE, NO_LINK, TreeLink
from ..commands import JointWrench, ReadJointWrenches
from .acting_forces import Acting, constraint_forces, note, note_constraints, note_contacts
from .bodies import Body, Part
from .body_events import BodyObserver
from .forces import Forces
from .joint_constraints import Constraint
from .link_states import AT_REST, Motion, link_motions
from .state_restore import Entry
from .wheel_friction import WheelFriction

MEASURED_STEPS = 100_000
"""Steps without a reading after which a joint is no longer measured."""

JointKey = Tuple[int, str]
"""The number of a model, and the name of one of its joints."""


_Links = Tuple[Tuple[Part, Optional[Part], Vec3], ...]
"""The links of a body, parents first: each with its parent and the position of its joint.

The position is relative to the link's centre of mass, in its principal axes, m. The parent of
a root, and of the first links on a fixed base, is None.
"""


class _Acceleration(NamedTuple):
    """Accelerations of the centre of mass, m/s^2, and angular, rad/s^2; world axes."""

    linear: Vec3 = ZERO3
    angular: Vec3 = ZERO3


@dataclass(frozen=True)
class _MeasuredJoint:
    """A joint, and its outboard links.

    Attributes:
        body: the body that the joint is in.
        links: the links of the body.
        joint: the description of the joint.
        child, parent: the parts at its ends; None for the world.
        outboard: the parts of its outboard links, the link at the joint first.
    """

    body: Body
    links: _Links
    joint: Joint
    child: Optional[Part]
    parent: Optional[Part]
    outboard: List[Part]


@dataclass
class _BodyStates:
    """The state of a body before and after a step.

    Attributes:
        before, after: motions of its links, by PyBullet's index.
        outside: forces on it, except gravity. Forces that Bullet reports are added at the first
            reading: Bullet keeps them until the next step.
        accelerations: of its links; computed when needed.
    """

    body: Body
    links: _Links
    before: Dict[int, Motion]
    after: Dict[int, Motion]
    outside: Acting
    accelerations: Optional[Dict[int, _Acceleration]] = None

    def compute(self, dt: float) -> Dict[int, _Acceleration]:
        """Return the accelerations, with all forces in `outside`."""
        if self.accelerations is None:
            note_contacts(self.outside, self.body)
            note_constraints(self.outside, self.body, self.before)
            self.accelerations = _accelerations(self.links, self.before, self.after, dt)
        return self.accelerations


class JointWrenches(BodyObserver):
    """Measures the joints whose wrenches are read."""

    def __init__(self, models: Mapping[int, Entry], forces: Forces, friction: WheelFriction,
                 steps_left: Dict[JointKey, int]) -> None:
        """`steps_left`: for how many more steps each joint is measured; a reset keeps it."""
        self._models = models
        self._forces = forces
        self._friction = friction
        self._joints: Dict[JointKey, _MeasuredJoint] = {}
        self._steps_left = steps_left
        self._states: Dict[int, _BodyStates] = {}
        self._wrenches: Dict[JointKey, Optional[JointWrench]] = {}
        self._dt = 0.0
        self._gravity = ZERO3

    @property
    def idle(self) -> bool:
        """True if no joint is measured."""
        return not self._steps_left

    def read(self, command: ReadJointWrenches) -> Tuple[Optional[JointWrench], ...]:
        """Return the wrenches of the last step, and measure these joints in the next steps."""
        for key in command.joints:
            self._steps_left[key] = MEASURED_STEPS
            measured = self._joints.get(key)
            states = None if measured is None else self._states.get(measured.body.uid)
            if key not in self._wrenches and measured is not None and states is not None:
                self._wrenches[key] = self._wrench(measured, states)
            elif key[0] in self._models and measured is None:
                self._wrenches[key] = _wrench_without_links(self._models[key[0]], key[1])
        return tuple(self._wrenches.get(key) for key in command.joints)

    def forget(self, body: Body) -> None:
        for table in (self._joints, self._steps_left, self._wrenches):
            for key in [key for key in table if key[0] == body.model_id]:
                del table[key]
        self._states.pop(body.uid, None)

    # -- a step ------------------------------------------------------------------------------------

    def before(self, steps: int) -> None:
        """Record the states before the last of `steps` steps, before any helper acts."""
        for key in list(self._steps_left):
            self._steps_left[key] -= steps
            measured = self._joints.get(key) or self._find_joint(key)
            if measured is None or self._steps_left[key] < 0:
                del self._steps_left[key]
                self._joints.pop(key, None)
            else:
                self._joints[key] = measured
        self._wrenches.clear()
        self._states.clear()
        for measured in self._joints.values():
            body = measured.body
            if body.uid not in self._states:
                now = link_motions(body)
                self._states[body.uid] = _BodyStates(body, measured.links, now, now, {})

    def after(self, dt: float, gravity: Vec3) -> None:
        """Record the states after that step, after all helpers have acted."""
        self._dt, self._gravity = dt, gravity
        for states in self._states.values():
            states.after = link_motions(states.body)
            owners = states.body.owners
            for index, force, at in self._friction.forces_on(states.body.uid):
                note(states.outside, owners.get(index, index), force, at)
            for part in states.body.parts if self._forces.wrenched_links else ():
                force, torque = self._forces.acting_on(part.row)
                at = states.before[part.index].position
                note(states.outside, part.index, force, at, torque)

    def _wrench(self, measured: _MeasuredJoint, states: _BodyStates) -> Optional[JointWrench]:
        """Return the wrench of a joint; None if a state is not finite."""
        before, found = states.before, states.compute(self._dt)
        child, parent = _link_pose(measured.child, before), _link_pose(measured.parent, before)
        anchor = _origin(measured.joint, measured.child, child, measured.parent, parent)
        force, torque = ZERO3, ZERO3
        for part in measured.outboard:
            state = before[part.index]
            pull, turn = _inertial_wrench(part, state, found[part.index],
                                          self._gravity if part.link.gravity else ZERO3)
            force = add(force, pull)
            torque = add(torque, add(turn, cross(subtract(state.position, anchor), pull)))
            for outer, at, moment in states.outside.get(part.index, ()):
                force = subtract(force, outer)
                torque = subtract(torque, add(moment, cross(subtract(at, anchor), outer)))
        if not all(map(math.isfinite, (*force, *torque))):
            return None
        if measured.child is not measured.outboard[0]:
            force, torque = subtract(ZERO3, force), subtract(ZERO3, torque)
        return _in_child(force, torque, child, None if measured.parent is None else parent)

    def _find_joint(self, key: JointKey) -> Optional[_MeasuredJoint]:
        """Return a joint of a tree; None for other joints."""
        entry = self._models.get(key[0])
        if entry is None:
            return None
        for plan, body in zip(entry.builder.plans, entry.bodies):
            for n, node in enumerate(plan.links):
                if node.index != NO_LINK and node.joint is not None and node.joint.name == key[1]:
                    parts = {part.row - entry.first_row: part for part in body.parts}
                    return _joint_at(node.joint, body, parts, plan.links, n)
        return None


def _joint_at(joint: Joint, body: Body, parts: Mapping[int, Part], links: Sequence[TreeLink],
              n: int) -> _MeasuredJoint:
    """Return the parent joint of link `n` of a body; `parts` by the link's index in the model."""
    named = {part.link.name: part for part in body.parts}
    within = {n}
    for m in range(n + 1, len(links)):      # parents come before children
        if links[m].parent in within:
            within.add(m)
    outboard = [parts[links[m].index] for m in sorted(within) if links[m].index != NO_LINK]
    return _MeasuredJoint(body, _links_of(parts, links), joint, named.get(joint.child),
                          named.get(joint.parent), outboard)


def _origin(joint: Joint, child: Optional[Part], child_pose: Pose, parent: Optional[Part],
            parent_pose: Pose) -> Vec3:
    """Return the origin of a joint, m; it is fixed to the child, or to the parent of the world."""
    if child is not None:
        return transform(child_pose, joint.pose.position)
    assert parent is not None
    return transform(compose(parent_pose, inverse(parent.link.pose)), joint.pose.position)


def _wrench_without_links(entry: Entry, name: str) -> Optional[JointWrench]:
    """Return the wrench of a joint without outboard links: in a loop, or of a static model."""
    joint = next((one for one in entry.model.joints if one.name == name), None)
    constraints = entry.constraints.closing.get(name, [])
    if joint is not None and entry.model.static:
        return JointWrench()   # nothing holds its links (Gazebo behaviour)
    return _closing_wrench(entry, joint, constraints) if joint and constraints else None


def _closing_wrench(entry: Entry, joint: Joint, constraints: Sequence[Constraint]) -> JointWrench:
    """Return the wrench of a loop-closing joint from its constraints."""
    ends = [entry.constraints.links.get(name) for name in (joint.child, joint.parent)]
    child, parent = (None if end is None else end[1] for end in ends)
    poses = [IDENTITY if end is None else _link_pose(end[1], link_motions(end[0]))
             for end in ends]
    held, sign = (ends[0], 1.0) if ends[0] is not None else (ends[1], -1.0)
    assert held is not None
    link = link_motions(held[0])[held[1].index]
    anchor = _origin(joint, child, poses[0], parent, poses[1])
    force, torque = ZERO3, ZERO3
    for constraint in constraints:
        one, at, moment = constraint_forces(constraint.uid, held[0], held[1].index, link)
        force = add(force, one)
        torque = add(torque, add(moment, cross(subtract(at, anchor), one)))
    return _in_child(scale(force, sign), scale(torque, sign), poses[0],
                     None if ends[1] is None else poses[1])


def _in_child(force: Vec3, torque: Vec3, child: Pose, parent: Optional[Pose]) -> JointWrench:
    """Turn a wrench from world axes into those of the child; `parent` None: the world."""
    back = conjugate(child.orientation)
    return JointWrench(rotate(back, force), rotate(back, torque), IDENTITY_QUAT if parent is None
                       else multiply(conjugate(parent.orientation), child.orientation))


def _link_pose(part: Optional[Part], found: Dict[int, Motion]) -> Pose:
    """Return the pose of a link frame; the world frame for None."""
    if part is None:
        return IDENTITY
    state = found[part.index]
    return compose(Pose(state.position, state.orientation), inverse(part.link_from_com))


def _links_of(parts: Mapping[int, Part], links: Sequence[TreeLink]) -> _Links:
    """Return the links of a body; `parts` by the link's index in the model."""
    found: List[Tuple[Part, Optional[Part], Vec3]] = []
    for link in links:
        if link.index == NO_LINK:
            continue
        above = link.parent
        while above != BASE and links[above].index == NO_LINK:
            above = links[above].parent
        part = parts[link.index]
        found.append((part, None if above == BASE else parts[links[above].index],
                      transform(inverse(part.link_from_com), link.link_from_frame.position)))
    return tuple(found)


def _accelerations(links: _Links, before: Mapping[int, Motion], after: Mapping[int, Motion],
                   dt: float) -> Dict[int, _Acceleration]:
    """Return the accelerations of all links at the start of a step of `dt` s, by index."""
    found: Dict[int, _Acceleration] = {}
    for part, parent, joint in links:
        state, later = before[part.index], after[part.index]
        if parent is None and part.index == BASE:
            found[BASE] = _Acceleration(scale(subtract(later.linear, state.linear), 1.0 / dt),
                                       scale(subtract(later.angular, state.angular), 1.0 / dt))
            continue
        over, over_later, above = (AT_REST, AT_REST, _Acceleration()) if parent is None else (
            before[parent.index], after[parent.index], found[parent.index])
        sliding, turning = _against(over, state, joint)
        sliding_later, turning_later = _against(over_later, later, joint)
        gain = rotate(over.orientation, scale(subtract(sliding_later, sliding), 1.0 / dt))
        twist = rotate(over.orientation, scale(subtract(turning_later, turning), 1.0 / dt))
        arm = rotate(state.orientation, joint)          # from the centre of mass to the joint
        reach = subtract(add(state.position, arm), over.position)
        angular = add(above.angular, add(twist, cross(over.angular,
                                                      subtract(state.angular, over.angular))))
        linear = add(above.linear, _about(above.angular, over.angular, reach))
        drift = rotate(over.orientation, sliding)
        linear = add(linear, add(gain, scale(cross(over.angular, drift), 2.0)))
        linear = subtract(linear, _about(angular, state.angular, arm))
        found[part.index] = _Acceleration(linear, angular)
    return found


def _inertial_wrench(part: Part, state: Motion, acceleration: _Acceleration,
                     gravity: Vec3) -> Tuple[Vec3, Vec3]:
    """Return the wrench, without gravity, that gives a link its acceleration.

    Force, N, and torque about the centre of mass, N m, world axes.
    """
    back = conjugate(state.orientation)
    spin, gain = rotate(back, state.angular), rotate(back, acceleration.angular)
    a, b, c = part.moments
    momentum = (a * spin[0], b * spin[1], c * spin[2])
    torque = add((a * gain[0], b * gain[1], c * gain[2]), cross(spin, momentum))
    return (scale(subtract(acceleration.linear, gravity), part.mass),
            rotate(state.orientation, torque))


def _against(over: Motion, state: Motion, joint: Vec3) -> Tuple[Vec3, Vec3]:
    """Return the linear and angular velocity of a joint relative to the parent, in its axes."""
    arm = rotate(state.orientation, joint)
    reach = subtract(add(state.position, arm), over.position)
    sliding = subtract(add(state.linear, cross(state.angular, arm)),
                       add(over.linear, cross(over.angular, reach)))
    back = conjugate(over.orientation)
    return rotate(back, sliding), rotate(back, subtract(state.angular, over.angular))


def _about(angular: Vec3, rate: Vec3, arm: Vec3) -> Vec3:
    """Return the acceleration of a point of a body relative to another one, `arm` away."""
    return add(cross(angular, arm), cross(rate, cross(rate, arm)))
