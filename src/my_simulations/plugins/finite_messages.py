"""Ignore command messages with NaN or infinity, which no motor can follow."""
from __future__ import annotations

from typing import Any, Callable, Protocol

from ..description.model import INFINITE


class WarningSink(Protocol):
    """Reports warnings to the user."""

    def warn(self, text: str) -> None:
        """Report a warning."""


def finite_only(context: WarningSink, topic: str, call: Callable[[Any], None]) -> Callable[[Any],
                                                                                           None]:
    """Return a subscriber that ignores messages with NaN or infinity, and else calls `call`.

    The first ignored message is reported to the user.
    """
    reported = False

    def receive(message: Any) -> None:
        nonlocal reported
        if is_all_finite(message):
            call(message)
        elif not reported:
            reported = True
            context.warn(f"a message on {topic} contains NaN or infinity; such messages are"
                         " ignored")

    return receive


def is_all_finite(value: Any) -> bool:
    """Return whether all numbers of a message are finite; above 1e16 is infinite, as in SDF."""
    if isinstance(value, float):
        return abs(value) <= INFINITE
    if isinstance(value, (list, tuple)):
        return all(map(is_all_finite, value))
    names: Any = getattr(type(value), "__slots__", getattr(value, "__dict__", ()))
    return all(is_all_finite(getattr(value, name)) for name in names)
