"""Records of exact steps for readers that follow later: one writer, one reader, no locks.

A reader that needs the state at certain steps does not stop the engine there. The engine writes
what the reader has asked for (`RecordRule`) into a ring in shared memory, and goes on. The
reader takes the records in order, some milliseconds later and several at once. The engine waits
only if the ring is full. A record has a head, a part for each rule that is due at its step, and the
rows of all links if a rule asks for them.

A part holds, in this order and as far as the rule asks for them: link rows (`LINK_WIDTH` doubles
each), joint axes (position, rate, number of times it was set), then the size in bytes and
a pickled list of the values of the rule's queries.
"""
from __future__ import annotations

import array
import collections
import pickle
from dataclasses import dataclass
from typing import Any, Counter, Dict, Iterator, List, Optional, Tuple

from .api import Backend
from .commands import Command, SetJoints
from .memory_fence import keep_order
from .rates import Rate
from .ring import (
    FIRST_RECORD,
    LINK_WIDTH,
    RECORD_PLACES,
    RECORD_WORDS,
    RECORDS,
    RECORDS_READ,
    RECORDS_WRITTEN,
    Buffer,
    Clock,
    Memory,
)

NEVER = 1 << 62
AXIS_WIDTH = 3   # position, rate, number of sets

_MANY = RECORDS // 4   # records that a reader without urgent ones is notified of at once

_HEAD_WORDS = 8
# Words of all parts, bytes of the world's rows, and what `StepRecord` says.
_PART_WORDS, _WORLD_BYTES, _STEP, _SETS, _EPOCH_STEP, _EPOCH_NS, _STEP_PS, _PARTS = range(
    _HEAD_WORDS)


@dataclass(frozen=True)
class RecordRule:
    """What is recorded, and when.

    Attributes:
        number: identifies the rule in records; never used again for another one.
        rate: the steps.
        link_rows, joint_rows: rows of the ring whose states are recorded.
        all_links: the states of all links of the world, too.
        queries: commands that only read, such as `ReadContacts`; their reply values are recorded.
        urgent: the reader is notified soon, and else when many records have come.
        single: one step is recorded, and the next one when the rule is set with another number
            here; 0 for all steps.
    """

    number: int
    rate: Rate
    link_rows: Tuple[int, ...] = ()
    joint_rows: Tuple[int, ...] = ()
    all_links: bool = False
    queries: Tuple[Command, ...] = ()
    urgent: bool = True
    single: int = 0


@dataclass(frozen=True)
class SetRecordRules(Command):
    """Record by these rules from the next step on; replaces all earlier rules."""

    rules: Tuple[RecordRule, ...]


class RecordWriter:
    """The engine's side.

    Attributes:
        next_step: the next step at which a record is due; NEVER without rules.
        is_urgent: whether the reader is to be notified soon.
    """

    def __init__(self, memory: Memory, source: Backend) -> None:
        self._words = memory.words
        self._buffer, self._source = memory.buffer, source
        self._rules: List[Tuple[int, RecordRule]] = []   # with the step at which each is due
        self._joint_sets: Counter[int] = collections.Counter()
        self._answers: Dict[Command, object] = {}   # of this step
        self._end = 0          # of the last record, words from the first one
        self.next_step = NEVER
        self.is_urgent = False

    def set_rules(self, rules: Tuple[RecordRule, ...], step: int, clock: Clock) -> None:
        """Record by these rules after a step; those that are known already are due as before."""
        due = {(rule.number, rule.rate, rule.single): when for when, rule in self._rules}
        self._rules = [(due.get((rule.number, rule.rate, rule.single))
                        or rule.rate.after(step, clock), rule) for rule in rules]
        self._find_next()

    def set_clock(self, step: int, clock: Clock) -> None:
        """The clock was set: the steps of all rates are others."""
        self._rules = [(rule.rate.after(step, clock), rule) for _, rule in self._rules]
        self._find_next()

    def _find_next(self) -> None:
        self.next_step = min((due for due, _ in self._rules), default=NEVER)

    def count_joint_sets(self, command: Command) -> None:
        """Count the joints that a command sets."""
        if isinstance(command, SetJoints):
            self._joint_sets.update(row for row, _, _ in command.joints)

    def _place(self, size: int) -> Optional[int]:
        """Where a record of `size` words fits, in words from the first one."""
        words = self._words
        written, read = words[RECORDS_WRITTEN], words[RECORDS_READ]
        keep_order()   # released records are overwritten only then
        if written == read:
            return 0   # the memory that is touched stays small
        if written - read >= RECORDS:
            return None
        oldest = words[RECORD_PLACES + read % RECORDS]
        if oldest < self._end:
            if self._end + size <= RECORD_WORDS:
                return self._end
            return 0 if size < oldest else None
        return self._end if self._end + size < oldest else None

    def write(self, step: int, clock_sets: int, clock: Clock) -> bool:
        """Write the record of a step; False if there is no room for it yet.

        Only parts of rules that are due are written.
        """
        due = [rule for when, rule in self._rules if when <= step]
        self._answers.clear()
        parts = [self._part(rule) for rule in due]
        world: Buffer = self._source.read_world() if any(rule.all_links for rule in due) else b""
        part_words = sum(2 + len(part) // 8 for part in parts)
        size = _HEAD_WORDS + part_words + len(world) // 8
        place = self._place(size)
        if place is None:
            return False
        words, at = self._words, FIRST_RECORD + place
        for n, value in enumerate((part_words, len(world), step, clock_sets, *clock, len(parts))):
            words[at + n] = value
        at += _HEAD_WORDS
        for rule, part in zip(due, parts):
            words[at], words[at + 1] = rule.number, len(part) // 8
            at += 2
            self._buffer[at * 8:at * 8 + len(part)] = part
            at += len(part) // 8
        self._buffer[at * 8:at * 8 + len(world)] = world
        number = words[RECORDS_WRITTEN]
        words[RECORD_PLACES + number % RECORDS] = place
        keep_order()   # the record before its number
        words[RECORDS_WRITTEN] = number + 1
        waiting = number + 1 - words[RECORDS_READ]
        self.is_urgent = waiting >= _MANY or self.is_urgent and waiting > 1 or any(
            rule.urgent for rule in due)
        self._end = place + size
        self._rules = [(when if when > step else NEVER if rule.single
                        else rule.rate.after(step, clock), rule) for when, rule in self._rules]
        self._find_next()
        return True

    def _part(self, rule: RecordRule) -> bytes:
        source = self._source
        found = source.read_rows(rule.link_rows) if rule.link_rows else b""
        if rule.joint_rows:
            axes = source.read_axes(rule.joint_rows)
            for n, row in enumerate(rule.joint_rows):
                axes.insert(AXIS_WIDTH * n + 2, float(self._joint_sets[row]))
            found += array.array("d", axes).tobytes()
        if not rule.queries:
            return found
        rest = pickle.dumps([self._answer(query) for query in rule.queries],
                            protocol=pickle.HIGHEST_PROTOCOL)
        return found + len(rest).to_bytes(8, "little") + rest + bytes(-len(rest) % 8)

    def _answer(self, query: Command) -> object:
        """The value of a query, which several rules may have."""
        if query not in self._answers:
            self._answers[query] = self._source.apply(query)
        return self._answers[query]


class Part:
    """What was recorded by one rule at one step.

    Attributes:
        number: of the rule.
        raw: the bytes of the part.
    """

    def __init__(self, number: int, raw: memoryview) -> None:
        self.number, self.raw = number, raw

    def answers(self, links: int, axes: int) -> List[Any]:
        """The values of the rule's queries, which follow `links` links and `axes` joint axes."""
        at = (links * LINK_WIDTH + axes * AXIS_WIDTH) * 8
        size = int.from_bytes(self.raw[at:at + 8], "little")
        found: List[Any] = pickle.loads(self.raw[at + 8:at + 8 + size])
        return found


class StepRecord:
    """The record of one step; its parts are valid until it is released.

    Attributes:
        clock_sets: how often the clock had been set.
        step: the step count.
        clock: converts step counts to sim time.
    """

    def __init__(self, memory: Memory, at: int) -> None:
        words = memory.words
        self.clock_sets, self.step = words[at + _SETS], words[at + _STEP]
        self.clock = Clock(words[at + _EPOCH_STEP], words[at + _EPOCH_NS], words[at + _STEP_PS])
        self._memory, self._begin = memory, at

    def world(self) -> bytes:
        """The rows of all links as raw doubles; nothing if no rule that was due asks for them."""
        words = self._memory.words
        at = (self._begin + _HEAD_WORDS + words[self._begin + _PART_WORDS]) * 8
        return bytes(self._memory.buffer[at:at + words[self._begin + _WORLD_BYTES]])

    def parts(self) -> Iterator[Part]:
        """What was recorded by each rule that was due."""
        memory, at = self._memory, self._begin + _HEAD_WORDS
        for _ in range(memory.words[self._begin + _PARTS]):
            number, size = memory.words[at], memory.words[at + 1]
            at += 2
            yield Part(number, memory.buffer[at * 8:(at + size) * 8])
            at += size


class RecordReader:
    """The reader's side; for one thread."""

    def __init__(self, memory: Memory) -> None:
        self._memory, self._words = memory, memory.words

    def first(self) -> Optional[StepRecord]:
        """The oldest record; None if there is none."""
        words = self._words
        read = words[RECORDS_READ]
        if words[RECORDS_WRITTEN] == read:
            return None
        keep_order()   # the number before its record
        return StepRecord(self._memory, FIRST_RECORD + words[RECORD_PLACES + read % RECORDS])

    def release(self) -> None:
        """Allow the writer to overwrite the oldest record."""
        keep_order()
        self._words[RECORDS_READ] += 1
