"""Selects the steps to publish, and limits messages per wall second."""
from __future__ import annotations

from typing import Callable, List, Optional, Tuple

CLOCK_MESSAGES_PER_SECOND = 1000.0
"""Most `/clock` messages per wall second if the world runs faster than real time."""

BURST = 250.0
"""Most messages in one burst, after a pause."""

ROUNDING_NS = 1
"""Sim times are whole nanoseconds: steps of 1/240 s lie up to this much closer than 240 Hz."""


class TokenBucket:
    """Allows `rate` messages per second on average and at most `capacity` at once.

    Time (monotonic, s) is passed in, so that tests need no clock.
    """

    def __init__(self, rate: float, capacity: float, now: float) -> None:
        self._rate, self._capacity = rate, capacity
        self._tokens, self._at = capacity, now

    def available(self, now: float) -> int:
        """How many messages may be sent now."""
        self._tokens = min(self._capacity, self._tokens + (now - self._at) * self._rate)
        self._at = now
        return int(self._tokens)

    def take(self, count: int) -> None:
        """Count sent messages; the balance may become negative."""
        self._tokens -= count


class StepSelector:
    """Selects the steps whose `/clock` is published, of those made since the last poll.

    Every step in real time; with `period_ns` at most one per period of sim time; thinned evenly if
    there are more than CLOCK_MESSAGES_PER_SECOND. The newest is always among them, so that a
    subscriber is never behind by more than one poll. If step count or time decreased (reset,
    restart), the newest is published at once.
    """

    def __init__(self, step: int, sim_ns: int, now: float, period_ns: int = 0) -> None:
        self._step = step
        self._period_ns = max(period_ns - ROUNDING_NS, 0)
        self._published_ns = sim_ns
        self._bucket = TokenBucket(CLOCK_MESSAGES_PER_SECOND, BURST, now)

    @property
    def step(self) -> int:
        """The newest step seen."""
        return self._step

    def times(self, step: int, sim_ns: Callable[[int], int], now: float) -> List[int]:
        """Sim times (ns) to publish, oldest first.

        Args:
            step: step count now.
            sim_ns: sim time of a step count.
            now: monotonic seconds.
        """
        newest = sim_ns(step)
        went_back = newest < self._published_ns or step < self._step
        if not went_back and step == self._step:
            return []
        first = step if went_back else self._step + 1
        self._step = step
        if self._period_ns:
            found = self._periodic(first, step, sim_ns, went_back)
        else:
            found = self._thin_steps(first, step, sim_ns, now)
        if found:
            self._published_ns = found[-1]
        return found

    def _periodic(self, first: int, step: int, sim_ns: Callable[[int], int],
                  went_back: bool) -> List[int]:
        newest = sim_ns(step)
        if went_back:
            return [newest]
        due = newest - self._published_ns >= self._period_ns
        if not due:
            return []
        found: List[int] = []
        last = self._published_ns
        for at in (sim_ns(one) for one in range(first, step + 1)):
            if at - last >= self._period_ns:
                found.append(at)
                last = at
        return found[-int(BURST):]

    def _thin_steps(self, first: int, step: int, sim_ns: Callable[[int], int],
                    now: float) -> List[int]:
        missed = step - first + 1
        allowed = max(1, self._bucket.available(now))
        stride = -(-missed // allowed)
        found = [sim_ns(one) for one in range(step, first - 1, -stride)]
        found.reverse()
        self._bucket.take(len(found))
        return found


class StateSchedule:
    """Decides when a state message is due: every step, or at most `rate` Hz of sim time.

    A paused world is published whenever it changes, whatever the rate; a new subscriber gets one
    message at once.
    """

    def __init__(self, rate: float) -> None:
        self._period_ns = round(1e9 / rate) if rate > 0.0 else 0
        self._step = -1
        self._published_ns = -(1 << 62)
        self._shown: Optional[Tuple[int, int]] = None

    def due(self, step: int, sim_ns: int, has_new_subscriber: bool,
            paused_state: Callable[[], Optional[Tuple[int, int]]]) -> bool:
        """Whether to publish a message now.

        Args:
            step: current step count.
            sim_ns: its sim time.
            has_new_subscriber: there is a new subscriber.
            paused_state: returns a key of the state of a paused world; None while it runs.
        """
        waited = sim_ns - self._published_ns
        stepped, self._step = step != self._step, step
        if has_new_subscriber or (
                stepped and (waited < 0 or waited >= self._period_ns - ROUNDING_NS)):
            found = True
        else:
            key = paused_state()
            found = key is not None and key != self._shown
        if found:
            # What is published late does not delay what follows: the rate is kept on average.
            regular = self._period_ns and self._published_ns >= 0 and waited >= self._period_ns
            self._published_ns = sim_ns - (waited % self._period_ns if regular else 0)
        return found

    def note_published(self, shown: Tuple[int, int]) -> None:
        """Note that a message was published; `shown` is the key of its state."""
        self._shown = shown
