"""Runs the cases of a study in slots, each a thread with an engine of its own."""
from __future__ import annotations

import contextlib
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from typing import Callable, Dict, Iterator, List, Optional, Set

from .plan import WHOLE, Case, CasePlan, Shard
from .provenance import processor_type
from .row import Row
from .slot import Hook, Slot, StoppedError
from .trajectories import Recorder

_LOOK_S = 0.25

Told = Callable[[Row], None]


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
                 told: Told = lambda row: None, hook: Optional[Hook] = None) -> None:
        self._plan = plan
        self._recorder = recorder
        self._finished = finished
        self._told = told
        self.stop = threading.Event()
        processor = processor_type()
        self._slots = [Slot(plan, processor, self.stop, hook) for _ in range(slots)]
        self._next = threading.Lock()
        self._ready = threading.Lock()
        self._over = threading.Event()

    def run(self, shard: Shard = WHOLE) -> None:
        """Run the cases of a shard; returns when all are done or `stop` was set.

        The first exception that is no result of a case, such as that of a full disk, ends the run.
        """
        cases = self._waiting(shard)
        watcher = threading.Thread(target=self._watch, name="limits of cases", daemon=True)
        watcher.start()
        try:
            with ThreadPoolExecutor(len(self._slots), "slot") as pool:
                futures = [pool.submit(self._serve, slot, cases) for slot in self._slots]
                with self._stopping():
                    for future in futures:
                        future.result()
        finally:
            self._over.set()
            watcher.join()
            self._recorder.close()

    @contextlib.contextmanager
    def _stopping(self) -> Iterator[None]:
        """Whatever ends the wait, Ctrl-C included, lets the slots end, too."""
        try:
            yield
        except BaseException:
            self.stop.set()
            raise

    def _waiting(self, shard: Shard) -> Iterator[Case]:
        for case in self._plan.cases(shard):
            number = int(case.id, 16)
            if number not in self._finished:
                yield case

    def _serve(self, slot: Slot, cases: Iterator[Case]) -> None:
        try:
            while not self.stop.is_set():
                with self._next:
                    case = next(cases, None)
                if case is None:
                    return
                row, trajectory = slot.run(case)
                self._recorder.add(row, trajectory)
                with self._ready:
                    self._told(row)
        except StoppedError:
            return
        except BaseException:
            self.stop.set()
            raise
        finally:
            slot.close()

    def _watch(self) -> None:
        while not self._over.wait(_LOOK_S):
            for slot in self._slots:
                slot.look()


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
