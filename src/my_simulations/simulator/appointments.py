"""Steps at which somebody must act: the engine stops there until everybody is done.

Appointments are whole steps: the k-th of a rate is the first step that does not begin before sim
time k / rate. So they never drift, and the same run has the same ones.
"""
from __future__ import annotations

import threading
from typing import List, NamedTuple, Optional

from ..engine.ring import CONSUMERS, CREDITS, NO_LIMIT, Clock, credit_word
from ..errors import CommandError
from .session import Session

_PS = 10 ** 12


class Moment(NamedTuple):
    """Where the engine is.

    Attributes:
        clock_sets: how often the clock was set; another number is another clock.
        step: the step count.
        clock: turns step counts into sim time.
    """

    clock_sets: int
    step: int
    clock: Clock

    @property
    def sim_ns(self) -> int:
        """Sim time, ns."""
        return self.clock.sim_ns(self.step)


class Rate:
    """Appointments of a rate in Hz of sim time; 0 or less is every step."""

    def __init__(self, hertz: float) -> None:
        from fractions import Fraction  # a world without appointments starts without it

        self._period_ps = Fraction(0)
        if hertz > 1e-6:
            self._period_ps = _PS / Fraction(hertz).limit_denominator(10 ** 6)

    def after(self, step: int, clock: Clock) -> int:
        """The first appointment after a step."""
        if not self._period_ps or self._period_ps <= clock.step_ps:
            return step + 1
        number = (clock.epoch_ns * 1000 + (step - clock.epoch_step) * clock.step_ps) \
            // self._period_ps
        while True:
            number += 1
            found = self._step_of(number, clock)
            if found > step:
                return found

    def is_at(self, step: int, clock: Clock) -> bool:
        """Whether a step is an appointment."""
        return self.after(step - 1, clock) == step

    def _step_of(self, number: int, clock: Clock) -> int:
        ahead = number * self._period_ps - clock.epoch_ns * 1000
        return clock.epoch_step + -int(-ahead // clock.step_ps)


class Consumer:
    """One who has appointments, in a thread of its own.

    The engine stands at the step allowed last, and whenever the clock is set, until the next
    `allow`. Whoever does not need the world any more must `leave` it, or it stands for ever.
    """

    def __init__(self, session: Session, word: int, leave: "Appointments") -> None:
        self._session = session
        self._word = word
        self._owner = leave
        self.rung = threading.Event()

    def now(self) -> Moment:
        """Where the engine is; while it stands at an appointment, it stays there."""
        return Moment(*self._session.ring.clock_now())

    def allow(self, moment: Moment, step: Optional[int]) -> None:
        """Let the engine go on to a step, or for ever with None, by the clock of `moment`."""
        self._session.ring.words[self._word] = credit_word(
            moment.clock_sets, NO_LIMIT >> 17 if step is None else step)
        self._session.supervisor.engine.nudge()

    def wait(self, timeout: float) -> bool:
        """Wait until the engine stands somewhere, or `rung` is set; False after `timeout` s."""
        if not self.rung.wait(timeout):
            return False
        self.rung.clear()
        return True

    def leave(self) -> None:
        """Have no appointments any more."""
        self._owner.forget(self)
        self._session.ring.words[self._word] = 0
        self._session.supervisor.engine.nudge()


class Appointments:
    """Hands out the credits of the engine. Safe from any thread; takes no other lock."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._lock = threading.Lock()
        self._consumers: List[Optional[Consumer]] = [None] * CONSUMERS

    def now(self) -> Moment:
        """Where the engine is, for who does not wait for it."""
        return Moment(*self._session.ring.clock_now())

    def join(self) -> Consumer:
        """Become one whom the engine waits for: at once, until the first `allow`.

        Raises CommandError when there are too many.
        """
        with self._lock:
            if None not in self._consumers:
                raise CommandError(f"{CONSUMERS} programs have appointments already")
            number = self._consumers.index(None)
            consumer = Consumer(self._session, CREDITS + number, self)
            self._consumers[number] = consumer
        ring = self._session.ring
        ring.words[CREDITS + number] = credit_word(*ring.clock_now()[:2])
        return consumer

    def forget(self, consumer: Consumer) -> None:
        """A consumer has left."""
        with self._lock:
            self._consumers = [None if one is consumer else one for one in self._consumers]

    def ring_all(self) -> None:
        """The engine stands at somebody's appointment, or may have."""
        for consumer in list(self._consumers):
            if consumer is not None:
                consumer.rung.set()
