"""Something that a plugin changes step by step at a rate, until there is nothing to change."""
from __future__ import annotations

from fractions import Fraction
from typing import Callable, Optional

from .call_slot import CallSlot
from .context import CallHandle, Context

_NS = 10 ** 9


class StepwiseChange:
    """Calls `update` at the steps of a rate, from `begin` on, until it returns True.

    A drive acts this way: the world waits for it while it accelerates, and not while nothing
    changes. The steps are those of the rate, as if it had been called at all of them.

    Args:
        context: of the plugin.
        hertz: of sim time; 0 or less is every step.
        update: gets the time since the last step of the rate, s; returns whether it is done.
    """

    def __init__(self, context: Context, hertz: float, update: Callable[[float], bool]) -> None:
        self._context, self._hertz, self._update = context, hertz, update
        self._period = Fraction(hertz).limit_denominator(10 ** 6) if hertz > 1e-6 else None
        self._timer = CallSlot()
        self._last_ns: Optional[int] = None

    @property
    def active(self) -> bool:
        """Whether it is called at the next step of the rate."""
        return self._timer.is_active

    def begin(self) -> None:
        """Call `update` at the steps of the rate, from the next one until it is done."""
        if not self._timer.is_active:
            self._last_ns = None
            self._timer.set(self._context.every(self._hertz, self._call))

    def begin_after(self, ns: int) -> CallHandle:
        """Begin at the first step of the rate that is later than a sim time (ns)."""
        due = ns + 2   # steps may begin a nanosecond early
        if self._period is not None:
            number = ns * self._period // _NS + 1
            due = -(-number * _NS // self._period)
        return self._context.once(due, self._begin_here)

    def end(self) -> None:
        self._timer.end()

    def _begin_here(self) -> None:
        if not self._timer.is_active:
            self.begin()
            self._call()

    def _call(self) -> None:
        before, now = self._last_ns, self._context.now_ns
        self._last_ns = now
        if before is not None and now > before:
            elapsed = (now - before) * 1e-9
        else:
            elapsed = float(1 / self._period) if self._period else self._context.step_size
        if self._update(elapsed):
            self.end()
