"""Calls of plugins that only read: they follow the engine, and never stop it.

The engine records what an observation reads at the exact steps of its rate; the host hands the
records over some milliseconds later. An observation whose topics have no subscribers is not
recorded. When a subscriber comes, the steps are those of the same rate, as if it had come before.
"""
from __future__ import annotations

import struct
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple

from ..engine.commands import Command, ReadContacts, ReadJointWrenches
from ..engine.drive_commands import ReadEfforts
from ..engine.rates import Rate
from ..engine.ring import LINK_WIDTH, pose_and_twist
from ..engine.step_records import AXIS_WIDTH, Part, RecordRule, StepRecord
from ..geometry import Pose, Twist
from ..simulator.states import States
from ..simulator.sync_points import SimTimeStep
from .context import PluginError, Publication
from .model_rows import ModelRows

_LINK = struct.Struct(f"={LINK_WIDTH}d")
_AXIS = struct.Struct(f"={AXIS_WIDTH}d")


class Reads(NamedTuple):
    """What an observation reads besides the links and joints that its plugin has looked up.

    Attributes:
        contacts: the contacts of the step.
        efforts: joints whose efforts are read.
        wrenches: joints whose wrenches are read.
        world: all links, for scans and pictures.
    """

    contacts: bool = False
    efforts: Tuple[str, ...] = ()
    wrenches: Tuple[str, ...] = ()
    world: bool = False


def queries_of(reads: Reads, rows: ModelRows) -> Tuple[Command, ...]:
    """Return the commands that read contacts, efforts and wrenches. Raises PluginError."""
    queries: List[Command] = []
    if reads.contacts:
        queries.append(ReadContacts())
    if reads.efforts:
        queries.append(ReadEfforts(tuple(
            rows.axis(rows.joint(name).name) for name in reads.efforts)))
    if reads.wrenches:
        queries.append(ReadJointWrenches(tuple(
            (rows.entity.model_id, rows.joint(name).name) for name in reads.wrenches)))
    return tuple(queries)


class PartLayout(NamedTuple):
    """What a part of a record contains.

    Attributes:
        links, axes: indices of links and joint axes, by row.
        queries: the commands whose values follow.
    """

    links: Dict[int, int]
    axes: Dict[int, int]
    queries: Tuple[Command, ...]


class Observation:
    """A call at the steps of a rate.

    Attributes:
        owner: the plugin's context.
        ended: it is not called any longer.

    Args:
        number: identifies it in records.
        rate: the steps.
        call: the function; its context shows the step.
        resume: called at the first step after a time without subscribers in which the rate had
            steps, instead of `call`.
        topics: those that it publishes; without any it is always due.
        transforms: it broadcasts to tf.
        remembers: it is due without subscribers too, because it keeps a state.
        reads: the data that is recorded besides links and joints.
    """

    def __init__(self, owner: Any, number: int, rate: Rate, call: Callable[[], None],
                 resume: Optional[Callable[[], None]], topics: Sequence[Publication],
                 transforms: bool, remembers: bool, reads: Reads) -> None:
        self.owner, self.number = owner, number
        self._rate, self._call, self._resume = rate, call, resume
        self._topics, self._transforms, self._remembers = topics, transforms, remembers
        self.reads = reads
        self.ended = False
        self._was_idle = False
        self._last: Optional[SimTimeStep] = None   # of its rate; no step after it was left out
        self.rule: Optional[RecordRule] = None
        self._asked = 1   # of single steps
        self._layout = PartLayout({}, {}, ())

    def end(self) -> None:
        self.ended = True
        self.owner.observations.changed = True

    def is_wanted(self, transforms_wanted: bool) -> bool:
        """Whether one of its topics, or tf, has a subscriber."""
        if not self._topics and not self._transforms:
            return True
        return self._transforms and transforms_wanted or any(
            topic.wanted for topic in self._topics)

    @property
    def is_single(self) -> bool:
        """Whether it takes as many steps as it can: rays at every step hold no world."""
        return self.reads.world and self._rate.hertz <= 0.0 and not self.owner.is_stepped_manually

    def request_step(self) -> None:
        """Record another step, for one that takes as many as it can."""
        if self.is_single:
            self._asked += 1
            self.owner.observations.changed = True

    def set_wanted(self, wanted: bool) -> None:
        """Set whether it has subscribers, and make its record rule again."""
        if not wanted and not self._remembers:
            self._was_idle = True
            self.rule = None
            return
        links, axes, queries = self.owner.list_observed(self.reads)
        self.rule = RecordRule(self.number, self._rate, links, axes, self.reads.world, queries,
                               wanted, self._asked if self.is_single else 0)
        self._layout = PartLayout({row: n for n, row in enumerate(links)},
                                  {row: n for n, row in enumerate(axes)}, queries)

    def begin(self, time_step: Optional[SimTimeStep]) -> None:
        """Count the steps that are left out from a moment on."""
        self._last = time_step

    def call(self, time_step: SimTimeStep) -> None:
        """Hand a step over to the plugin."""
        idle = self._was_idle and self._has_left_out_steps(time_step)
        self._was_idle, self._last = False, time_step
        # Steps without subscribers are handed over late: perhaps when there are some.
        self.owner.is_silent = self.rule is not None and not self.rule.urgent
        try:
            if idle and self._resume is not None:
                self._resume()
            else:
                self._call()
        finally:
            self.owner.is_silent = False

    def _has_left_out_steps(self, time_step: SimTimeStep) -> bool:
        last = self._last
        return (last is None or last.clock_sets != time_step.clock_sets
                or self._rate.after(last.step, time_step.clock) < time_step.step)

    @property
    def layout(self) -> "PartLayout":
        """Of its parts of records; kept for records that arrive after its last subscriber left."""
        return self._layout


class Observations:
    """All observations of a host, in the order in which they were made.

    Attributes:
        changed: which of them are recorded, or their rows, may be others than before.
    """

    def __init__(self) -> None:
        self._all: Dict[int, Observation] = {}
        self._made = 0
        self.changed = False
        self._rules: Tuple[RecordRule, ...] = ()

    def add(self, owner: Any, rate: Rate, call: Callable[[], None],
            resume: Optional[Callable[[], None]], topics: Sequence[Publication], transforms: bool,
            remembers: bool, reads: Reads) -> Observation:
        self._made += 1
        made = Observation(owner, self._made, rate, call, resume, topics, transforms, remembers,
                           reads)
        self._all[self._made] = made
        self.changed = True
        return made

    def begin_all(self, time_step: SimTimeStep) -> None:
        """Count the steps that are left out from a moment on, after a reset."""
        for one in self._all.values():
            one.begin(time_step)

    def end_all(self, owner: Any) -> None:
        for one in self._all.values():
            if one.owner is owner:
                one.end()

    def request_step(self, owner: Any) -> None:
        """Record another step for a plugin whose requests are answered."""
        for one in self._all.values():
            if one.owner is owner:
                one.request_step()

    def find(self, number: int) -> Optional[Observation]:
        """The observation of a part of a record; None once it has ended."""
        return self._all.get(number)

    def new_rules(self, transforms_wanted: bool, again: bool) -> Optional[Tuple[RecordRule, ...]]:
        """Return the engine's record rules if they changed or `again` is set, else None."""
        self.changed = False
        self._all = {number: one for number, one in self._all.items() if not one.ended}
        for one in self._all.values():
            one.set_wanted(one.is_wanted(transforms_wanted))
        before, self._rules = self._rules, tuple(
            one.rule for one in self._all.values() if one.rule is not None)
        return self._rules if before != self._rules or again and self._rules else None


class StepView:
    """Where links and joints are: at the step of a record while one is handed over, else now.

    Args:
        states: of now.
        present: gives the rows of all links as they are now.
    """

    def __init__(self, states: States, present: Callable[[], bytes]) -> None:
        self._states, self._present = states, present
        self._record: Optional[StepRecord] = None
        self._part: Optional[Part] = None
        self._links: Dict[int, int] = {}
        self._axes: Dict[int, int] = {}
        self._found: Dict[int, Tuple[Pose, Twist]] = {}
        self._answers: Dict[type, Any] = {}
        self._queries: Tuple[Command, ...] = ()

    def show(self, record: StepRecord, part: Part, observation: Observation) -> None:
        """Show the step of a record, as far as an observation reads it."""
        self._record, self._part = record, part
        self._links, self._axes, self._queries = observation.layout
        self._found, self._answers = {}, {}

    def show_now(self) -> None:
        self._record = self._part = None

    @property
    def is_record(self) -> bool:
        return self._part is not None

    def link_at(self, row: int) -> Tuple[Pose, Twist]:
        """World pose and twist of the link in a row."""
        part = self._part
        if part is None:
            return self._states.link_at(row)
        found = self._found.get(row)
        if found is None:
            place = self._links.get(row)
            if place is None:
                raise PluginError("an observation can read only links that were looked up before")
            found = self._found[row] = pose_and_twist(
                _LINK.unpack_from(part.raw, place * _LINK.size))
        return found

    def axis_at(self, row: int) -> Tuple[float, float]:
        """Position (rad or m) and rate of the joint axis in a row."""
        if self._part is None:
            return self._states.axis_at(row)
        position, rate, _ = self._recorded_axis(row)
        return position, rate

    def set_count(self, row: int) -> float:
        """Return the number of times the position was set directly; -1 for the present."""
        return -1.0 if self._part is None else self._recorded_axis(row)[2]

    def _recorded_axis(self, row: int) -> Tuple[float, float, float]:
        assert self._part is not None
        place = self._axes.get(row)
        if place is None:
            raise PluginError("an observation can read only joints that were looked up before")
        at = len(self._links) * _LINK.size + place * _AXIS.size
        position, rate, sets = _AXIS.unpack_from(self._part.raw, at)
        return position, rate, sets

    def answer(self, kind: type) -> Tuple[Any, Any]:
        """The observation's query of a kind, and its recorded value. Raises PluginError."""
        assert self._part is not None
        if not self._answers:
            values: List[Any] = self._part.answers(len(self._links), len(self._axes)) \
                if self._queries else []
            self._answers = {type(query): (query, value)
                             for query, value in zip(self._queries, values)}
        if kind not in self._answers:
            raise PluginError(f"an observation must say that it needs {kind.__name__}")
        return self._answers[kind]

    def world_rows(self) -> bytes:
        """Return the rows of all links as raw doubles. Raises PluginError."""
        if self._record is None:
            return self._present()
        rows = self._record.world()
        if not rows:
            raise PluginError("an observation must say that it needs the world")
        return rows
