"""Sim time that may pass until something counts no more."""
from __future__ import annotations

from .context import Context

_NEVER_S = 1e9  # so long that nobody waits for it, and a number of nanoseconds still


class TimeOut:
    """Counts from its last `begin`, to the nanosecond; a clock that is set back begins anew.

    Attributes:
        ns: the time that must have passed and more.

    Args:
        context: tells the sim time.
        seconds: that must have passed and more; negative is over at once.
    """

    def __init__(self, context: Context, seconds: float) -> None:
        self._context = context
        # Rounded: 300000000e-9 is above 0.3, and 1.001e9 below 1001000000.
        self.ns = round(max(-_NEVER_S, min(_NEVER_S, seconds)) * 1e9)
        self.begin()

    def begin(self) -> None:
        """Count from now."""
        self._since_ns = self._context.now_ns

    @property
    def end_ns(self) -> int:
        """The last sim time at which it is not over, ns."""
        self._since_ns = min(self._since_ns, self._context.now_ns)
        return self._since_ns + self.ns

    @property
    def is_over(self) -> bool:
        """Whether more than that time has passed."""
        return self._context.now_ns > self.end_ns
