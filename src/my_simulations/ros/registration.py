"""From rows of the interface table to services and topics on the graph."""
from __future__ import annotations

import importlib
from typing import Any, Callable, Dict, Iterable, List

import rospy

from .endpoints import Endpoint, LastingService, answering
from .interface import BY_ROSPY, HEARS, SERVES, Direction, Row, row_of

HEARD_QUEUE = 10


def class_of(row: Row) -> Any:
    """The message or service class of a row. Raises ImportError where its package is not built."""
    package, name = row.type.split("/")
    kind = "srv" if row.direction is SERVES else "msg"
    return getattr(importlib.import_module(f"{package}.{kind}"), name)


def publisher(name: str, **options: Any) -> rospy.Publisher:
    """Advertise a topic of the table; `options` as rospy's."""
    row = row_of(name, Direction.PUBLISHES)
    return rospy.Publisher(row.graph_name, class_of(row), **options)


def register(rows: Iterable[Row], faces: Dict[str, Any]) -> List[Any]:
    """Offer the services and hear the topics among `rows`.

    Publishers are advertised by those who publish.

    Args:
        rows: of the table.
        faces: objects with the handlers, by the first half of `Row.handler`.

    Returns:
        rospy's objects, to be kept.
    """
    found: List[Any] = []
    for row in rows:
        if row.handler == BY_ROSPY or row.direction not in (SERVES, HEARS):
            continue
        try:
            kind = class_of(row)
        except ImportError:
            rospy.logwarn("%s is not offered: %s is missing; tools/run installs or builds it",
                          row.name, row.type)
            continue
        face, method = row.handler.split(".")
        handler = getattr(faces[face], method)
        if row.direction is SERVES:
            found.append(_service(row, kind, handler, getattr(faces[face], "responses", {})))
        else:
            found.append(rospy.Subscriber(row.graph_name, kind, handler, queue_size=HEARD_QUEUE,
                                          tcp_nodelay=True))
    return found


def _service(row: Row, kind: Any, handler: Callable[[Any, Any], str],
             responses: Dict[str, Any]) -> rospy.Service:
    method = row.handler.split(".")[1]
    endpoint = Endpoint(row.name, row.title, kind, handler, responses.get(method))
    return LastingService(row.graph_name, kind, answering(endpoint))
