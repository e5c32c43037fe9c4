"""Keeps the engine in step with the plugin host: a step budget, records, notifications."""
from __future__ import annotations

import time
from typing import Callable

from .api import Backend
from .commands import (
    Clear,
    Command,
    LoadModel,
    RemoveModel,
    Restart,
    SetStepBudget,
    Synchronize,
)
from .memory_fence import fence
from .ring import SETTINGS, STEP_BUDGET, WAITS_AT, WAITS_FOR_ROOM, Clock, RingWriter
from .step_records import RecordWriter, SetRecordRules

_NOTIFY_S = 0.002   # between two notifications about records
_CHANGE_SETTINGS = (LoadModel, RemoveModel, Restart, Clear)


class HostSync:
    """Limits the steps of an engine to the host's budget, and writes the host's records.

    Attributes:
        records: writes the records.

    Args:
        writer: of the ring.
        source: reads the world.
        notify: wakes the host.
    """

    def __init__(self, writer: RingWriter, source: Backend,
                 notify: Callable[[], None]) -> None:
        self._writer, self._words, self._notify = writer, writer.words, notify
        self.records = RecordWriter(writer.memory, source)
        self._settings = self._words[SETTINGS] + 1   # a new engine: the old budget is not valid
        self._since = 0
        self._unread = False      # records that the host was not notified of
        self._notified_at = 0.0
        self._words[WAITS_AT] = self._words[WAITS_FOR_ROOM] = 0

    @property
    def settings(self) -> int:
        """Counts the settings of the world: clock, step size, models."""
        return self._settings

    def apply_own_command(self, command: Command, step: int, clock: Clock) -> bool:
        """Apply a command that only concerns this object; False for other commands."""
        if isinstance(command, SetRecordRules):
            self.records.set_rules(command.rules, step, clock)
        elif isinstance(command, Synchronize):
            self.change_settings(step)
        elif isinstance(command, SetStepBudget):
            self._words[STEP_BUDGET] = command.word
        else:
            return False
        return True

    def note_applied(self, command: Command, step: int) -> None:
        """Update the records and settings after the backend has applied a command."""
        self.records.count_joint_sets(command)
        if isinstance(command, _CHANGE_SETTINGS):
            self.change_settings(step)

    def step_limit(self) -> int:
        """The step at which the engine stops."""
        return self._writer.step_limit(self._settings, self._since)

    def change_settings(self, step: int) -> None:
        """Wait for a new budget at `step` after a change of clock, step size or models."""
        self._settings, self._since = self._settings + 1, step

    def wait_at(self, step: int) -> None:
        """Notify the host that the newest snapshot shows `step`, where the engine waits for it."""
        self._words[SETTINGS] = self._settings
        self._words[WAITS_AT] = step + 1
        fence()   # the budget is read only then: see `SyncPoints.allow`
        self._notify_now()

    def end_wait(self) -> None:
        """Show the host that the engine does not wait for it any more."""
        self._words[WAITS_AT] = 0

    def record(self, step: int, clock_sets: int, clock: Clock) -> bool:
        """Write the record of a step at which one is due; False while the ring is full.

        A host that has left is not recorded for.
        """
        if not self._words[STEP_BUDGET]:
            self.records.set_rules((), step, clock)
            return True
        if not self.records.write(step, clock_sets, clock):
            self._words[WAITS_FOR_ROOM] = 1
            fence()
            self._notify_now()
            return False
        self._words[WAITS_FOR_ROOM] = 0
        self._unread = self.records.is_urgent
        self.notify_of_records(at_once=False)
        return True

    def notify_of_records(self, at_once: bool = True) -> None:
        """Notify the host of unread records; without `at_once`, at most every `_NOTIFY_S` s."""
        if self._unread and (at_once or time.perf_counter() - self._notified_at >= _NOTIFY_S):
            self._notify_now()

    def _notify_now(self) -> None:
        self._unread = False
        self._notified_at = time.perf_counter()
        self._notify()
