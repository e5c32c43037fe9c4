"""Copies messages field by field, with the values that a subscriber of ROS receives.

A copy has the types of the definition: numbers of `float32` have single precision, arrays have the
length and the type of their elements. Values that ROS could not send are refused.
"""
from __future__ import annotations

import operator
import struct
from typing import Any, Callable, Dict, Iterable, List, Mapping, Tuple, Type

import numpy as np

from ..errors import CommandError
from .definitions import FLOATS, INTEGERS, Field
from .message_types import DTYPES, Message
from .time_values import Duration, Time

Convert = Callable[[Any], Any]
FindType = Callable[[str], Type[Message]]


class MessageFieldError(CommandError):
    """A field that the type of the message does not have, or a value that it cannot have."""


def require_message(value: Any, kind: str) -> None:
    """Raise MessageFieldError for a dictionary, which rospy does not publish either."""
    if isinstance(value, Mapping):
        raise MessageFieldError(f"a plugin publishes messages, not dictionaries: make a {kind} with"
                                " context.message")


class Converter:
    """Copies messages of any type.

    Args:
        find: gives the classes of message types.
        numpy_arrays: give arrays of numbers as NumPy arrays; else as the lists, and bytes, that a
            callback of rospy can expect.
    """

    def __init__(self, find: FindType, numpy_arrays: bool) -> None:
        self._find, self._numpy_arrays = find, numpy_arrays
        self._of_types: Dict[str, Convert] = {}

    def blank(self, kind: str) -> Any:
        """A message whose fields are zero or empty."""
        return self.convert({}, kind)

    def convert(self, value: Any, kind: str) -> Any:
        """Return a copy of a message.

        Args:
            value: a message of this package or of ROS, or a mapping of fields; fields that a
                mapping does not name are zero or empty.
            kind: its type.

        Raises:
            MessageFieldError: a field does not exist, or its value has another type.
        """
        return self._of_type(kind)(value)

    def _of_type(self, kind: str) -> Convert:
        if kind not in self._of_types:
            made = self._find(kind)
            fields = made.DEFINITION.fields
            self._of_types[kind] = _of_message(
                made, [(one.name, self._of_field(one, kind)) for one in fields])
        return self._of_types[kind]

    def _of_field(self, one: Field, kind: str) -> Convert:
        if one.is_array and one.kind in DTYPES:
            convert = _numpy_array(one) if self._numpy_arrays else _plain_array(one)
        elif one.is_array:
            convert = _list(one, _simple(one.kind) or self._of_type(one.kind))
        else:
            convert = _simple(one.kind) or self._of_type(one.kind)
        return _name_field(convert, f"{kind}.{one.name}")


def _name_field(convert: Convert, name: str) -> Convert:
    def checked(value: Any) -> Any:
        try:
            return convert(value)
        except MessageFieldError:
            raise
        except (TypeError, ValueError, AttributeError, LookupError, OverflowError,
                struct.error) as fault:
            raise MessageFieldError(f"{name} cannot be {value!r:.60}: {fault}") from fault
    return checked


def _of_message(made: Type[Message], converts: List[Tuple[str, Convert]]) -> Convert:
    names = {name for name, _ in converts}
    blanks: List[Callable[[], Any]] = [_blank(convert, one) for (_, convert), one in zip(
        converts, made.DEFINITION.fields)]

    def refused(value: Any) -> MessageFieldError:
        return MessageFieldError(f"{value!r:.60} is not a {made.KIND}: give a message or a"
                                 " dictionary of its fields")

    def convert(value: Any) -> Any:
        copy = made.__new__(made)
        if isinstance(value, Mapping):
            _check_names(value, names, made.KIND)
            for (name, convert_field), blank in zip(converts, blanks):
                setattr(copy, name, convert_field(value[name]) if name in value else blank())
            return copy
        if isinstance(value, Message):
            if value.KIND != made.KIND:
                raise MessageFieldError(f"the message must be a {made.KIND}, it is a {value.KIND}")
            if len(vars(value)) != len(names):
                _check_names(vars(value), names, made.KIND)
        elif isinstance(value, (int, float, str, bytes, list, tuple)):
            raise refused(value)
        elif not all(hasattr(value, name) for name in names):
            raise refused(value)
        for name, convert_field in converts:
            setattr(copy, name, convert_field(getattr(value, name)))
        return copy

    return convert


def _check_names(given: Iterable[str], names: Any, kind: str) -> None:
    for name in given:
        if name not in names:
            raise MessageFieldError(f"{kind} has no field {name!r}; it has"
                                    f" {', '.join(sorted(names)) or 'none'}")


def _blank(convert: Convert, one: Field) -> Callable[[], Any]:
    if one.is_array:
        zero: Any = 0 if one.kind in DTYPES else "" if one.kind == "string" else {}
        return lambda: convert([zero] * (one.length or 0))
    if one.kind in INTEGERS or one.kind in FLOATS or one.kind == "bool":
        return lambda: convert(0)
    if one.kind == "string":
        return str
    return {"time": Time, "duration": Duration}.get(one.kind, lambda: convert({}))


def _simple(kind: str) -> Any:
    """The conversion of a value that is no message; None for messages."""
    if kind == "float64":
        return _number
    if kind == "float32":
        pack = struct.Struct("=f")
        return lambda value: pack.unpack(pack.pack(value))[0]
    if kind in INTEGERS:
        return _integer(struct.Struct(f"={INTEGERS[kind]}"))
    if kind in ("time", "duration"):
        made = Time if kind == "time" else Duration
        return lambda value: made(*_seconds(value))
    return {"bool": _truth, "string": _text}.get(kind)


def _number(value: Any) -> float:
    if isinstance(value, (str, bytes)):
        raise TypeError("it must be a number")
    return float(value)


def _truth(value: Any) -> bool:
    if value is None or isinstance(value, (str, bytes)):
        raise TypeError("it must be true or false")
    return bool(value)


def _integer(pack: struct.Struct) -> Convert:
    def convert(value: Any) -> int:
        number = operator.index(value)
        pack.pack(number)  # which raises an exception for numbers out of range
        return number
    return convert


def _seconds(value: Any) -> Tuple[int, int]:
    if isinstance(value, (int, float)):
        return divmod(round(value * 1e9), 10 ** 9)  # type: ignore[return-value]
    if isinstance(value, Mapping):
        return operator.index(value["secs"]), operator.index(value["nsecs"])
    return operator.index(value.secs), operator.index(value.nsecs)


def _text(value: Any) -> str:
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    if not isinstance(value, str):
        raise TypeError("it must be a string")
    return value


def _list(one: Field, convert: Convert) -> Convert:
    def convert_all(value: Any) -> List[Any]:
        if isinstance(value, (str, bytes, Mapping)):
            raise TypeError("it must be a list")
        found = [convert(element) for element in value]
        _check_length(one, len(found))
        return found
    return convert_all


def _numpy_array(one: Field) -> Convert:
    dtype = np.dtype(DTYPES[one.kind])

    def convert(value: Any) -> np.ndarray:
        if isinstance(value, (bytes, bytearray, memoryview)):
            found = np.frombuffer(value, dtype).copy()
        elif isinstance(value, (str, Mapping)):
            raise TypeError("it must be a list of numbers")
        else:
            found = np.array(value, dtype).reshape(-1)
        _check_length(one, len(found))
        return found
    return convert


def _plain_array(one: Field) -> Convert:
    numbers = _numpy_array(one)
    if one.kind in ("uint8", "char"):
        return lambda value: value if isinstance(value, bytes) else numbers(value).tobytes()
    return lambda value: numbers(value).tolist()


def _check_length(one: Field, length: int) -> None:
    if one.length is not None and length != one.length:
        raise ValueError(f"it must have {one.length} elements, it has {length}")
