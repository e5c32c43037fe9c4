"""Relays connections from outside to the editor of a student, inside of the student's network.

    python3 -I relay.py PORT COOKIE LISTENING MONITORING ACTIVITY

PORT is that of the editor, COOKIE the only cookie that it receives: browsers send the cookies of
all ports of a host, also tokens of other students' editors. LISTENING and MONITORING are
descriptors of listening sockets, of browsers and of the manager of the class. A byte is written to
the descriptor ACTIVITY while browsers are connected. The standard library alone is imported.
"""
from __future__ import annotations

import asyncio
import contextlib
import os
import re
import socket
import sys
from typing import List, Set

_LONGEST_HEAD = 64 << 10
_HEAD_S = 20.0
_CONNECT_S = 60.0
_RETRY_S = 0.25
_ACTIVE_S = 2.0
_CHUNK = 64 << 10
_BUSY = (b"HTTP/1.1 503 Service Unavailable\r\nContent-Type: text/plain\r\nRetry-After: 2\r\n"
         b"Connection: close\r\n\r\nThe world of this student does not run yet. Load the page again"
         b" in some seconds.\n")


def filtered_head(head: bytes, cookie: str) -> bytes:
    """Return the head of an HTTP request with one cookie; the connection ends after the request.

    Args:
        head: up to and including the empty line.
        cookie: name of the cookie that is kept.
    """
    lines = head[:-4].split(b"\r\n")
    upgrades = any(re.match(rb"upgrade\s*:", line, re.IGNORECASE) for line in lines[1:])
    found: List[bytes] = [lines[0]]
    for line in lines[1:]:
        name, _, value = line.partition(b":")
        name = name.strip().lower()
        if name == b"cookie":
            kept = [one.strip() for one in value.split(b";")
                    if one.split(b"=")[0].strip() == cookie.encode()]
            line = b"Cookie: " + b"; ".join(kept)
            if not kept:
                continue
        elif name == b"connection" and not upgrades:
            continue
        found.append(line)
    if not upgrades:
        found.append(b"Connection: close")
    return b"\r\n".join(found) + b"\r\n\r\n"


class Relay:
    """Relays connections of browsers to one editor.

    Args:
        port: port of the editor.
        cookie: name of the editor's cookie.
        activity: descriptor that receives a byte while browsers are connected.
    """

    def __init__(self, port: int, cookie: str, activity: int) -> None:
        self._port = port
        self._cookie = cookie
        self._activity = activity
        self._open: Set[asyncio.StreamWriter] = set()

    async def serve(self, listening: int, monitoring: int) -> None:
        """Serve both sockets; does not return."""
        for descriptor, handler in ((listening, self._browser), (monitoring, self._relay)):
            await asyncio.start_server(handler, sock=socket.socket(fileno=descriptor),
                                       limit=_LONGEST_HEAD)
        while True:
            if self._open:
                os.write(self._activity, b".")
            await asyncio.sleep(_ACTIVE_S)

    async def _browser(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._open.add(writer)
        os.write(self._activity, b".")
        try:
            await self._relay(reader, writer)
        finally:
            self._open.discard(writer)

    async def _relay(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        try:
            head = await asyncio.wait_for(reader.readuntil(b"\r\n\r\n"), _HEAD_S)
            editor = await self._connect()
            if editor is None:
                writer.write(_BUSY)
                await writer.drain()
                return
            editor[1].write(filtered_head(head, self._cookie))
            await _join(reader, writer, *editor)
        except (OSError, asyncio.IncompleteReadError, asyncio.LimitOverrunError,
                asyncio.TimeoutError):
            pass   # one side has gone, or sends no HTTP: the connection ends
        finally:
            writer.close()

    async def _connect(self) -> "tuple[asyncio.StreamReader, asyncio.StreamWriter] | None":
        """Connect to the editor, which may be starting; None if it does not come."""
        until = asyncio.get_running_loop().time() + _CONNECT_S
        while asyncio.get_running_loop().time() < until:
            try:
                return await asyncio.open_connection("127.0.0.1", self._port)
            except OSError:
                await asyncio.sleep(_RETRY_S)
        return None


async def _join(reader: asyncio.StreamReader, writer: asyncio.StreamWriter,
                inner: asyncio.StreamReader, outer: asyncio.StreamWriter) -> None:
    """Copy both ways until one side has ended."""
    ways = [asyncio.ensure_future(_copy(reader, outer)),
            asyncio.ensure_future(_copy(inner, writer))]
    try:
        # The answer decides: a browser that has nothing more to send still receives it.
        await ways[1]
    finally:
        ways[0].cancel()
        with contextlib.suppress(OSError, asyncio.CancelledError):
            await ways[0]
        outer.close()


async def _copy(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    while True:
        data = await reader.read(_CHUNK)
        if not data:
            with contextlib.suppress(OSError):
                writer.write_eof()
            return
        writer.write(data)
        await writer.drain()


def main(words: List[str]) -> None:
    """Relay until the process ends."""
    port, listening, monitoring, activity = (int(words[index]) for index in (1, 3, 4, 5))
    os.set_blocking(activity, True)
    asyncio.run(Relay(port, words[2], activity).serve(listening, monitoring))


if __name__ == "__main__":
    main(sys.argv)
