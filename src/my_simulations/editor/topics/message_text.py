"""A message as text, as `rostopic echo` prints it, with long lists cut short."""
from __future__ import annotations

from typing import Any, List

_MOST_ITEMS = 24
_MOST_CHARACTERS = 6000


def text_of(message: Any) -> str:
    """The message's fields, one a line."""
    lines: List[str] = []
    _fields(message, 0, lines)
    text = "\n".join(lines)
    return text if len(text) <= _MOST_CHARACTERS else text[:_MOST_CHARACTERS] + "\n..."


def _fields(message: Any, depth: int, lines: List[str]) -> None:
    for name in message.__slots__:
        _field(name, getattr(message, name), depth, lines)
        if len(lines) > _MOST_CHARACTERS // 4:
            return


def _field(name: str, value: Any, depth: int, lines: List[str]) -> None:
    lead = "  " * depth
    if hasattr(value, "to_nsec"):
        lines.append(f"{lead}{name}: {value.to_nsec() * 1e-9:.3f}")
    elif hasattr(value, "__slots__"):
        lines.append(f"{lead}{name}:")
        _fields(value, depth + 1, lines)
    elif isinstance(value, (bytes, bytearray)):
        lines.append(f"{lead}{name}: {len(value)} bytes")
    elif isinstance(value, (list, tuple)):
        _list(name, value, depth, lines)
    else:
        lines.append(f"{lead}{name}: {_plain(value)}")


def _list(name: str, values: Any, depth: int, lines: List[str]) -> None:
    lead = "  " * depth
    if values and hasattr(values[0], "__slots__"):
        lines.append(f"{lead}{name}: ({len(values)})")
        for value in values[:_MOST_ITEMS]:
            lines.append(f"{lead}  -")
            _fields(value, depth + 2, lines)
        return
    shown = ", ".join(_plain(value) for value in values[:_MOST_ITEMS])
    more = f", ... ({len(values)})" if len(values) > _MOST_ITEMS else ""
    lines.append(f"{lead}{name}: [{shown}{more}]")


def _plain(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
