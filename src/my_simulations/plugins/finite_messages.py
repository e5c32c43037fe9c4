"""Ignore command messages with NaN or infinity, which no motor can follow."""
from __future__ import annotations

from typing import Any, Callable

from ..description.model import INFINITE
from .context import Context, Handle


def subscribe_finite(context: Context, topic: str, kind: str, call: Callable[[Any], None],
                     queue: int = 1) -> Handle:
    """Subscribe to a topic (`Context.subscribe`), and ignore messages with NaN or infinity.

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

    return context.subscribe(topic, kind, receive, queue)


def is_all_finite(value: Any) -> bool:
    """Return whether all numbers of a message are finite; above 1e16 is infinite, as in SDF."""
    if isinstance(value, float):
        return abs(value) <= INFINITE
    if isinstance(value, (list, tuple)):
        return all(map(is_all_finite, value))
    names: Any = getattr(type(value), "__slots__", getattr(value, "__dict__", ()))
    return all(is_all_finite(getattr(value, name)) for name in names)
