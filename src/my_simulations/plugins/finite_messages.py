"""Commands that are not finite end a robot: no motor can follow them, no body survives them."""
from __future__ import annotations

from typing import Any, Callable, Protocol

from ..description.model import INFINITE


class Warns(Protocol):
    """Who tells the user."""

    def warn(self, text: str) -> None:
        """Tell."""


def finite_only(context: Warns, topic: str, call: Callable[[Any], None]) -> Callable[[Any], None]:
    """What hears a topic in place of `call`: messages with NaN or infinity are passed over.

    The user is told of the first one.
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
    """Whether no number of a message, or of those in it, is NaN or infinite (1e16 as in SDF)."""
    if isinstance(value, float):
        return abs(value) <= INFINITE
    if isinstance(value, (list, tuple)):
        return all(map(is_all_finite, value))
    names: Any = getattr(type(value), "__slots__", getattr(value, "__dict__", ()))
    return all(is_all_finite(getattr(value, name)) for name in names)
