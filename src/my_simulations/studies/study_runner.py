"""Runs the cases of a study that have no row yet, on this machine."""
from __future__ import annotations

import threading
import time
from typing import Callable, Dict, Iterator, List, Optional, Set

from .case_output import CaseOutput
from .plan import ALL_CASES, Case, CasePlan, Shard, number_of
from .row import Row
from .row_recorder import Recorder
from .slot import Hook
from .slot_pool import SlotPool

Report = Callable[[Row], None]


def waiting_cases(plan: CasePlan, shard: Shard, finished: Set[int]) -> Iterator[Case]:
    """The cases of a shard whose ids, as numbers, are not among the finished ones."""
    for case in plan.cases(shard):
        if number_of(case.id) not in finished:
            yield case


class StudyRunner:
    """Runs all cases that have no row yet.

    Args:
        plan: the cases.
        recorder: keeps the rows.
        finished: ids of the cases that have a row, as numbers.
        slots: how many run at a time.
        told: hears of each row, from any thread, one at a time.
        hook: see `Slot`.
    """

    def __init__(self, plan: CasePlan, recorder: Recorder, finished: Set[int], slots: int,
                 told: Report = lambda row: None, hook: Optional[Hook] = None) -> None:
        self._plan = plan
        self._recorder = recorder
        self._finished = finished
        self._told = told
        self._hook = hook
        self._slots = slots
        self._ready = threading.Lock()

    def run(self, shard: Shard = ALL_CASES) -> None:
        """Run the cases of a shard; returns when all are done.

        The first exception that is no result of a case, such as that of a full disk, ends the run.
        """
        pool = SlotPool(self._plan, self._slots, self._hook)
        try:
            pool.run(waiting_cases(self._plan, shard, self._finished), self._add_row)
        finally:
            pool.close()
            self._recorder.close()

    def _add_row(self, row: Row, output: Optional[CaseOutput]) -> None:
        self._recorder.add(row, output)
        with self._ready:
            self._told(row)


class Rate:
    """How fast cases finish, and how long the rest will take.

    Args:
        total: cases of this run.
        clock: s.
    """

    def __init__(self, total: int, clock: Callable[[], float] = time.monotonic) -> None:
        self.total = total
        self.done = 0
        self.counts: Dict[str, int] = {}
        self._clock = clock
        self._began = clock()
        self._recent: List[float] = []

    def add(self, row: Row) -> None:
        """A case has finished."""
        self.done += 1
        self.counts[row.status] = self.counts.get(row.status, 0) + 1
        self._recent = [*self._recent[-99:], self._clock()]

    @property
    def per_second(self) -> float:
        """Cases per s, of the last hundred."""
        since = self._recent[0] if len(self._recent) == 100 else self._began
        passed = self._clock() - since
        return len(self._recent) / passed if passed > 0.0 else 0.0

    @property
    def seconds_left(self) -> float:
        """s until all are done at this rate; infinite before the first."""
        rate = self.per_second
        return (self.total - self.done) / rate if rate > 0.0 else float("inf")
