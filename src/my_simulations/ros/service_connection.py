"""Calls services without rospy: http://wiki.ros.org/ROS/TCPROS, "Service Requests".

To import rospy takes 60 ms and to import all of gazebo_msgs 70 ms, most of what a short command
takes that calls two services.
"""
from __future__ import annotations

import importlib.util
import os
import socket
import struct
from importlib import import_module
from io import BytesIO
from typing import Any, Dict
from urllib.parse import urlparse

from ..errors import SimulationError
from .lifecycle import master_api
from .lifecycle.light_imports import import_genpy

_LENGTH = struct.Struct("<I")


class ServiceCallError(SimulationError):
    """A service is not offered, refused the connection, or reported that a call has failed."""


def service_class(package: str, name: str) -> Any:
    """The class of a service; of its package no other is imported.

    Raises ImportError: the package or the service does not exist.
    """
    import_genpy()  # first: the messages import it, and NumPy with it
    found = importlib.util.find_spec(package)
    for folder in (found.submodule_search_locations or ()) if found is not None else ():
        path = os.path.join(folder, "srv", f"_{name}.py")
        spec = importlib.util.spec_from_file_location(f"{package}.srv._{name}", path)
        if spec is not None and spec.loader is not None and os.path.isfile(path):
            module = importlib.util.module_from_spec(spec)
            spec.loader.exec_module(module)
            return getattr(module, name)
    return getattr(import_module(f"{package}.srv"), name)


class ServiceConnection:
    """A connection to a service, which stays open for further calls (`persistent` in TCPROS)."""

    def __init__(self, master: str, caller: str, name: str, kind: Any) -> None:
        """Connect.

        Args:
            master: URI of the ROS master.
            caller: full name of the calling node.
            name: full name of the service.
            kind: its class.

        Raises:
            ServiceCallError: no node offers it, or that node refuses this class.
            OSError: no connection.
        """
        self._kind = kind
        found = master_api.call(master, "lookupService", caller, name)
        where = urlparse(found or "")
        if not where.hostname or not where.port:
            raise ServiceCallError(f"service [{name}] unavailable")
        self._socket = socket.create_connection((where.hostname, where.port))
        try:
            self._socket.settimeout(None)
            self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self._shake_hands({"callerid": caller, "service": name, "md5sum": kind._md5sum,
                               "type": kind._type, "persistent": "1"})
        except BaseException:
            self.close()
            raise

    def __call__(self, **fields: Any) -> Any:
        """The response to a request with these fields.

        Raises:
            ServiceCallError: the service reported an error.
            OSError: the connection ended.
        """
        import genpy

        buffer = BytesIO()
        try:
            self._kind._request_class(**fields).serialize(buffer)
        except genpy.SerializationError as fault:
            raise ServiceCallError(f"unable to send the request: {fault}") from fault
        self._send(buffer.getvalue())
        done = self._exactly(1)
        body = self._receive_bytes()
        if done != b"\1":
            raise ServiceCallError("service responded with an error: "
                                   + body.decode("utf-8", "replace"))
        try:
            return self._kind._response_class().deserialize(body)
        except genpy.DeserializationError as fault:
            raise ServiceCallError(f"unable to read the response: {fault}") from fault

    def close(self) -> None:
        self._socket.close()

    def _shake_hands(self, header: Dict[str, str]) -> None:
        fields = [f"{key}={value}".encode() for key, value in header.items()]
        self._send(b"".join(_LENGTH.pack(len(field)) + field for field in fields))
        answer, at = self._receive_bytes(), 0
        while at + _LENGTH.size <= len(answer):
            (length,) = _LENGTH.unpack_from(answer, at)
            at += _LENGTH.size
            key, _, value = answer[at:at + length].decode("utf-8", "replace").partition("=")
            if key == "error":
                raise ServiceCallError(value)
            at += length

    def _send(self, body: bytes) -> None:
        self._socket.sendall(_LENGTH.pack(len(body)) + body)

    def _receive_bytes(self) -> bytes:
        (length,) = _LENGTH.unpack(self._exactly(_LENGTH.size))
        return self._exactly(length)

    def _exactly(self, count: int) -> bytes:
        found = bytearray()
        while len(found) < count:
            chunk = self._socket.recv(min(count - len(found), 1 << 20))
            if not chunk:
                raise ConnectionResetError("the connection was closed")
            found += chunk
        return bytes(found)
