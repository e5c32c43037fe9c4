"""Hands the engine's records over to the observations that they were made for."""
from __future__ import annotations

from collections import deque
from typing import Callable, Deque, Optional

from ..engine.ring import RECORDS
from ..engine.step_records import Part, StepRecord
from ..simulator.sync_points import SimTimeStep, SyncPoints
from .observations import Observation, Observations, StepView
from .schedule import Schedule


class RecordHandover:
    """Takes records in order. For the thread of the host.

    Args:
        sync: has the records.
        observations: by the numbers of the parts.
        view: shows each part while it is handed over.
        schedule: says what time it is.
    """

    def __init__(self, sync: SyncPoints, observations: Observations, view: StepView,
                 schedule: Schedule) -> None:
        self._sync, self._observations, self._view = sync, observations, view
        self._schedule = schedule
        # A thread that is left behind in an observation leaves these to the next one.
        self._record: Optional[StepRecord] = None
        self._parts: Deque[Part] = deque()

    def hand_over(self, call: Callable[[Observation], None]) -> None:
        """Take the records that are there; `call` is given each observation that is due."""
        records = self._sync.records
        try:
            for _ in range(RECORDS):
                if self._record is None:
                    self._record = records.first()
                    if self._record is None:
                        break
                    self._parts.extend(self._record.parts())
                record = self._record
                self._hand_over(record, call)
                if self._record is not record:
                    break   # a turn inside a call has taken the rest (`nested_turns.py`)
                self._record = None
                records.release()
        finally:
            self._view.show_now()
        self._sync.make_room()

    def _hand_over(self, record: StepRecord, call: Callable[[Observation], None]) -> None:
        self._schedule.set_time_step(SimTimeStep(record.clock_sets, record.step, record.clock))
        while self._parts:
            part = self._parts.popleft()
            observation = self._observations.find(part.number)
            if observation is not None and not observation.ended:
                self._view.show(record, part, observation)
                call(observation)
                if not observation.owner.sensing.is_busy:
                    observation.request_step()
