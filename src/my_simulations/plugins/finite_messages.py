"""Ignore command messages with NaN or infinity, which no motor can follow."""
from __future__ import annotations

from typing import Any, Callable, Protocol

from ..description.model import INFINITE


class Warns(Protocol):
    """Reports warnings to the user."""

    def warn(self, text: str) -> None:
        """Report a warning."""


def finite_only(context: Warns, topic: str, call: Callable[[Any], None]) -> Callable[[Any], None]:
    """Return a subscriber that ignores messages with NaN or infinity, and else calls `call`.

    The first ignored message is reported to the user.
    """
    told = False

    def heard(message: Any) -> None:
        nonlocal told
        if is_all_finite(message):
            call(message)
        elif not told:
            told = True
            context.warn(f"a message on {topic} contains NaN or infinity; such messages are"
                         " ignored")

    return heard


def is_all_finite(value: Any) -> bool:
    """Return whether all numbers of a message are finite; above 1e16 is infinite, as in SDF."""
    if isinstance(value, float):
        return abs(value) <= INFINITE
    if isinstance(value, (list, tuple)):
        return all(map(is_all_finite, value))
    names: Any = getattr(type(value), "__slots__", getattr(value, "__dict__", ()))
    return all(is_all_finite(getattr(value, name)) for name in names)
