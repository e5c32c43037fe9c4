"""Registers rows of the interface table as services and topics."""
from __future__ import annotations

import importlib
from typing import Any, Callable, Dict, Iterable, List, Optional

import rospy

from .endpoints import Endpoint, LastingService, make_service_callback
from .interface import BY_ROSPY, SERVES, SUBSCRIBES, Direction, Row, row_of

SUBSCRIBER_QUEUE = 10


def class_of(row: Row) -> Any:
    """Import the message or service class of a row.

    Raises ImportError: the package is not built, or was built before the definition was added.
    """
    package, name = row.type.split("/")
    module = importlib.import_module(f"{package}.{'srv' if row.direction is SERVES else 'msg'}")
    try:
        return getattr(module, name)
    except AttributeError as error:
        raise ImportError(f"{module.__name__} has no {name}") from error


def advertise_topic(name: str, **options: Any) -> rospy.Publisher:
    """Advertise a topic of the table; `options` as rospy's."""
    row = row_of(name, Direction.PUBLISHES)
    return rospy.Publisher(row.graph_name, class_of(row), **options)


Replace = Callable[[Row], Optional[Callable[..., Any]]]
"""Returns a handler that is called instead of that of a row; None for the row's own."""


def register_endpoints(rows: Iterable[Row], handlers: Dict[str, Any],
                       replace: Replace = lambda _: None) -> List[Any]:
    """Advertise the services and subscribe to the topics among `rows`.

    Published topics are advertised by their publishers. A service whose class is not installed is
    skipped with a warning.

    Args:
        rows: rows of the table.
        handlers: objects with the handlers, by the first half of `Row.handler`.
        replace: replaces handlers of some rows.

    Returns:
        The services and subscribers; keep a reference to them.
    """
    found: List[Any] = []
    for row in rows:
        if row.handler == BY_ROSPY or row.direction not in (SERVES, SUBSCRIBES):
            continue
        try:
            kind = class_of(row)
        except ImportError:
            rospy.logwarn("service %s is not available: %s is not built; run tools/run",
                          row.name, row.type)
            continue
        group, method = row.handler.split(".")
        handler = replace(row) or getattr(handlers[group], method)
        if row.direction is SERVES:
            found.append(_service(row, kind, handler, getattr(handlers[group], "responses", {})))
        else:
            found.append(rospy.Subscriber(row.graph_name, kind, handler, tcp_nodelay=True,
                                          queue_size=SUBSCRIBER_QUEUE))
    return found


def _service(row: Row, kind: Any, handler: Callable[[Any, Any], str],
             responses: Dict[str, Any]) -> rospy.Service:
    method = row.handler.split(".")[1]
    endpoint = Endpoint(row.name, row.title, kind, handler, responses.get(method))
    return LastingService(row.graph_name, kind, make_service_callback(endpoint))
