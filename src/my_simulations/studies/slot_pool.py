"""Slots, each a thread with an engine of its own, that share the cases they are given."""
from __future__ import annotations

import threading
import time
from concurrent.futures import FIRST_EXCEPTION, ThreadPoolExecutor, wait
from queue import SimpleQueue
from typing import Callable, Iterator, List, Optional, Protocol, Tuple

from ..python_api.kept_files import FileCache
from ..resources.resolver import Resolver
from .case_output import CaseOutput
from .plan import Case, CasePlan
from .provenance import processor_type
from .row import Row
from .scenario_slot import ScenarioSlot
from .slot import CaseStoppedError, Hook, Slot

_LOOK_S = 0.25
_KEPT_FILES = 16  # worlds, models and lists of objects
_IDLE_S = 60.0  # after which unused engines are ended

Take = Callable[[Row, Optional[CaseOutput]], None]


class CaseSlot(Protocol):
    """Runs one case at a time, for one thread."""

    def run(self, case: Case) -> Tuple[Row, Optional[CaseOutput]]:
        """Run a case. Raises CaseStoppedError if `stop` was set."""

    def enforce_limits(self) -> None:
        """End a case that has used up a limit; called from another thread."""

    def close(self) -> None:
        """Close the state that is shared between cases."""


class SlotPool:
    """Runs cases in slots; its threads and engines stay until it is closed.

    Args:
        plan: of the study.
        slots: how many cases run at a time.
        hook: see `Slot`.

    Attributes:
        stop: ends all cases that run once it is set.
    """

    def __init__(self, plan: CasePlan, slots: int, hook: Optional[Hook] = None) -> None:
        self.stop = threading.Event()
        self._slots = _make_slots(plan, slots, self.stop, hook)
        self._free: "SimpleQueue[CaseSlot]" = SimpleQueue()
        for slot in self._slots:
            self._free.put(slot)
        self._guard = threading.Lock()
        self._used = 0  # calls of `run` that have not returned
        self._idle_since: Optional[float] = None
        self._threads = ThreadPoolExecutor(slots, "slot")
        self._over = threading.Event()
        self._watcher = threading.Thread(target=self._watch, name="limits of cases", daemon=True)
        self._watcher.start()

    def run(self, cases: Iterator[Case], add_row: Take) -> None:
        """Run cases; returns when all are done or `stop` was set. May be called by many threads.

        Args:
            cases: taken one by one, as slots become free.
            add_row: gets each row, from any thread.

        Raises:
            BaseException: the first one that is no result of a case, such as that of a full disk;
                it ends all.
        """
        next_one = threading.Lock()
        with self._guard:
            self._used += 1
            self._idle_since = None
        try:
            futures = [self._threads.submit(self._serve, cases, next_one, add_row)
                       for _ in self._slots]
            done, _ = wait(futures, return_when=FIRST_EXCEPTION)
            for future in done:
                future.result()
        except BaseException:  # Ctrl-C included
            self.stop.set()
            wait(futures)
            raise
        finally:
            with self._guard:
                self._used -= 1
                self._idle_since = time.monotonic() if not self._used else None

    def close(self) -> None:
        """End the cases that run, and all engines."""
        self.stop.set()
        # In the threads that started the engines: an engine is killed when its thread ends.
        wait([self._threads.submit(self._close_slot) for _ in self._slots])
        self._threads.shutdown()
        self._over.set()
        self._watcher.join()

    def _close_slot(self) -> None:
        self._free.get().close()

    def _serve(self, cases: Iterator[Case], next_one: threading.Lock, add_row: Take) -> None:
        slot = self._free.get()
        try:
            while not self.stop.is_set():
                with next_one:
                    case = next(cases, None)
                if case is None:
                    return
                add_row(*slot.run(case))
        except CaseStoppedError:
            return
        finally:
            self._free.put(slot)

    def _watch(self) -> None:
        while not self._over.wait(_LOOK_S):
            for slot in self._slots:
                slot.enforce_limits()
            with self._guard:
                since = self._idle_since
                if since is not None and time.monotonic() - since > _IDLE_S:
                    self._idle_since = None
                    for slot in self._slots:
                        slot.close()


def _make_slots(plan: CasePlan, count: int, stop: threading.Event, hook: Optional[Hook]
                ) -> List[CaseSlot]:
    processor = processor_type()
    if plan.study.scenarios:
        return [ScenarioSlot(plan, processor, stop) for _ in range(count)]
    files = FileCache(Resolver.from_environment(), _KEPT_FILES)
    return [Slot(plan, processor, stop, files, hook) for _ in range(count)]
