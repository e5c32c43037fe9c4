"""Numbers of a ROS message by the path of their field, such as `pose.position.x` or `ranges[0]`."""
from __future__ import annotations

import itertools
import math
import re
from typing import Any, Callable, Iterator, List, Optional

from ...errors import CommandError

_STEP = re.compile(r"(\w+)(?:\[(\d+)\])?\Z")
_MOST_FIELDS = 500
_MOST_ITEMS = 40
_DEEPEST = 8


def number_at(message: Any, path: str) -> Optional[float]:
    """The number of a field; times in s, true as 1.

    Returns None for what is not finite, and for an item that the message's list lacks.
    Raises CommandError for a path that leads to no number.
    """
    value = message
    for step in path.split("."):
        found = _STEP.match(step)
        if found is None or found[1] not in getattr(value, "__slots__", ()):
            raise CommandError(f"the message has no field {path!r}")
        value = getattr(value, found[1])
        if found[2] is not None:
            if not isinstance(value, (list, tuple)):
                raise CommandError(f"the field {found[1]!r} is not a list of numbers")
            if int(found[2]) >= len(value):
                return None
            value = value[int(found[2])]
    if hasattr(value, "to_nsec"):
        return float(value.to_nsec() * 1e-9)
    if not isinstance(value, (bool, int, float)):
        raise CommandError(f"the field {path!r} is not a number")
    return float(value) if math.isfinite(value) else None


def numeric_fields(message: Any, new_message: Callable[[str], Any]) -> List[str]:
    """Paths of a message's numbers, at most 500 and 40 of each list; an empty list shows one item.

    Args:
        message: of genpy.
        new_message: makes a message of a type.
    """
    return list(itertools.islice(_paths(message, new_message, _DEEPEST), _MOST_FIELDS))


def _paths(message: Any, new_message: Callable[[str], Any], depth: int) -> Iterator[str]:
    for name, kind in zip(message.__slots__, message._slot_types if depth else ()):
        value, item_kind = getattr(message, name), kind.partition("[")[0]
        if item_kind == kind:
            items = [(name, value)]
        elif isinstance(value, (bytes, str)):
            continue
        else:
            some = value[:_MOST_ITEMS] or [new_message(item_kind) if "/" in item_kind else 0]
            items = [(f"{name}[{at}]", one) for at, one in enumerate(some)]
        for path, one in items:
            if "/" in item_kind or item_kind == "Header":
                yield from (f"{path}.{inner}" for inner in _paths(one, new_message, depth - 1))
            elif item_kind != "string":
                yield path
