"""Exact steps for the plugin host: steps at which the engine waits, and records of steps.

A host that acts at a step gives the engine a budget of steps; the engine waits at its end. A host
that only reads takes records that the engine writes on the way (`engine/step_records.py`).
"""
from __future__ import annotations

import threading
from typing import Callable, NamedTuple, Optional, Sequence

from ..engine.memory_fence import fence
from ..engine.ring import (
    NO_LIMIT,
    SETTINGS,
    STEP_BUDGET,
    WAITS_AT,
    WAITS_FOR_ROOM,
    Clock,
    budget_word,
)
from ..engine.step_records import RecordReader, RecordRule, SetRecordRules
from ..errors import CommandError
from .session import Session, do_nothing

_CHANGE_S = 1.0   # how long a change of models that is under way is waited for


class SimTimeStep(NamedTuple):
    """Position of the engine in time.

    Attributes:
        clock_sets: how often the clock was set; steps of different counts are not comparable.
        step: the step count.
        clock: converts step counts to sim time.
    """

    clock_sets: int
    step: int
    clock: Clock

    @property
    def sim_ns(self) -> int:
        """Sim time at the step, ns."""
        return self.clock.sim_ns(self.step)


class SyncPoints:
    """Limits the engine's steps, and reads its records. For one host at a time, in one thread.

    Only `notify` may be called from any thread.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._attached = False
        self._lock = threading.Lock()
        self._records: Optional[RecordReader] = None
        self._budget = 0   # the last one, as in the ring once the engine has taken it

    @property
    def records(self) -> RecordReader:
        if self._records is None:
            self._records = RecordReader(self._session.ring.memory)
        return self._records

    @property
    def settings(self) -> int:
        """Counts the settings of the world: clock, step size, models, a new engine.

        The engine waits after each, if a host is attached, until `allow` is given the new count.
        """
        return self._session.ring.words[SETTINGS]

    def now(self) -> SimTimeStep:
        """Position of the engine."""
        return SimTimeStep(*self._session.ring.clock_now())

    def waits_at(self, moment: SimTimeStep) -> bool:
        """Whether the engine waits there; the newest states are those of that step then."""
        return self._session.ring.words[WAITS_AT] == moment.step + 1

    def attach(self, before_advance: Callable[[], None]) -> None:
        """Have the engine wait until the first `allow`.

        `before_advance` is called, in any thread, before steps are made on request: it returns when
        the host has sent the commands that follow from all received messages.

        Raises CommandError for a second host.
        """
        with self._lock:
            if self._attached:
                raise CommandError("another plugin host is attached to this simulator")
            self._attached = True
        self._session.before_advance = before_advance
        ring = self._session.ring
        ring.words[STEP_BUDGET] = budget_word(self.settings, ring.step)
        self._session.supervisor.engine.notify(ring.words[STEP_BUDGET])

    def on_plugins(self, call: Callable[[], None]) -> None:
        """Call a function, in any thread, before a model with plugins is added.

        If it attaches a host, the world makes no step between that and the loading of the plugins.
        It must not wait for changes of models: the caller may hold the structure lock.
        """
        self._session.before_plugins = call

    def detach(self) -> None:
        """Let the engine run freely, without records."""
        with self._lock:
            if not self._attached:
                return
            self._attached = False
        self._session.before_advance = do_nothing
        self._session.ring.words[STEP_BUDGET] = 0
        self._session.supervisor.engine.notify(0)

    def allow(self, settings: int, step: Optional[int]) -> None:
        """Let the engine run to `step` while `settings` are the world's; None for no limit.

        It has all commands that were posted before. An engine that waits, or has not taken the
        last budget that was sent, gets commands and budget in one message.
        """
        words, engine = self._session.ring.words, self._session.supervisor.engine
        word = budget_word(settings, NO_LIMIT >> 17 if step is None else step)
        if words[WAITS_AT] or words[STEP_BUDGET] != self._budget:
            engine.notify(word)
        else:
            engine.send_posted()
            words[STEP_BUDGET] = word
            fence()   # else the engine could begin to wait between the two, and not be notified
            if words[WAITS_AT]:
                engine.notify(word)
        self._budget = word

    def set_rules(self, rules: Sequence[RecordRule]) -> None:
        """Set what the engine records, instead of all earlier rules. Raises CommandError."""
        self._session.call(SetRecordRules(tuple(rules)))

    def make_room(self) -> None:
        """Notify an engine that waits for the release of records."""
        fence()
        if self._session.ring.words[WAITS_FOR_ROOM]:
            self._session.supervisor.engine.notify()

    def await_model_changes(self) -> None:
        """Wait until a change of models that the engine has carried out is in the registry, too."""
        if self._session.structure_lock.acquire(timeout=_CHANGE_S):
            self._session.structure_lock.release()

    def wait(self, timeout: float) -> bool:
        """Wait for the engine, or for `notify`; False after `timeout` s."""
        return self._session.supervisor.engine.wait_for_notice(timeout)

    def notify(self) -> None:
        """End a `wait`, from any thread."""
        self._session.supervisor.engine.notify_host()
