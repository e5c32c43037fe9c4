"""Messages over a stream socket between our own processes: a length and a pickle."""
from __future__ import annotations

import contextlib
import pickle
import socket
import struct
from typing import Any, List

from ..readable import wait_until_readable

_LENGTH = struct.Struct("=Q")
_CHUNK = 1 << 18
_LONGEST = 1 << 32


class Wire:
    """One end. Several threads may send with a lock of the caller; only one may receive.

    Args:
        sock: the socket.
        longest: the longest message that is received, bytes.
    """

    def __init__(self, sock: socket.socket, longest: int = _LONGEST) -> None:
        self.sock = sock
        self._longest = longest
        # rospy sets a default timeout for all sockets of a process as soon as it subscribes. One
        # made then does not block, in the child neither: what does not fit at once would be lost.
        sock.settimeout(None)
        self._pending = bytearray()
        self._held = b""

    def hold(self, message: object) -> None:
        """Keep a message until the next `send` or `send_held`: the other side wakes up once."""
        self._held += _packed(message)

    def send(self, message: object) -> None:
        """Send a message completely, after those that are kept.

        Raises OSError if the other side is closed.
        """
        self._send(_packed(message))

    def send_now(self, message: object) -> bool:
        """Send a message after those that are kept, without waiting for the other side.

        Returns False if not all of it fits; `send` and `send_held` send the rest. Raises OSError
        if the other side is closed.
        """
        self.hold(message)
        with contextlib.suppress(BlockingIOError):
            sent = self.sock.send(self._held, socket.MSG_DONTWAIT)
            self._held = self._held[sent:]
        return not self._held

    def send_held(self) -> None:
        """Send the messages that are kept. Raises OSError if the other side is closed."""
        if self._held:
            self._send(b"")

    def _send(self, packed: bytes) -> None:
        held, self._held = self._held, b""
        try:
            self.sock.sendall(held + packed)
        except OSError:
            self.shut_down()  # a part may have left: nothing that follows could be read
            raise

    def shut_down(self) -> None:
        """Shut the connection down: both sides read its end."""
        with contextlib.suppress(OSError):  # it may be shut down already
            self.sock.shutdown(socket.SHUT_RDWR)

    def receive(self, timeout: float, rest: float = 60.0) -> List[Any]:
        """All complete messages received.

        Args:
            timeout: s to wait for the first bytes.
            rest: s to wait for the rest of a message, each time that a part has arrived.

        Raises EOFError if the other side is closed, or sends what is no message.
        """
        while True:
            if not wait_until_readable(self.sock.fileno(), timeout):
                return []
            try:
                chunk = self.sock.recv(_CHUNK)
            except ConnectionResetError as fault:
                raise EOFError from fault
            if not chunk:
                raise EOFError
            self._pending += chunk
            found = self._complete_messages()
            if found:
                return found
            timeout = rest

    def _complete_messages(self) -> List[Any]:
        found, at = [], 0
        while len(self._pending) >= at + _LENGTH.size:
            (length,) = _LENGTH.unpack_from(self._pending, at)
            if length > self._longest:
                raise EOFError(f"damaged message: its length would be {length} bytes")
            end = at + _LENGTH.size + length
            if len(self._pending) < end:
                break
            try:
                found.append(pickle.loads(memoryview(self._pending)[at + _LENGTH.size:end]))
            except Exception as fault:  # pickle raises what the bytes make it
                raise EOFError(f"damaged message: {fault}") from fault
            at = end
        if at:
            self._pending = self._pending[at:]
        return found


def _packed(message: object) -> bytes:
    body = pickle.dumps(message, protocol=pickle.HIGHEST_PROTOCOL)
    return _LENGTH.pack(len(body)) + body
