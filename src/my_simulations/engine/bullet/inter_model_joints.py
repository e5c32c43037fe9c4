"""Joints between links of different models, or between a rigid body and the world.

Constraints hold them, so limits, friction, damping, springs and motors of their axes do not act.
Tied bodies do not sleep, and those that are tied to each other do not collide (Gazebo behaviour).
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import Dict, List, Optional, Sequence, Set, Tuple

import pybullet

from ...geometry import IDENTITY
from ..api import CommandRefusedError, RemovedError
from ..body_plan import BASE, TIE_TYPES
from ..commands import ConnectModels
from .bodies import Body, Part, set_sleep
from .body_events import BodyObserver
from .constraint_book import ConstraintBook, Number
from .joint_constraints import End, connect_links


@dataclass
class _Tie:
    name: str
    ends: Tuple[End, ...]
    constraints: List[Number]

    @property
    def bodies(self) -> Tuple[Body, ...]:
        return tuple(end[0] for end in self.ends)

    @property
    def uids(self) -> Set[int]:
        """PyBullet's numbers of the bodies that are tied."""
        return {body.uid for body in self.bodies}


class InterModelJoints(BodyObserver):
    """The joints that go with either of the models they connect."""

    def __init__(self, book: ConstraintBook) -> None:
        self._book = book
        self._ties: List[_Tie] = []
        self._anchor: Optional[End] = None

    def connect(self, command: ConnectModels, rows: Dict[int, End]) -> None:
        """Tie two links. Raises `CommandRefusedError`."""
        joint = command.joint
        if joint.type not in TIE_TYPES:
            raise CommandRefusedError(
                f"joint '{joint.name}' of type {joint.type} cannot connect two models"
            )
        ends = [(command.child_row, command.child_from_joint),
                (command.parent_row, command.parent_from_joint)]
        ends.sort(key=lambda end: end[0] < 0)  # the world last
        if ends[0][0] not in rows or not (ends[1][0] < 0 or ends[1][0] in rows):
            raise RemovedError(f"a link of joint '{joint.name}' no longer exists")
        one = rows[ends[0][0]]
        other = rows[ends[1][0]] if ends[1][0] >= 0 else self._world()
        if joint.type == "prismatic" and (one[0].rigid or other[0].rigid):
            raise CommandRefusedError(
                f"joint '{joint.name}' slides between bodies that are not articulated"
            )
        made = connect_links(self._book, joint, one, ends[0][1], other, ends[1][1])
        found = _Tie(joint.name, tuple(end for end in (one, other) if end is not self._anchor),
                     made)
        self._ties.append(found)
        _restore_collisions(found, False)
        for body in found.bodies:
            body.ties += 1
            if body.ties == 1:
                set_sleep(body)

    def _world(self) -> End:
        """An immovable body without a shape: PyBullet ties rigid bodies to bodies only."""
        if self._anchor is None:
            uid = pybullet.createMultiBody(0.0)
            part = Part(-1, BASE, IDENTITY, 0.0, (0.0, 0.0, 0.0), 0.0, 0.0, False)
            self._anchor = Body(uid, -1, [part], moves=False, rigid=False, may_sleep=False), part
        return self._anchor

    def forget(self, body: Body) -> None:
        """A body goes: untie it from the others."""
        if not body.ties:
            return
        for one in [one for one in self._ties if body.uid in one.uids]:
            self._disconnect(one)
            # Bullet keeps pairs that do not collide by numbers, which the next body gets.
            _restore_collisions(one, True)

    def disconnect(self, names: Sequence[str]) -> List[Body]:
        """Untie joints by name; returns the bodies that are free, which collide again."""
        found = [one for one in self._ties if one.name in names]
        for one in found:
            self._disconnect(one)
            if not any(other.uids == one.uids for other in self._ties):
                _restore_collisions(one, True)
        return [body for one in found for body in one.bodies]

    def _disconnect(self, one: _Tie) -> None:
        self._ties.remove(one)
        self._book.remove(one.constraints)
        for tied in one.bodies:
            tied.ties -= 1
            if not tied.ties:
                set_sleep(tied)


def _restore_collisions(one: _Tie, collide: bool) -> None:
    if len(one.ends) < 2:
        return
    (body, part), (other, its) = one.ends
    for uid in body.uids:
        for near in other.uids:
            pybullet.setCollisionFilterPair(uid, near, part.index, its.index, int(collide))
