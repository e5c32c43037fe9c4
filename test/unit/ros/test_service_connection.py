"""Service calls without rospy: requests, responses and faults."""
from __future__ import annotations

import socket
import struct
import threading
from typing import Callable, Dict, Iterator, List

import pytest

from my_simulations.ros import service_connection
from my_simulations.ros.service_connection import (
    ServiceCallError,
    ServiceConnection,
    service_class,
)

LENGTH = struct.Struct("<I")


class Service:
    """A service on a port of its own, which answers every request with the same bytes."""

    def __init__(self, header: bytes, answer: bytes) -> None:
        self.headers: List[Dict[str, str]] = []
        self.requests: List[bytes] = []
        self._answers = header, answer
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.uri = f"rosrpc://127.0.0.1:{self._listener.getsockname()[1]}"
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def _serve(self) -> None:
        sock, _ = self._listener.accept()
        with sock, sock.makefile("rwb") as stream:
            def block() -> bytes:
                (length,) = LENGTH.unpack(stream.read(LENGTH.size))
                return stream.read(length)

            fields, at, found = block(), 0, {}
            while at < len(fields):
                (length,) = LENGTH.unpack_from(fields, at)
                key, _, value = fields[at + 4:at + 4 + length].decode().partition("=")
                found[key], at = value, at + 4 + length
            self.headers.append(found)
            stream.write(self._answers[0])
            stream.flush()
            if not self._answers[1]:
                return
            self.requests.append(block())
            stream.write(self._answers[1])
            stream.flush()

    def end(self) -> None:
        self._thread.join(60.0)
        self._listener.close()


def header(**fields: str) -> bytes:
    parts = [f"{key}={value}".encode() for key, value in fields.items()]
    body = b"".join(LENGTH.pack(len(part)) + part for part in parts)
    return LENGTH.pack(len(body)) + body


@pytest.fixture(name="offer")
def offer_fixture(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[bytes, bytes], Service]]:
    made: List[Service] = []

    def offer(first: bytes, answer: bytes) -> Service:
        made.append(Service(first, answer))
        monkeypatch.setattr(service_connection.master_api, "call", lambda *_: made[-1].uri)
        return made[-1]

    yield offer
    for service in made:
        service.end()


def connection() -> ServiceConnection:
    """A connection to the service `/here`."""
    return ServiceConnection("http://127.0.0.1:1", "/me", "/here", service_class(
        "std_srvs", "SetBool"))


def test_a_request_is_sent_and_its_response_is_read(
        offer: Callable[[bytes, bytes], Service]) -> None:
    text = "fertig ä".encode()
    body = b"\1" + LENGTH.pack(len(text)) + text
    service = offer(header(callerid="/it", md5sum="*"), b"\1" + LENGTH.pack(len(body)) + body)
    called = connection()
    response = called(data=True)
    called.close()
    assert response.success and response.message == "fertig ä"
    assert service.requests == [b"\1"]
    (sent,) = service.headers
    assert (sent["callerid"], sent["service"], sent["persistent"]) == ("/me", "/here", "1")
    assert sent["md5sum"] == service_class("std_srvs", "SetBool")._md5sum


def test_an_error_of_the_service_is_raised_with_its_text(
        offer: Callable[[bytes, bytes], Service]) -> None:
    offer(header(callerid="/it"), b"\0" + LENGTH.pack(7) + b"no room")
    with pytest.raises(ServiceCallError, match="responded with an error: no room"):
        connection()(data=False)


def test_a_refused_class_is_told(offer: Callable[[bytes, bytes], Service]) -> None:
    offer(header(error="md5sum differs"), b"")
    with pytest.raises(ServiceCallError, match="md5sum differs"):
        connection()


def test_a_closed_connection_is_an_error_of_the_network(
        offer: Callable[[bytes, bytes], Service]) -> None:
    offer(header(callerid="/it"), b"\1" + LENGTH.pack(9) + b"half")
    with pytest.raises(OSError, match="closed"):
        connection()(data=True)


def test_a_service_that_nobody_offers_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(service_connection.master_api, "call", lambda *_: None)
    with pytest.raises(ServiceCallError, match="unavailable"):
        connection()


def test_what_does_not_fit_the_request_is_told(offer: Callable[[bytes, bytes], Service]) -> None:
    offer(header(callerid="/it"), b"")
    with pytest.raises(ServiceCallError, match="unable to send"):
        connection()(data="never")


def test_an_unknown_package_cannot_be_imported() -> None:
    with pytest.raises(ImportError):
        service_class("no_such_package", "SetBool")
    with pytest.raises((ImportError, AttributeError)):
        service_class("std_srvs", "NoSuchService")
