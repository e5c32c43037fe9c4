"""Steps at which a plugin or sensor must act: the engine waits there until all are done.

Appointments are whole steps: the k-th appointment of a rate is the first step that begins at or
after sim time k / rate. They do not drift, and repeated runs have the same appointments.
"""
from __future__ import annotations

import threading
from typing import List, NamedTuple, Optional

from ..engine.ring import CONSUMERS, CREDITS, NO_LIMIT, Clock, credit_word
from ..errors import CommandError
from .session import Session

_PS = 10 ** 12


class Moment(NamedTuple):
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


class Rate:
    """Appointments at a rate in Hz of sim time; 0 or less means every step."""

    def __init__(self, hertz: float) -> None:
        self._beats, self._per_ps = 0, 1   # appointments in a number of picoseconds
        if hertz > 1e-6:
            from fractions import Fraction  # a world without appointments starts without it

            exact = Fraction(hertz).limit_denominator(10 ** 6)
            self._beats, self._per_ps = exact.numerator, exact.denominator * _PS

    def after(self, step: int, clock: Clock) -> int:
        """Step count of the first appointment after `step`."""
        beats, per_ps = self._beats, self._per_ps
        if not beats or per_ps <= beats * clock.step_ps:
            return step + 1
        epoch_ps = clock.epoch_ns * 1000
        number = (epoch_ps + (step - clock.epoch_step) * clock.step_ps) * beats // per_ps
        while True:
            number += 1
            ahead = number * per_ps - epoch_ps * beats
            found = clock.epoch_step - (-ahead // (clock.step_ps * beats))
            if found > step:
                return found

    def is_at(self, step: int, clock: Clock) -> bool:
        """Whether `step` is an appointment."""
        return self.after(step - 1, clock) == step


class Consumer:
    """A thread that has appointments, such as that of the plugins.

    The engine waits at the last allowed step, and after each setting of the clock, until the next
    `allow`. Call `leave` when done; otherwise the engine waits for ever.
    """

    def __init__(self, session: Session, word: int, leave: "Appointments") -> None:
        self._session = session
        self._word = word
        self._owner = leave
        self.rung = threading.Event()

    def now(self) -> Moment:
        """Position of the engine; it does not change while the engine waits at an appointment."""
        return Moment(*self._session.ring.clock_now())

    def allow(self, moment: Moment, step: Optional[int]) -> None:
        """Let the engine advance to `step` by the clock of `moment`; None for no limit."""
        engine = self._session.supervisor.engine
        words, credit = engine.ring.words, credit_word(
            moment.clock_sets, NO_LIMIT >> 17 if step is None else step)
        if words[self._word] != credit:  # else the engine knows, or waits for somebody else
            words[self._word] = credit
            engine.nudge()

    def wait(self, timeout: float) -> bool:
        """Wait until the engine stops at an appointment or `rung` is set; False on timeout (s)."""
        if not self.rung.wait(timeout):
            return False
        self.rung.clear()
        return True

    def leave(self) -> None:
        """Cancel all appointments of this consumer."""
        self._owner.forget(self, self._word)
        self._session.supervisor.engine.nudge()


class Appointments:
    """Distributes the step credits of the engine. Safe from any thread; takes no other lock."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._lock = threading.Lock()
        self._consumers: List[Optional[Consumer]] = [None] * CONSUMERS

    def now(self) -> Moment:
        """Position of the engine, for callers without appointments."""
        return Moment(*self._session.ring.clock_now())

    def join(self) -> Consumer:
        """Register a consumer; the engine waits for it from now until its first `allow`.

        Raises CommandError if all credit words are in use.
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

    def forget(self, consumer: Consumer, word: int) -> None:
        """Free the credit word of a consumer."""
        with self._lock:
            if consumer in self._consumers:  # else the word may be another one's already
                self._session.ring.words[word] = 0
            self._consumers = [None if one is consumer else one for one in self._consumers]

    def ring_all(self) -> None:
        """Wake all consumers, because the engine has stopped at an appointment."""
        for consumer in list(self._consumers):
            if consumer is not None:
                consumer.rung.set()
