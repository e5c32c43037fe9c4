"""Turns the outcome of a service handler into a response."""
from __future__ import annotations

import socket
import struct
import traceback
from dataclasses import dataclass
from operator import attrgetter
from typing import Any, Callable, Iterator

import rospy
from rospy.exceptions import TransportException, TransportTerminated

from ..errors import CommandError, InputError
from ..xml_characters import check_characters, check_tree

LONGEST_STATUS = 10_000
"""Characters of a status message."""


@dataclass(frozen=True)
class Endpoint:
    """One service.

    Attributes:
        name: below the node's own name.
        title: prefix of every status message, e.g. `SpawnModel`.
        type: service class.
        handler: gets the request and the response to fill; returns the status message without its
            title, or raises `CommandError` or `InputError` for a failure.
        response: class of the responses, when it is not the type's own.
    """

    name: str
    title: str
    type: Any
    handler: Callable[[Any, Any], str]
    response: Any = None


def make_service_callback(endpoint: Endpoint) -> Callable[[Any], Any]:
    """Make the rospy callback of a service; it responds to every request, also after an exception.

    A response without `success` (std_srvs/Empty) cannot report an error; the call fails at
    transport level instead, so the client gets an exception with the text.
    """
    response_class = endpoint.response or endpoint.type._response_class
    has_status = "status_message" in response_class.__slots__
    check_texts = TextCheck(endpoint.type._request_class)

    def answer(request: Any) -> Any:
        response = response_class()
        try:
            check_texts(request)
            text = endpoint.handler(request, response)
            succeeded = True
        except (CommandError, InputError) as fault:
            text, succeeded = str(fault), False
        except Exception as fault:  # an internal error: the client still gets a response
            rospy.logerr("%s: internal error in %s:\n%s", endpoint.title, endpoint.name,
                         traceback.format_exc())
            text, succeeded = f"internal error: {type(fault).__name__}: {fault}", False
        text = _shorten_message(text)
        if has_status:
            response.success = succeeded
            response.status_message = f"{endpoint.title}: {text}"
        elif not succeeded:
            raise rospy.ServiceException(f"{endpoint.title}: {text}")
        return response

    return answer


def _shorten_message(text: str) -> str:
    """A status message without the middle of a name of a megabyte that it repeats."""
    more = len(text) - LONGEST_STATUS
    if more <= 0:
        return text
    half = LONGEST_STATUS // 2
    return f"{text[:half]}... ({more} more characters) ...{text[-half:]}"


class TextCheck:
    """Refuses texts of a request that no world file could hold: names stay in the world.

    Documents are left to their reader, which knows the line.

    Args:
        kind: class of the requests.
    """

    def __init__(self, kind: Any) -> None:
        self._fields = [(path, attrgetter(path)) for path in _text_paths(kind(), "")]

    def __call__(self, request: Any) -> None:
        """Raises CommandError with field and character."""
        for path, read in self._fields:
            value = read(request)
            if isinstance(value, str):
                check_characters(value, path)
            else:
                check_tree(value, path)


def _text_paths(message: Any, path: str) -> Iterator[str]:
    """The fields of a message and of the messages in it that are texts or lists of texts."""
    for name, kind in zip(message.__slots__, message._slot_types):
        if kind.startswith("string"):
            if not name.endswith("_xml"):
                yield f"{path}{name}"
        elif "/" in kind and not kind.endswith("]"):
            yield from _text_paths(getattr(message, name), f"{path}{name}.")


class LastingService(rospy.Service):
    """A rospy service with TCP_NODELAY that survives malformed requests.

    rospy leaves Nagle's algorithm on, which delays small responses behind unacknowledged ones,
    and a request that cannot be deserialised ends its thread while the client keeps waiting.
    """

    def handle(self, transport: Any, header: Any) -> None:
        """Serve one connection (rospy calls this in a thread of its own)."""
        transport.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        try:
            super().handle(transport, header)
        except TransportTerminated:
            transport.close()
        except (TransportException, struct.error, OSError) as fault:
            rospy.logwarn("[%s] rejected a malformed request: %s",
                          self.resolved_name, fault)
            self._refuse(transport, f"malformed request: {fault}")

    def _refuse(self, transport: Any, text: str) -> None:
        try:
            self._write_service_error(transport, text)
        except (TransportException, OSError) as fault:
            rospy.logdebug("[%s] client disconnected: %s", self.resolved_name, fault)
        transport.close()
