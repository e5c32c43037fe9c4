"""Messages of ROS as dataclasses with NumPy arrays; no package of ROS is needed.

`from my_simulations.messages import geometry_msgs` gives the standard types of a package, such as
`geometry_msgs.Twist`; `to_ros` and `from_ros` convert where ROS is installed.
"""
from __future__ import annotations

from typing import Any, List

from .array_views import pixels, points
from .conversion import MessageFieldError
from .definitions import standard_definitions
from .message_types import Message, MessageTypes, UnknownTypeError, standard_type
from .ros_conversion import from_ros, to_ros
from .time_values import Duration, Time

__all__ = ["Duration", "Message", "MessageFieldError", "MessageTypes", "Time", "UnknownTypeError",
           "from_ros", "pixels", "points", "standard_type", "to_ros"]


class _Package:
    """The standard types of a package, as attributes."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, name: str) -> Any:
        if f"{self._name}/{name}" in standard_definitions():
            return standard_type(f"{self._name}/{name}")
        raise AttributeError(f"{self._name} has no standard message type {name!r}")

    def __dir__(self) -> List[str]:
        return sorted(kind.partition("/")[2] for kind in standard_definitions()
                      if kind.startswith(f"{self._name}/"))


def __getattr__(name: str) -> Any:
    if any(kind.startswith(f"{name}/") for kind in standard_definitions()):
        return _Package(name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
