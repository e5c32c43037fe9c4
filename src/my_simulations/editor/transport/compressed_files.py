"""Files of the page in gzip form, which takes a quarter of the bytes."""
from __future__ import annotations

import asyncio
import gzip
import os
from typing import Dict, Optional, Tuple

from aiohttp import hdrs, web

_ENDINGS = frozenset((".js", ".css", ".json", ".svg"))
_SMALLEST_BYTES = 1024
_CONDITIONS = (hdrs.IF_MODIFIED_SINCE, hdrs.IF_NONE_MATCH, hdrs.IF_RANGE, hdrs.RANGE)


class CompressedFiles:
    """Compresses each file once, until it changes. Used in one event loop."""

    def __init__(self) -> None:
        self._kept: Dict[str, Tuple[Tuple[int, int], bytes]] = {}

    async def response(self, request: web.Request, path: str, kind: str,
                       cache_control: str) -> Optional[web.Response]:
        """The file in gzip form.

        Returns None, for the file as it is, if the browser accepts no gzip, asks for a part or
        for a change, or if the file is small, binary or missing.

        Args:
            request: what the browser asks for.
            path: the file.
            kind: its type, for `Content-Type`.
            cache_control: for `Cache-Control`.
        """
        if not _accepts_gzip(request) or any(name in request.headers for name in _CONDITIONS) or (
                os.path.splitext(path)[1].lower() not in _ENDINGS):
            return None
        try:
            found = os.stat(path)
            state = (found.st_size, found.st_mtime_ns)
            if found.st_size < _SMALLEST_BYTES:
                return None
            kept = self._kept.get(path)
            if kept is None or kept[0] != state:
                loop = asyncio.get_running_loop()
                kept = self._kept[path] = (state, await loop.run_in_executor(None, _packed, path))
        except OSError:
            return None  # the answer for the file as it is reports that
        response = web.Response(body=kept[1], headers={
            hdrs.CONTENT_TYPE: kind, hdrs.CONTENT_ENCODING: "gzip", hdrs.VARY: "Accept-Encoding",
            hdrs.CACHE_CONTROL: cache_control})
        response.last_modified = found.st_mtime
        return response


def _accepts_gzip(request: web.Request) -> bool:
    """Whether `Accept-Encoding` has gzip with a weight above 0 (RFC 9110, 12.5.3)."""
    for entry in request.headers.get(hdrs.ACCEPT_ENCODING, "").split(","):
        name, _, weight = entry.replace(" ", "").lower().partition(";")
        if name == "gzip":
            return weight not in ("q=0", "q=0.0", "q=0.00", "q=0.000")
    return False


def _packed(path: str) -> bytes:
    with open(path, "rb") as stream:
        return gzip.compress(stream.read(), 6)
