"""The dynamic_reconfigure server of the physics settings.

Debian's `dynamic_reconfigure` provides the messages; its own server class calls the parameter
server thirty times at the start and closes the connection on invalid requests.
"""
from __future__ import annotations

import threading
from typing import Any, Dict, Optional

import rospy
from dynamic_reconfigure.msg import (
    BoolParameter,
    Config,
    ConfigDescription,
    DoubleParameter,
    Group,
    GroupState,
    IntParameter,
    ParamDescription,
)

from ...errors import CommandError
from ...geometry import is_finite
from ...simulator.simulator import Simulator
from ..registration import publisher
from .physics_parameters import PARAMETERS, Parameter, Value, change, present

GROUP = "Default"
LEVEL = 1
KINDS = {bool: ("bool", "bools", BoolParameter), int: ("int", "ints", IntParameter),
         float: ("double", "doubles", DoubleParameter)}
"""By Python type: name of the type, its list in a Config, and the class of an element."""


class ReconfigureServer:
    """Publishes and changes the physics parameters as dynamic_reconfigure does."""

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator
        self._lock = threading.Lock()
        self._told: Dict[str, Value] = {}
        self._stored: Optional[Dict[str, Value]] = None
        self._descriptions = publisher("parameter_descriptions", queue_size=10, latch=True)
        self._updates = publisher("parameter_updates", queue_size=10, latch=True)
        self._descriptions.publish(description())
        self._tell()

    def set(self, request: Any, response: Any) -> str:
        """Set the parameters of the request, clamped to their ranges.

        Raises:
            CommandError: an unknown parameter, or a value that is not finite.
        """
        known = {parameter.name: parameter for parameter in PARAMETERS}
        wanted: Dict[str, Value] = {}
        for kind, (word, field, _) in KINDS.items():
            for element in getattr(request.config, field):
                parameter = known.get(element.name)
                if parameter is None or type(parameter.default) is not kind:
                    raise CommandError(f"unknown {word} parameter {element.name!r}")
                wanted[element.name] = _clamped(parameter, element.value)
        for element in request.config.strs:
            raise CommandError(f"unknown str parameter {element.name!r}")
        change(self._simulator, wanted)
        self._tell()
        response.config = _config(present(self._simulator))
        return ""

    def keep_up(self) -> None:
        """Publish changes made by other means, and update the parameter server.

        Raises:
            OSError: the master does not respond; the next call tries again.
        """
        self._tell()
        with self._lock:
            values, before = self._told, self._stored or {}
            for name, value in values.items():
                if before.get(name) != value:
                    rospy.set_param(f"~{name}", value)
            self._stored = values

    def forget_stored(self) -> None:
        """Have `keep_up` store all values again, on a new parameter server."""
        with self._lock:
            self._stored = None

    def _tell(self) -> None:
        with self._lock:
            values = present(self._simulator)
            if values != self._told:
                self._told = values
                self._updates.publish(_config(values))


def description() -> ConfigDescription:
    """Names, types, ranges and defaults of the parameters, in one group."""
    parameters = [ParamDescription(parameter.name, KINDS[type(parameter.default)][0], LEVEL,
                                   parameter.meaning, "") for parameter in PARAMETERS]
    return ConfigDescription(
        groups=[Group(GROUP, "", parameters, 0, 0)],
        max=_config({parameter.name: parameter.high for parameter in PARAMETERS}),
        min=_config({parameter.name: parameter.low for parameter in PARAMETERS}),
        dflt=_config({parameter.name: parameter.default for parameter in PARAMETERS}))


def _config(values: Dict[str, Value]) -> Config:
    config = Config(groups=[GroupState(GROUP, True, 0, 0)])
    for name, value in values.items():
        _, field, element = KINDS[type(value)]
        getattr(config, field).append(element(name, value))
    return config


def _clamped(parameter: Parameter, value: Value) -> Value:
    if isinstance(value, bool):
        return value
    if not is_finite(value):
        raise CommandError(f"{parameter.name} must be finite, is {value}")
    return max(parameter.low, min(parameter.high, value))
