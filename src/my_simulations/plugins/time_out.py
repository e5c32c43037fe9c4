"""A time-out and a stopwatch in sim time."""
from __future__ import annotations

from .context import Context

_NEVER_S = 1e9  # longer than any simulation, and finite in nanoseconds


class TimeOut:
    """A time-out, exact to the nanosecond. It starts at `begin`, and again if time is set back.

    Attributes:
        ns: the duration; it is over when more than this time has passed.

    Args:
        context: provides the sim time.
        seconds: the duration; a negative one is over at once.
    """

    def __init__(self, context: Context, seconds: float) -> None:
        self._context = context
        # Rounded: 300000000e-9 is above 0.3, and 1.001e9 below 1001000000.
        self.ns = round(max(-_NEVER_S, min(_NEVER_S, seconds)) * 1e9)
        self.begin()

    def begin(self) -> None:
        self._since_ns = self._context.now_ns

    @property
    def end_ns(self) -> int:
        """The last sim time at which the time-out is not over, ns."""
        self._since_ns = min(self._since_ns, self._context.now_ns)
        return self._since_ns + self.ns

    @property
    def is_over(self) -> bool:
        """Whether more than the duration has passed."""
        return self._context.now_ns > self.end_ns


class Stopwatch:
    """Measures the sim time between calls of `lap`.

    Args:
        context: provides the sim time.
    """

    def __init__(self, context: Context) -> None:
        self._context = context
        self.restart()

    def restart(self) -> None:
        """Measure from now."""
        self._last_ns = self._context.now_ns

    def lap(self) -> float:
        """Return the time since the last call, or since `restart`, s; negative if time ran back."""
        last_ns, self._last_ns = self._last_ns, self._context.now_ns
        return (self._last_ns - last_ns) * 1e-9
