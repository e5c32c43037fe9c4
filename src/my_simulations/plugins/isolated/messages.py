"""The messages between the node and the process of a plugin.

The node sends a `Call`; the process answers with `Done` or `Raised`, and may send a `Query`
before, which the node answers with `Value` or `QueryFailed`. Calls nest: a function that the node
calls to answer a `Query` belongs to the plugin, too.
"""
from __future__ import annotations

import signal
from typing import Any, Dict, List, NamedTuple, Optional, Tuple, Union

from ...description.plugin import PluginSpec
from ...description.sensor import Sensor

TRACE_SIGNAL = signal.SIGRTMIN + 4
"""Has the process write where it is, also while a C function runs."""

CONTEXT = 0
"""The number of the context among the handles."""

PROPERTIES = frozenset((
    "step_size", "is_stepped_manually", "pose", "twist", "gravity", "seed", "magnetic_field",
    "wind",
    "spherical_coordinates", "description"))
"""Properties of the context whose values are sent."""

METHODS = frozenset((
    "transmissions", "move", "move_model", "hold", "scoped", "joint_spec", "set_wheel_slip",
    "mimic", "models", "attach", "detach", "attached_link", "efforts", "set_joint_positions",
    "joint_wrench", "contacts", "scan", "photograph", "sensors", "link_names", "lights",
    "set_light", "set_material", "use_namespace", "message", "stamp", "parameter",
    "search_parameter"))
"""Methods of the context whose results are sent."""

HANDLES = {"link": "link", "model_link": "link", "joint": "joint", "publish": "topic",
           "subscribe": "end", "serve": "end", "every": "end", "observe": "end", "once": "end",
           "on_world_change": "end"}
"""Methods of the context that return handles, and the kinds of these."""

CALLS_WITHOUT_RESULT = frozenset(("set_planar_velocity", "set_wrench", "set_wrench_law",
                                  "transform",
                                  "info", "warn", "declare_parameters"))
"""Methods of the context without a result."""

HANDLE_CALLS = {"link": frozenset(()), "joint": frozenset(("drive", "set_servo")),
                 "topic": frozenset(("publish", "close")), "end": frozenset(("close", "end"))}
"""Methods of the handles without a result, by kind."""


class Start(NamedTuple):
    """What a process must have before it makes the plugin.

    Attributes:
        where: `package.module:Class`.
        spec: the element.
        sensor, sensor_link, sensor_joint: as in `Context`.
    """

    where: str
    spec: PluginSpec
    sensor: Optional[Sensor]
    sensor_link: str
    sensor_joint: str


class Readings(NamedTuple):
    """The values that most calls read, as they are at the beginning of a call.

    Attributes:
        states: by the numbers of the handles: pose and twist of a link, position, velocity and
            puts of a joint, whether a topic is wanted. None where reading raises an exception.
    """

    model: str
    now_ns: int
    step: int
    states: Dict[int, Any]


class Call(NamedTuple):
    """Call a function of the plugin by its number, or a method of the plugin by its name."""

    function: Union[int, str]
    arguments: Tuple[Any, ...]
    readings: Readings


class HandleCall(NamedTuple):
    """Call a method of a handle; nothing is returned.

    Attributes:
        arguments: pickled, so that one that cannot be is reported in the line that passes it.
    """

    handle: int
    name: str
    arguments: bytes


class Query(NamedTuple):
    """Call a method of the context, or read a property; `handle_calls` come first."""

    handle_calls: List[HandleCall]
    name: str
    arguments: Tuple[Any, ...]
    named: Dict[str, Any]


class Value(NamedTuple):
    """The answer to a `Query`."""

    value: Any


class QueryFailed(NamedTuple):
    """The exception that answers a `Query`."""

    fault: Exception


class Done(NamedTuple):
    """A call has returned."""

    handle_calls: List[HandleCall]
    result: Any


class Raised(NamedTuple):
    """A call has raised an exception.

    Attributes:
        fault: the exception if it is one that the context defines, for callers that handle it.
        text: the exception for the user, with function, file and line.
    """

    handle_calls: List[HandleCall]
    fault: Optional[Exception]
    text: str


class Function(NamedTuple):
    """Stands for a function of the plugin among the arguments of a `Query`."""

    number: int


class Reference(NamedTuple):
    """Stands for a handle among the arguments of a `Query`."""

    number: int


class HandleMade(NamedTuple):
    """A handle as the value of a `Query`, with what never changes of it, and its state."""

    number: int
    kind: str
    facts: Dict[str, Any]
    state: Any
