"""Reads malformed numbers as Gazebo does.

Source: libsdformat 9 (`Param::ValueFromStringImpl`). Single numbers are read by `std::stod`,
`std::stoi` and `std::stoul`, which use the beginning of a text and ignore the rest; vectors, poses
and colours by a C++ stream, which reads one number after the other, even without separators.
A text that cannot be read raises ValueError: Gazebo rejects the whole document.
"""
from __future__ import annotations

import math
import re
from typing import List, Optional

_STREAM = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d*)?")
_DECIMAL = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
_SPECIAL = re.compile(r"([+-]?)(inf(?:inity)?|nan)", re.IGNORECASE)
_HEX = re.compile(r"[+-]?0x(?:[0-9a-f]+\.?[0-9a-f]*|\.[0-9a-f]+)(?:p[+-]?\d+)?", re.IGNORECASE)
_INTEGER = re.compile(r"[+-]?\d+")
_HEX_INTEGER = re.compile(r"0x[0-9a-f]+", re.IGNORECASE)
_LARGEST = 2 ** 32


def stream_numbers(text: str, count: int) -> List[Optional[float]]:
    """The first `count` numbers that a C++ stream reads; None from the first failure on.

    `6.0000006.000000` and `-12.0.0` are two numbers each; a comma, a word, `inf` or `nan` fails.
    """
    found: List[Optional[float]] = []
    at = 0
    while len(found) < count:
        at += len(text[at:]) - len(text[at:].lstrip())
        match = _STREAM.match(text, at)
        if match is None or not _DECIMAL.fullmatch(match[0]) or math.isinf(float(match[0])):
            break
        found.append(float(match[0]))
        at = match.end()
    return found + [None] * (count - len(found))


def leading_number(text: str) -> float:
    """The number at the beginning of a text, as read by `std::stod`; it may be infinite or NaN.

    Raises ValueError: the text does not begin with a number.
    """
    text = text.strip()
    special = _SPECIAL.match(text)
    if special:
        return float(special[0])
    hexadecimal = _HEX.match(text)
    if hexadecimal:
        return float.fromhex(hexadecimal[0])
    decimal = _DECIMAL.match(text)
    if decimal is None:
        raise ValueError("no number")
    value = float(decimal[0])
    if math.isinf(value):
        raise ValueError("too large")
    return value


def leading_integer(text: str) -> int:
    """The integer at the beginning of a text, as read by `std::stoi`.

    Raises ValueError: the text does not begin with an integer of at most 32 bits.
    """
    text = text.strip()
    hexadecimal = _HEX_INTEGER.match(text)
    match = hexadecimal or _INTEGER.match(text)
    if match is None:
        raise ValueError("no whole number")
    value = int(match[0], 16 if hexadecimal else 10)
    if not -_LARGEST < value < _LARGEST:
        raise ValueError("too large")
    return value
