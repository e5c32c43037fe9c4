"""Snapshots of the world in shared memory: one writer, any number of readers, no locks.

A control page (int64 words) is followed by a ring of slots. A slot holds the states of all links
and joint axes after one step; its sequence number is written before (begin) and after (end) its
body, so a reader that finds both equal to the one it asked for has a whole snapshot, and a writer
that dies in the middle leaves the previous slot untouched. The step count of the control page is
newer than the latest slot while nothing has moved, or if not every step is read out.

On processors that reorder stores and loads, fences keep this order: the begin number before the
body, the body before the end number and the number of the newest slot; readers read the number of
the newest slot before the body, and the body before both numbers.

Readers that need poses only use a second, smaller ring: its slots hold link rows whose poses are
new and whose twists may be older. To read twists costs as much again.

A program that acts at exact steps has a step budget in the control page: the step at which the
engine stops until the budget is raised. A budget is valid for one setting of the world only: after
the clock, the step size or the models change, the engine waits for a new budget. Records of exact
steps for programs that only read are behind the slots (`engine/step_records.py`).

The memory is sparse (memfd): capacity costs nothing until rows are used.
"""
from __future__ import annotations

import mmap
import os
from dataclasses import dataclass
from typing import NamedTuple, Optional, Sequence, Union

from ..geometry import Pose, Twist
from .memory_fence import IS_WEAKLY_ORDERED, keep_order

Buffer = Union[bytes, memoryview]

SLOTS = 16
POSE_SLOTS = 4
LINKS = 16384
JOINTS = 16384
LINK_WIDTH = 13   # position 3, orientation 4 (x y z w), linear 3, angular 3: world, link origin
JOINT_WIDTH = 2   # position, rate
HEAD_WORDS = 16

_PAGE = 4096
_LINK_WORDS = LINKS * LINK_WIDTH
_JOINT_WORDS = JOINTS * JOINT_WIDTH
_SLOT_WORDS = -(-(HEAD_WORDS + _LINK_WORDS + _JOINT_WORDS) * 8 // _PAGE) * _PAGE // 8
_FIRST_SLOT = _PAGE // 8
_FIRST_JOINT = HEAD_WORDS + _LINK_WORDS
FIRST_RECORD = _FIRST_SLOT + (SLOTS + POSE_SLOTS) * _SLOT_WORDS
RECORDS, RECORD_WORDS = 256, 1 << 19   # most records, and words for all of them
SIZE = (FIRST_RECORD + RECORD_WORDS) * 8

# Words of the control page. The first group is the engine's, the second the simulator's.
(STEP, LATEST, HEARTBEAT, STATUS, LATEST_POSES, POSES_ARE_NEWER, PROGRESS, CLOCK_SETS) = range(8)
DEMAND_NS, WAKE_REQUESTED, POSE_DEMAND_NS = 8, 9, 10
UNCHANGED_STEP = 11   # the engine's: the step until which the newest slot is valid; or 0
# The engine's: settings of the world, the step + 1 at which it waits (0: it does not), records, and
# whether it waits for room for one.
SETTINGS, WAITS_AT, RECORDS_WRITTEN, WAITS_FOR_ROOM = 12, 13, 14, 15
STEP_BUDGET, RECORDS_READ = 16, 17   # the simulator's
RECORD_PLACES = 256   # the first of RECORDS words: where each record begins

NO_LIMIT = 1 << 62
"""The step at which an engine without a budget stops."""

_BUDGET_STEP_BITS = 46

# Words of a slot's head.
(SEQ_BEGIN, SEQ_END, SLOT_STEP, EPOCH_STEP, EPOCH_NS, STEP_PS, USED_LINKS, USED_JOINTS,
 APPLIED) = range(9)

STATUS_PAUSED, STATUS_RUNNING = 0, 1


def create() -> int:
    """A memfd of the ring's size; the caller owns the descriptor."""
    fd = os.memfd_create("my_simulations_ring", os.MFD_CLOEXEC)
    os.ftruncate(fd, SIZE)
    return fd


class Clock(NamedTuple):
    """Sim time as a count of steps since an epoch.

    `step_ps` is the step size in picoseconds, so that 1/240 s and the like stay exact enough to be
    counted for years; seconds are derived.
    """

    epoch_step: int
    epoch_ns: int
    step_ps: int

    def sim_ns(self, step: int) -> int:
        """Sim time in nanoseconds after `step` steps."""
        return self.epoch_ns + (step - self.epoch_step) * self.step_ps // 1000


def budget_word(settings: int, step: int) -> int:
    """The budget up to `step`, for one setting of the world."""
    return (settings & 0x7FFF) << _BUDGET_STEP_BITS | (step + 1)


def picoseconds(step_size: float) -> int:
    """A step size in seconds as whole picoseconds."""
    return round(step_size * 1e12)


@dataclass
class Snapshot:
    """One whole copy of the world's state.

    Attributes:
        sequence: its number; grows by one a snapshot.
        step: the step count up to which nothing has changed since this state was written.
        clock: for `clock.sim_ns(step)`.
        links: flat, `LINK_WIDTH` numbers a row.
        joints: flat, `JOINT_WIDTH` numbers a row.
    """

    sequence: int
    step: int
    clock: Clock
    links: Sequence[float]
    joints: Sequence[float]

    @property
    def sim_ns(self) -> int:
        """Sim time of `step`, nanoseconds."""
        return self.clock.sim_ns(self.step)

    def link(self, row: int) -> "tuple[Pose, Twist]":
        """World pose of the link frame and twist at its origin (world axes)."""
        return pose_and_twist(self.links, row * LINK_WIDTH)

    def joint(self, row: int) -> "tuple[float, float]":
        """Position and rate of a joint axis."""
        base = row * JOINT_WIDTH
        return self.joints[base], self.joints[base + 1]


def pose_and_twist(values: Sequence[float], at: int = 0) -> "tuple[Pose, Twist]":
    """Pose and twist of the link whose row begins at index `at`."""
    x, y, z, qx, qy, qz, qw, vx, vy, vz, wx, wy, wz = list(values[at:at + LINK_WIDTH])
    return Pose((x, y, z), (qx, qy, qz, qw)), Twist((vx, vy, vz), (wx, wy, wz))


class Memory:
    """The mapping, as words and as doubles."""

    def __init__(self, fd: Optional[int]) -> None:
        if fd is None:
            self._map = mmap.mmap(-1, SIZE)
        else:
            self._map = mmap.mmap(fd, SIZE, access=mmap.ACCESS_WRITE)
        view = memoryview(self._map)
        self.words = view.cast("q")
        self.doubles = view.cast("d")
        self.buffer = view

    @staticmethod
    def slot(sequence: int) -> int:
        """First word of the slot that holds snapshot `sequence`."""
        return _FIRST_SLOT + (sequence % SLOTS) * _SLOT_WORDS

    @staticmethod
    def pose_slot(number: int) -> int:
        """First word of the slot that holds poses number `number`."""
        return _FIRST_SLOT + (SLOTS + number % POSE_SLOTS) * _SLOT_WORDS


class RingWriter:
    """The engine's side. `fd` None keeps the ring inside this process."""

    def __init__(self, fd: Optional[int] = None, memory: Optional[Memory] = None) -> None:
        self.memory = memory or Memory(fd)
        self.words = self.memory.words

    def set_step(self, step: int) -> None:
        """The world is `step` steps old; the latest slot still holds unless a new one follows."""
        self.words[STEP] = step

    def step_limit(self, settings: int, since: int) -> int:
        """The step that the budget allows; NO_LIMIT without a budget.

        A budget for an earlier setting allows no step after `since`, the step of the last setting.
        """
        word = self.words[STEP_BUDGET]
        if not word:
            return NO_LIMIT
        if word >> _BUDGET_STEP_BITS != settings & 0x7FFF:
            return since
        return (word & (1 << _BUDGET_STEP_BITS) - 1) - 1

    def write(self, step: int, clock: Clock, links: Buffer, joints: Buffer,
              applied: int = 0) -> int:
        """Write a snapshot and return its sequence.

        `links` and `joints` are the used rows as raw doubles; `applied` is the number up to which
        the commands have been carried out.
        """
        sequence = self.words[LATEST] + 1
        self.words[UNCHANGED_STEP] = 0
        self.words[self.memory.slot(sequence) + APPLIED] = 0  # until the rest is whole
        self._fill(self.memory.slot(sequence), sequence, step, clock, links, joints)
        self.words[self.memory.slot(sequence) + APPLIED] = applied
        self.words[LATEST] = sequence
        self.words[POSES_ARE_NEWER] = 0
        self.words[STEP] = step
        return sequence

    def write_poses(self, step: int, clock: Clock, links: Buffer) -> None:
        """Write where the links are; their twists, and the joints, may be older."""
        number = self.words[LATEST_POSES] + 1
        self.words[UNCHANGED_STEP] = 0
        self._fill(self.memory.pose_slot(number), number, step, clock, links, b"")
        self.words[LATEST_POSES] = number
        self.words[POSES_ARE_NEWER] = 1
        self.words[STEP] = step

    def mark_unchanged(self, step: int) -> None:
        """Declare the latest snapshot valid up to a step: nothing has moved since."""
        keep_order()
        self.words[UNCHANGED_STEP] = step

    def _fill(self, slot: int, number: int, step: int, clock: Clock, links: Buffer,
              joints: Buffer) -> None:
        words = self.words
        words[slot + SEQ_BEGIN] = number
        keep_order()
        words[slot + SLOT_STEP] = step
        words[slot + EPOCH_STEP] = clock.epoch_step
        words[slot + EPOCH_NS] = clock.epoch_ns
        words[slot + STEP_PS] = clock.step_ps
        words[slot + USED_LINKS] = len(links) // (8 * LINK_WIDTH)
        words[slot + USED_JOINTS] = len(joints) // (8 * JOINT_WIDTH)
        at = (slot + HEAD_WORDS) * 8
        self.memory.buffer[at:at + len(links)] = links
        at += _LINK_WORDS * 8
        self.memory.buffer[at:at + len(joints)] = joints
        keep_order()
        words[slot + SEQ_END] = number


class RingReader:
    """The simulator's side; safe from any thread."""

    def __init__(self, fd: Optional[int] = None, memory: Optional[Memory] = None) -> None:
        self.memory = memory or Memory(fd)
        self.words = self.memory.words

    @property
    def latest(self) -> int:
        """Sequence of the newest whole snapshot; 0 before the first."""
        return self.words[LATEST]

    @property
    def applied(self) -> int:
        """Number up to which the newest snapshot shows the effect of commands; 0 for unknown."""
        return self.words[self.memory.slot(self.words[LATEST]) + APPLIED]

    @property
    def changes(self) -> int:
        """Grows whenever `raw_poses` may have others to give."""
        return self.words[LATEST] + self.words[LATEST_POSES]

    @property
    def step(self) -> int:
        """The engine's step count now."""
        return self.words[STEP]

    @property
    def running(self) -> bool:
        """False while paused."""
        return self.words[STATUS] == STATUS_RUNNING

    def clock(self) -> "tuple[int, Clock]":
        """The step count now and the clock that belongs to it, without copying states."""
        while True:
            sequence = self._newest()
            slot = self.memory.slot(sequence)
            clock, step = self._clock_of(slot), self.words[STEP]
            keep_order()
            if self.words[LATEST] == sequence:
                return step, clock

    def clock_now(self) -> "tuple[int, int, Clock]":
        """How often the clock was set, the step count now, and the clock that belongs to both."""
        while True:
            sets = self.words[CLOCK_SETS]
            keep_order()
            step, clock = self.clock()
            keep_order()
            if self.words[CLOCK_SETS] == sets:
                return sets, step, clock

    def joint(self, row: int) -> "tuple[float, float]":
        """Newest position and rate of one joint axis, without copying the rest."""
        words, doubles = self.words, self.memory.doubles
        while True:
            sequence = words[LATEST]
            if IS_WEAKLY_ORDERED:
                keep_order()
            slot = _FIRST_SLOT + sequence % SLOTS * _SLOT_WORDS  # in line: robots read many
            at = slot + _FIRST_JOINT + row * JOINT_WIDTH
            found = doubles[at], doubles[at + 1]
            if IS_WEAKLY_ORDERED:
                keep_order()
            if words[slot + SEQ_BEGIN] == sequence == words[slot + SEQ_END]:
                return found

    def link(self, row: int) -> "tuple[Pose, Twist]":
        """Newest state of one link, without copying the rest."""
        while True:
            sequence = self._newest()
            slot = self.memory.slot(sequence)
            found = pose_and_twist(self.memory.doubles, slot + HEAD_WORDS + row * LINK_WIDTH)
            if self._is_whole(slot, sequence):
                return found

    def raw_links(self) -> "tuple[int, bytes]":
        """Sequence of the newest snapshot and its used link rows as they lie in memory."""
        while True:
            sequence = self._newest()
            slot = self.memory.slot(sequence)
            links = self._links_of(slot)
            if self._is_whole(slot, sequence):
                return sequence, links

    def raw_poses(self) -> "tuple[int, Clock, bytes]":
        """The used link rows, poses of the newest kind; the twists in them may be older.

        Returns:
            The step at which they were so (the last one at which they are known to have been),
            the clock that belongs to it, and the rows.
        """
        while True:
            # Before the slot: if that is newer than this step, its own step is greater.
            unchanged = self.words[UNCHANGED_STEP]
            keep_order()
            newer = self.words[POSES_ARE_NEWER]
            number = self.words[LATEST_POSES if newer else LATEST]
            keep_order()
            slot = self.memory.pose_slot(number) if newer else self.memory.slot(number)
            step, clock = self.words[slot + SLOT_STEP], self._clock_of(slot)
            links = self._links_of(slot)
            if self._is_whole(slot, number):
                return max(step, unchanged), clock, links

    def _newest(self) -> int:
        """The number of the newest slot, read before anything in that slot."""
        sequence = self.words[LATEST]
        keep_order()
        return sequence

    def _clock_of(self, slot: int) -> Clock:
        words = self.words
        return Clock(words[slot + EPOCH_STEP], words[slot + EPOCH_NS], words[slot + STEP_PS])

    def _links_of(self, slot: int) -> bytes:
        at = (slot + HEAD_WORDS) * 8
        size = self.words[slot + USED_LINKS] * LINK_WIDTH * 8
        return bytes(self.memory.buffer[at:at + size])

    def earlier_links(self, sequence: int) -> "Optional[tuple[int, bytes]]":
        """Step and used link rows of an earlier snapshot; None once it is overwritten."""
        slot = self.memory.slot(sequence)
        if not self._is_whole(slot, sequence):
            return None
        keep_order()
        step = self.words[slot + SLOT_STEP]
        links = self._links_of(slot)
        return (step, links) if self._is_whole(slot, sequence) else None

    def read(self, sequence: Optional[int] = None) -> Optional[Snapshot]:
        """A copy of snapshot `sequence` (default the newest); None once it is overwritten."""
        while True:
            wanted = self._newest() if sequence is None else sequence
            found = self._copy(wanted)
            if found is not None or sequence is not None:
                return found

    def _copy(self, sequence: int) -> Optional[Snapshot]:
        slot = self.memory.slot(sequence)
        words, doubles = self.words, self.memory.doubles
        unchanged = words[UNCHANGED_STEP]
        keep_order()
        if words[POSES_ARE_NEWER]:   # it is the step of these poses
            unchanged = 0
        if words[slot + SEQ_END] != sequence:
            return None
        keep_order()
        clock, step = self._clock_of(slot), words[slot + SLOT_STEP]
        # As bytes: most readers want a few rows, and a number for each cell takes much longer.
        links = memoryview(self._links_of(slot)).cast("d")
        at = slot + _FIRST_JOINT
        joints = memoryview(bytes(
            doubles[at:at + words[slot + USED_JOINTS] * JOINT_WIDTH])).cast("d")
        now = words[STEP]
        if not self._is_whole(slot, sequence):
            return None
        if words[LATEST] == sequence:
            step = max(step, now if words[STATUS] == STATUS_PAUSED else unchanged)
        return Snapshot(sequence, step, clock, links, joints)

    def _is_whole(self, slot: int, sequence: int) -> bool:
        """Whether everything read from the slot before this call belongs to `sequence`."""
        keep_order()
        return self.words[slot + SEQ_BEGIN] == sequence == self.words[slot + SEQ_END]
