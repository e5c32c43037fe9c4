"""Read the states of bodies that may have moved.

PyBullet has no bulk read; the pose of a body costs about 1.2 us, its twist as much again. A rigid
body with exactly zero velocity at two consecutive reads is not read again until it is touched,
woken or commanded. A broad-phase query with a margin finds the resting bodies that a moving body
can touch. It is repeated after the moving body has covered the margin.
"""
from __future__ import annotations

import struct
from typing import Callable, Dict, List, Optional, Sequence, Set, Tuple

import numpy as np
import pybullet

from ...geometry import IDENTITY, STILL, Pose, Vec3, inverse
from ..body_plan import BASE
from ..ring import JOINT_WIDTH, JOINTS, LINK_WIDTH, LINKS
from .bodies import FASTEST_RATE, Body, axis_states
from .body_events import ACTUATED, COMMANDED, BodyEvent, BodyObserver
from .closing_joints import ClosingJoint
from .link_rows import ROW, link_row, place_row
from .link_states import motion, motions
from .wake_up import bodies_in, find_overlapping

_PLACE = struct.Struct("=7d")
_AXIS = struct.Struct("=2d")
_ROW_BYTES = ROW.size
_pose_of = pybullet.getBasePositionAndOrientation
_velocity_of = pybullet.getBaseVelocity
_MARGIN = 0.05     # m: motion of a body until its neighbours are searched again
_REACH = _MARGIN + 0.02   # m: how far from a body its neighbours are searched
_READ_ANYWAY = 8   # resting bodies read in each read-out, even without a neighbour


class StateReadout(BodyObserver):
    """The link and joint tables, kept up to date.

    Attributes:
        links: float64 array (LINKS, 13), rows as in the ring.
        joints: float64 array (JOINTS, 2).
    """

    events = COMMANDED | {BodyEvent.STATE_SET}

    def __init__(self, diverged: Callable[[Body], None],
                 reached_fastest_rate: Callable[[Body], None]) -> None:
        """`diverged` is called with a body whose state is not finite, and must move it back.

        `reached_fastest_rate` is called with a body of which a joint has the rate `FASTEST_RATE`.
        """
        self.links = np.zeros((LINKS, LINK_WIDTH))
        self.joints = np.zeros((JOINTS, JOINT_WIDTH))
        self.used_links = 0
        self.used_joints = 0
        self._diverged, self._reached_fastest_rate = diverged, reached_fastest_rate
        self._link_bytes = memoryview(self.links.data).cast("B")
        self._joint_bytes = memoryview(self.joints.data).cast("B")
        self._awake: Dict[int, Body] = {}
        self._trees: Dict[int, Body] = {}
        self._resting: Dict[int, Body] = {}
        self._neighbours: Dict[int, Tuple[Vec3, Set[int]]] = {}
        self._offsets: Dict[int, Pose] = {}
        self._unread: List[int] = []
        self._moved: Dict[int, Body] = {}
        self._stepped = False
        self._changed = False   # by `update`, since the last `read`
        self._closing: Dict[int, ClosingJoint] = {}

    def add_joints(self, rows: slice, closing: Sequence[ClosingJoint]) -> None:
        """Register a new model's rows of the joint table; `closing`: its joints without an axis."""
        self.used_joints = max(self.used_joints, rows.stop)
        self.joints[rows] = 0.0
        self._closing.update((one.row, one) for one in closing)

    def closes(self, row: int) -> bool:
        """Whether a row of the joint table is that of a joint that closes a loop."""
        return row in self._closing

    def forget_joints(self, rows: slice) -> None:
        """Discard the data of a removed model; its rows keep their values."""
        for row in range(rows.start, rows.stop):
            self._closing.pop(row, None)

    def add(self, body: Body) -> None:
        for part in body.parts:
            self.used_links = max(self.used_links, part.row + 1)
            if part.link_from_com != IDENTITY:
                self._offsets[part.row] = inverse(part.link_from_com)
            else:
                self._offsets.pop(part.row, None)
        self.mark_changed(body)

    def forget(self, body: Body) -> None:
        """Discard the data of a removed body; its rows keep their values."""
        for table in (self._awake, self._trees, self._resting, self._neighbours, self._moved):
            table.pop(body.uid, None)
        for part in body.parts:
            self._offsets.pop(part.row, None)

    def clear(self) -> None:
        """Discard the data of all bodies; their rows keep their values."""
        for table in (self._awake, self._trees, self._resting, self._neighbours, self._moved,
                      self._offsets, self._closing):
            table.clear()

    def handle_event(self, event: BodyEvent, body: Body) -> None:
        """Read a body until it rests again."""
        if event in ACTUATED:
            self._mark_awake(body)
        else:
            self.mark_changed(body)

    def mark_changed(self, body: Body) -> None:
        """Read a body with a new pose or velocity, also without a step, until it rests again."""
        self._moved[body.uid] = body
        self._mark_awake(body)

    def _mark_awake(self, body: Body) -> None:
        """Read a body after the next steps, until it rests again; its rows are correct now."""
        body.still_readouts = 0
        self._resting.pop(body.uid, None)
        self._neighbours.pop(body.uid, None)
        if body.rigid:
            self._awake[body.uid] = body
        else:
            self._trees[body.uid] = body

    def mark_stepped(self) -> None:
        """Read all awake bodies at the next read-out: steps are made before it."""
        self._stepped = True

    def read(self) -> bool:
        """Update the tables. Returns False if they are unchanged since the last call.

        Changes found by `update` in between are included.
        """
        self.update()
        changed, self._changed = self._changed, False
        return changed

    def update(self) -> None:
        """Update the tables; the next `read` returns whether they can have changed.

        Without a step since the last read-out, only bodies changed by commands are read. A body
        counts as at rest only after a step.
        """
        changed, self._moved = self._moved, {}
        rigid, trees = self._awake, self._trees
        if not self._stepped:
            rigid = {uid: body for uid, body in changed.items() if body.rigid}
            trees = {uid: body for uid, body in changed.items() if not body.rigid}
        if not rigid and not trees:
            self._stepped = False
            return
        self._changed = True
        self._read_all(list(rigid.values()))
        self._read_rest(trees)
        for one in self._closing.values():
            one.read(self.links, self.joints)
        self._stepped = False

    def _read_rest(self, trees: Dict[int, Body]) -> None:
        """Read trees and bodies that may have been woken."""
        for body in list(trees.values()):
            self._read_tree(body)
        if self._resting and self._stepped:
            self._read_woken()

    def read_poses(self) -> bool:
        """Update poses only; twists of rigid bodies stay those of the last `read`.

        The result of the next `read` does not change.
        """
        if not self._stepped and not self._moved:
            return self._changed
        self._read_places(list(self._awake.values()))
        self._read_rest(self._trees)
        return True

    def _read_places(self, todo: List[Body]) -> None:
        """Read the poses of rigid bodies, of the resting bodies that they have woken, and so on."""
        pack, table = _PLACE.pack_into, self._link_bytes
        offsets, resting = self._offsets, self._resting
        while todo:
            woken: List[Body] = []
            for body in todo:
                row = body.lead_row
                position, turn = _pose_of(body.uid)
                x, y, z = position
                total = x + y + z + turn[0] + turn[3]
                if total - total != 0.0:
                    self._diverged(body)
                    continue
                offset = offsets.get(row)
                if offset is None:
                    pack(table, row * _ROW_BYTES, x, y, z, *turn)
                else:
                    pack(table, row * _ROW_BYTES, *place_row(position, turn, offset)[0])
                if resting and not body.still_readouts:
                    woken.extend(self._woken_by(body.uid, position, body.radius))
            todo = woken

    def _read_all(self, todo: List[Body]) -> None:
        """Read rigid bodies, the resting bodies that they have woken, and so on.

        One loop without calls, because it takes most of the time of a read-out of many bodies.
        """
        pack, table = ROW.pack_into, self._link_bytes
        offsets, resting = self._offsets, self._resting
        while todo:
            woken: List[Body] = []
            for body in todo:
                uid, row = body.uid, body.lead_row
                position, turn = _pose_of(uid)
                linear, angular = _velocity_of(uid)
                (x, y, z), (vx, vy, vz), (wx, wy, wz) = position, linear, angular
                total = x + y + z + turn[0] + turn[3] + vx + vy + vz + wx + wy + wz
                if total - total != 0.0:
                    self._diverged(body)
                    continue
                offset = offsets.get(row)
                if offset is None:
                    pack(table, row * _ROW_BYTES, x, y, z, *turn, vx, vy, vz, wx, wy, wz)
                else:
                    pack(table, row * _ROW_BYTES,
                         *link_row(position, turn, linear, angular, offset))
                if (vz == 0.0 and (linear, angular) == STILL
                        and body.last_position == position):
                    self._count_still(body)
                    continue
                body.last_position = position
                body.still_readouts = 0
                if resting:
                    woken.extend(self._woken_by(uid, position, body.radius))
            todo = woken

    def _count_still(self, body: Body) -> None:
        """Count read-outs of a body without velocity; from the second one on it is at rest."""
        body.still_readouts += self._stepped
        if body.still_readouts >= 2:
            self._awake.pop(body.uid, None)
            self._neighbours.pop(body.uid, None)
            if body.moves:
                self._resting[body.uid] = body
                self._add_neighbour(body)

    def _add_neighbour(self, body: Body) -> None:
        """Add a body that came to rest to the neighbours of the moving bodies in reach."""
        assert body.last_position is not None
        x, y, z = body.last_position
        for uid, (at, found) in self._neighbours.items():
            reach = self._awake[uid].radius + body.radius + _REACH
            if abs(x - at[0]) < reach and abs(y - at[1]) < reach and abs(z - at[2]) < reach:
                found.add(body.uid)

    def _woken_by(self, uid: int, at: Vec3, radius: float) -> List[Body]:
        """Mark resting bodies near a moving one as awake if they move. Returns these."""
        neighbours = self._neighbours.get(uid)
        if neighbours is None or max(abs(at[0] - neighbours[0][0]), abs(at[1] - neighbours[0][1]),
                                     abs(at[2] - neighbours[0][2])) > _MARGIN:
            reach = radius + _REACH
            neighbours = (at, set(bodies_in([c - reach for c in at], [c + reach for c in at],
                                            self._resting.__contains__)))
            self._neighbours[uid] = neighbours
        return self._wake_moving(neighbours[1])

    def _wake_moving(self, candidates: Set[int]) -> List[Body]:
        woken = []
        for uid in list(candidates):
            body = self._resting.get(uid)
            if body is None:
                candidates.discard(uid)
            elif _velocity_of(uid) != STILL:
                self._resting.pop(uid)
                body.still_readouts = 0
                self._awake[uid] = body
                woken.append(body)
        return woken

    def _read_woken(self) -> None:
        """Read bodies that trees may have woken, and a few resting bodies in any case."""
        woken: List[Body] = []
        for tree in self._trees.values():
            woken += self._wake_moving(set(find_overlapping(tree, self._resting.__contains__)))
        if not self._unread:
            self._unread = list(self._resting)
        turn, self._unread = set(self._unread[:_READ_ANYWAY]), self._unread[_READ_ANYWAY:]
        self._read_all(woken + self._wake_moving(turn))

    def _read_tree(self, body: Body) -> None:
        uid, links = body.uid, self._link_bytes
        children = body.parts if body.base is None else body.parts[1:]
        found = motions(uid, [part.index for part in children])
        if body.base is not None:
            found.insert(0, motion(uid, BASE))
        states = axis_states(body)
        total = 0.0
        for position, orientation, linear, angular in found:
            total += sum(position) + sum(orientation) + sum(linear) + sum(angular)
        fastest = 0.0
        for state in states:
            total += state[0] + state[1]
            fastest = max(fastest, state[1], -state[1])
        if total - total != 0.0:
            self._diverged(body)    # which needs the rows as they were
            return
        if fastest >= FASTEST_RATE:
            self._reached_fastest_rate(body)
        for part, one in zip(body.parts, found):
            row = link_row(*one, self._offsets.get(part.row))
            ROW.pack_into(links, part.row * _ROW_BYTES, *row)
        for axis, state in zip(body.axes, states):
            _AXIS.pack_into(self._joint_bytes, axis.row * _AXIS.size, state[0], state[1])

    def offset(self, row: int) -> Optional[Pose]:
        """Return the link frame in the frame of its centre of mass; None if they are equal."""
        return self._offsets.get(row)

    def row(self, row: int) -> bytes:
        """Return a link row of the last read-out as raw doubles."""
        return bytes(self._link_bytes[row * _ROW_BYTES:(row + 1) * _ROW_BYTES])

    def tables(self) -> Tuple[memoryview, memoryview]:
        """Return the used rows of both tables as raw bytes, for the ring."""
        return (self._link_bytes[:self.used_links * _ROW_BYTES],
                self._joint_bytes[:self.used_joints * _AXIS.size])
