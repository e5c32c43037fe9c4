"""Messages over a stream socket between our own processes: a length and a pickle."""
from __future__ import annotations

import pickle
import select
import socket
import struct
from typing import Any, List

_LENGTH = struct.Struct("=Q")
_CHUNK = 1 << 18


class Wire:
    """One end. Several threads may send with a lock of the caller; only one may receive."""

    def __init__(self, sock: socket.socket) -> None:
        self.sock = sock
        self._pending = bytearray()

    def send(self, message: object) -> None:
        """Send a message completely. Raises OSError if the other side is closed."""
        body = pickle.dumps(message, protocol=pickle.HIGHEST_PROTOCOL)
        self.sock.sendall(_LENGTH.pack(len(body)) + body)

    def receive(self, timeout: float) -> List[Any]:
        """All complete messages received; waits up to `timeout` s for the first bytes.

        Raises EOFError if the other side is closed.
        """
        while True:
            if not select.select([self.sock], [], [], timeout)[0]:
                return []
            try:
                chunk = self.sock.recv(_CHUNK)
            except ConnectionResetError as fault:
                raise EOFError from fault
            if not chunk:
                raise EOFError
            self._pending += chunk
            found = self._whole()
            if found:
                return found
            timeout = 60.0  # the rest of a large message is on its way

    def _whole(self) -> List[Any]:
        found, at = [], 0
        while len(self._pending) >= at + _LENGTH.size:
            (length,) = _LENGTH.unpack_from(self._pending, at)
            end = at + _LENGTH.size + length
            if len(self._pending) < end:
                break
            found.append(pickle.loads(memoryview(self._pending)[at + _LENGTH.size:end]))
            at = end
        if at:
            self._pending = self._pending[at:]
        return found
