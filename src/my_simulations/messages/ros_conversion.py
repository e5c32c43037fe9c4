"""Converts messages to those of ROS and back, where the packages of ROS are installed."""
from __future__ import annotations

import importlib
from typing import Any

import numpy as np

from .conversion import Converter
from .message_types import Message, MessageTypes, UnknownTypeError
from .time_values import Duration, Time


def to_ros(message: Message) -> Any:
    """Return the message of ROS with the same fields.

    Raises UnknownTypeError: the package of its type is not installed for this Python.
    """
    made = _message_class(message.KIND)()
    for one in message.DEFINITION.fields:
        setattr(made, one.name, _value_to_ros(getattr(message, one.name)))
    return made


def from_ros(message: Any, types: MessageTypes = MessageTypes()) -> Message:  # noqa: B008
    """Return the message of this package with the fields of one of ROS.

    Args:
        message: of a class that ROS has generated.
        types: finds types that are not standard ones.

    Raises:
        UnknownTypeError: its type is unknown.
    """
    copy: Message = Converter(types.message, True).convert(message, message._type)
    return copy


def _value_to_ros(value: Any) -> Any:
    if isinstance(value, Message):
        return to_ros(value)
    if isinstance(value, (Time, Duration)):
        genpy = importlib.import_module("genpy")
        return getattr(genpy, type(value).__name__)(value.secs, value.nsecs)
    if isinstance(value, np.ndarray):
        return value.tobytes() if value.dtype == np.uint8 else value.tolist()
    if isinstance(value, list):
        return [_value_to_ros(element) for element in value]
    return value


def _message_class(kind: str) -> Any:
    package, _, name = kind.partition("/")
    sort = "srv" if name.endswith(("Request", "Response")) else "msg"
    try:
        return getattr(importlib.import_module(f"{package}.{sort}"), name)
    except (ImportError, AttributeError) as fault:
        raise UnknownTypeError(f"ROS's {kind} cannot be imported: {fault}") from fault
