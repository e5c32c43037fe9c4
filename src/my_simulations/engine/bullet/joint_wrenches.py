"""Compute the wrenches that joints transmit, by d'Alembert's principle.

The wrench of a joint on its outboard links is their inertial wrench minus all other forces on them:
gravity, contacts, external wrenches, and constraints to other links. Bullet's own joint sensors are
not used (doc/dev/contacts.md, "Joint wrenches").

The last step before a read-out is measured, including all helpers that act before and after it. So
the forces of a model that is held or moved by command match its visible motion.
"""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Dict, List, Mapping, Optional, Sequence, Tuple

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
from ..body_plan import NO_LINK, TreeLink
from ..commands import JointWrench, ReadJointWrenches
from .acting_forces import Acting, constraint_forces, note, note_constraints, note_contacts
from .bodies import Body, Part
from .body_events import BodyObserver
from .forces import Forces
from .link_motion import Acceleration, Chain, accelerations, inertial_wrench
from .link_states import Motion, link_motions
from .state_restore import Entry
from .wheel_friction import WheelFriction

FORGOTTEN = 100_000
"""Steps without a reading after which a joint is no longer measured."""

JointKey = Tuple[int, str]
"""The number of a model, and the name of one of its joints."""


@dataclass(frozen=True)
class _Cut:
    """A joint, and its outboard links.

    Attributes:
        body: the body that the joint is in.
        chain: its links.
        joint: its description.
        child, parent: the parts at its ends; None for the world.
        hung: the parts of its outboard links, the link at the joint first.
        parent_from_joint: its frame at position 0; used if the child is the world.
    """

    body: Body
    chain: Chain
    joint: Joint
    child: Optional[Part]
    parent: Optional[Part]
    hung: List[Part]
    parent_from_joint: Pose


class _Seen:
    """The state of a body before and after a step.

    Attributes:
        before, after: states of its links; Bullet keeps its contact forces until the next step.
        outside: forces on it, besides gravity, that Bullet does not report.
    """

    def __init__(self, body: Body, chain: Chain) -> None:
        self.body = body
        self.before = link_motions(body)
        self.after = self.before
        self.outside: Acting = {}
        self._chain = chain
        self._answer: Optional[_WorkedOut] = None

    def worked_out(self, dt: float) -> "_WorkedOut":
        """Return the states of its links, their accelerations, and the forces on them."""
        if self._answer is None:
            note_contacts(self.outside, self.body)
            note_constraints(self.outside, self.body, self.before)
            self._answer = (self.before,
                            accelerations(self._chain, self.before, self.after, dt), self.outside)
        return self._answer


_WorkedOut = Tuple[Dict[int, Motion], Dict[int, Acceleration], Acting]


class JointWrenches(BodyObserver):
    """Measures the joints whose wrenches are read."""

    def __init__(self, models: Mapping[int, Entry], forces: Forces, friction: WheelFriction,
                 wanted: Dict[JointKey, int]) -> None:
        """`wanted`: the measured joints, and for how many more steps; kept by a reset."""
        self._models = models
        self._forces = forces
        self._friction = friction
        self._cuts: Dict[JointKey, _Cut] = {}
        self._wanted = wanted
        self._seen: Dict[int, _Seen] = {}
        self._found: Dict[JointKey, Optional[JointWrench]] = {}
        self._dt = 0.0
        self._gravity = ZERO3

    @property
    def idle(self) -> bool:
        """True if no joint is measured."""
        return not self._wanted

    def read(self, command: ReadJointWrenches) -> Tuple[Optional[JointWrench], ...]:
        """Return the wrenches of the last step, and measure these joints in the next steps."""
        for key in command.joints:
            self._wanted[key] = FORGOTTEN
            cut = self._cuts.get(key)
            if key not in self._found and cut is not None and cut.body.uid in self._seen:
                self._found[key] = self._wrench(cut, self._seen[cut.body.uid])
            elif key[0] in self._models and cut is None:
                self._found[key] = _without_a_cut(self._models[key[0]], key[1])
        return tuple(self._found.get(key) for key in command.joints)

    def forget(self, body: Body) -> None:
        for table in (self._cuts, self._wanted, self._found):
            for key in [key for key in table if key[0] == body.model_id]:
                del table[key]
        self._seen.pop(body.uid, None)

    # -- a step ------------------------------------------------------------------------------------

    def before(self, steps: int) -> None:
        """Record the states before the last of `steps` steps, before any helper acts."""
        for key in list(self._wanted):
            self._wanted[key] -= steps
            cut = self._cuts.get(key) or self._cut(key)
            if cut is None or self._wanted[key] < 0:
                del self._wanted[key]
                self._cuts.pop(key, None)
            else:
                self._cuts[key] = cut
        self._found.clear()
        self._seen.clear()
        for cut in self._cuts.values():
            body = cut.body
            if body.uid not in self._seen:
                self._seen[body.uid] = _Seen(body, cut.chain)

    def after(self, dt: float, gravity: Vec3) -> None:
        """Record the states after that step, after all helpers have acted."""
        self._dt, self._gravity = dt, gravity
        for seen in self._seen.values():
            seen.after = link_motions(seen.body)
            owners = seen.body.owners
            for index, force, at in self._friction.forces_on(seen.body.uid):
                note(seen.outside, owners.get(index, index), force, at)
            for part in seen.body.parts if self._forces.wrenched_links else ():
                force, torque = self._forces.acting_on(part.row)
                at = seen.before[part.index].position
                note(seen.outside, part.index, force, at, torque)

    def _wrench(self, cut: _Cut, seen: _Seen) -> Optional[JointWrench]:
        """Return the wrench of a joint; None if a state is not finite."""
        before, motions, acting = seen.worked_out(self._dt)
        child, parent = _link_pose(cut.child, before), _link_pose(cut.parent, before)
        anchor = (transform(child, cut.joint.pose.position) if cut.child is not None
                  else transform(parent, cut.parent_from_joint.position))
        force, torque = ZERO3, ZERO3
        for part in cut.hung:
            state = before[part.index]
            pull, turn = inertial_wrench(part, state, motions[part.index],
                                         self._gravity if part.gravity else ZERO3)
            force = add(force, pull)
            torque = add(torque, add(turn, cross(subtract(state.position, anchor), pull)))
            for outer, at, moment in acting.get(part.index, ()):
                force = subtract(force, outer)
                torque = subtract(torque, add(moment, cross(subtract(at, anchor), outer)))
        if not all(map(math.isfinite, (*force, *torque))):
            return None
        if cut.child is not cut.hung[0]:
            force, torque = subtract(ZERO3, force), subtract(ZERO3, torque)
        back = conjugate(child.orientation)
        return JointWrench(rotate(back, force), rotate(back, torque),
                           IDENTITY_QUAT if cut.parent is None
                           else multiply(conjugate(parent.orientation), child.orientation))

    # -- joints ------------------------------------------------------------------------------------

    def _cut(self, key: JointKey) -> Optional[_Cut]:
        entry = self._models.get(key[0])
        if entry is None:
            return None
        for plan, body in zip(entry.builder.plans, entry.bodies):
            for n, node in enumerate(plan.links):
                if (node.joint is not None and node.joint.name == key[1]
                        and node.index != NO_LINK):
                    return _cut_at(entry, body, plan.links, n)
        return None


def _cut_at(entry: Entry, body: Body, links: Sequence[TreeLink], n: int) -> _Cut:
    joint = links[n].joint
    assert joint is not None
    parts = {part.row - entry.first_row: part for part in body.parts}
    poses = {entry.model.links[index].name: entry.model.links[index].pose for index in parts}
    names = {entry.model.links[index].name: part for index, part in parts.items()}
    within = {n}
    for m in range(n + 1, len(links)):      # parents come before children
        if links[m].parent in within:
            within.add(m)
    hung = [parts[links[m].index] for m in sorted(within) if links[m].index != NO_LINK]
    return _Cut(body, Chain.of(parts, links), joint, names.get(joint.child),
                names.get(joint.parent), hung,
                compose(inverse(poses.get(joint.parent, IDENTITY)), joint.pose))


def _without_a_cut(entry: Entry, name: str) -> Optional[JointWrench]:
    """Return the wrench of a joint without outboard links: in a loop, or of a static model."""
    joint = next((one for one in entry.model.joints if one.name == name), None)
    constraints = entry.constraints.closing.get(name, [])
    if joint is not None and entry.model.static:
        return JointWrench()   # nothing holds its links (Gazebo behaviour)
    return _closing_wrench(entry, joint, constraints) if joint and constraints else None


def _closing_wrench(entry: Entry, joint: Joint, constraints: Sequence[int]) -> JointWrench:
    """Return the wrench of a loop-closing joint from its constraints."""
    ends = [entry.constraints.end(joint.child), entry.constraints.end(joint.parent)]
    poses = [IDENTITY if end is None else _link_pose(end[1], link_motions(end[0]))
             for end in ends]
    held, sign = (ends[0], 1.0) if ends[0] is not None else (ends[1], -1.0)
    assert held is not None
    link = link_motions(held[0])[held[1].index]
    links = {link.name: link.pose for link in entry.model.links}
    anchor = (transform(poses[0], joint.pose.position) if ends[0] is not None
              else transform(compose(poses[1], inverse(links[joint.parent])),
                             joint.pose.position))
    force, torque = ZERO3, ZERO3
    for number in constraints:
        one, at, moment = constraint_forces(number, held[0], held[1].index, link)
        force = add(force, one)
        torque = add(torque, add(moment, cross(subtract(at, anchor), one)))
    back = conjugate(poses[0].orientation)
    return JointWrench(rotate(back, scale(force, sign)), rotate(back, scale(torque, sign)),
                       IDENTITY_QUAT if ends[1] is None
                       else multiply(conjugate(poses[1].orientation), poses[0].orientation))


def _link_pose(part: Optional[Part], found: Dict[int, Motion]) -> Pose:
    """Return the pose of a link frame; the world frame for None."""
    if part is None:
        return IDENTITY
    state = found[part.index]
    return compose(Pose(state.position, state.orientation), inverse(part.link_from_com))
