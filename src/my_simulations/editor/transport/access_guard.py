"""Who may talk to the server: who has its token, with pages that it served itself.

It also ends idle connections, so that no client can use up the server's descriptors.
"""
from __future__ import annotations

import asyncio
import hmac
import os
import secrets
from typing import Any, Awaitable, Callable, Dict, Optional
from urllib.parse import urlsplit

from aiohttp import web

from ..editor_options import TOKEN_VARIABLE, EditorOptions, is_loopback

COOKIE = "my_simulations_editor"
"""Before the port: browsers keep cookies for a host, and several editors may run on it."""

Handler = Callable[[web.Request], Awaitable[web.StreamResponse]]

_HEADERS = {
    "X-Content-Type-Options": "nosniff", "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin", "X-Frame-Options": "DENY",
}
_POLICY = "Content-Security-Policy"
_NOTHING = "sandbox; default-src 'none'; frame-ancestors 'none'"


class Guard:
    """Checks token, Host and Origin.

    Other users of this machine, and other machines, do not have the token. A page of another site
    cannot use a browser on this machine against us: its Origin is foreign, and a name that was made
    to point here (DNS rebinding) is no name of ours.

    Attributes:
        token: "" where none is asked for.
        silent: connections that have not shown a right request yet.
    """

    def __init__(self, options: EditorOptions) -> None:
        self._open = is_loopback(options.host)
        self.token = _token(options, self._open)
        self.silent = SilentConnections()
        self._hosts = {"127.0.0.1", "localhost", "::1", options.host.lower().strip("[]")}

    @web.middleware
    async def middleware(self, request: web.Request, handler: Handler) -> web.StreamResponse:
        """Refuse what is foreign; every answer gets careful headers, refusals too.

        Other documents may do nothing if a browser opens them directly: they may come from a
        model of unknown origin.
        """
        problem = self._problem(request)
        try:
            if problem:
                raise web.HTTPForbidden(text=problem + "\n")
            self.silent.request_received(request.protocol)
            response = await handler(request)
        except web.HTTPException as refusal:
            if problem:
                refusal.force_close()
            refusal.headers.update(_HEADERS)
            refusal.headers[_POLICY] = _NOTHING
            raise
        if not response.prepared:
            response.headers.update(_HEADERS)
            response.headers.setdefault(_POLICY, _NOTHING)
            if self.token and self._is_token(request.query.get("token", "")):
                response.set_cookie(_cookie(request), self.token, httponly=True,
                                    samesite="Strict")
        return response

    def _problem(self, request: web.Request) -> str:
        host = _host_of("//" + request.headers.get("Host", ""))
        if host is None or (self._open and host not in self._hosts):
            return "this server is not known by that name"
        origin = request.headers.get("Origin")
        if origin is not None and _netloc_of(origin) != request.headers.get("Host", ""):
            return "pages of other sites may not use this server"
        # Another port of this machine is the same site, but another origin.
        if request.headers.get("Sec-Fetch-Site", "none") not in ("none", "same-origin") and (
                request.path != "/" or request.headers.get("Sec-Fetch-Dest") != "document"):
            return "pages of other sites may not use this server"
        shown = (request.query.get("token", ""), request.cookies.get(_cookie(request), ""))
        if self.token and not any(map(self._is_token, shown)):
            return ("the token is missing or wrong; use the whole address that the simulator, or "
                    "gzclient, prints")
        return ""

    def _is_token(self, shown: str) -> bool:
        return hmac.compare_digest(shown.encode("utf-8", "replace"), self.token.encode())


def _token(options: EditorOptions, is_local: bool) -> str:
    wanted = options.token
    if wanted is None:
        wanted = os.environ.get(TOKEN_VARIABLE) or secrets.token_urlsafe(24)
        if wanted == "off":
            wanted = ""
    return wanted if wanted or is_local else secrets.token_urlsafe(24)


def _cookie(request: web.Request) -> str:
    address = request.get_extra_info("sockname") or ("", 0)
    return f"{COOKIE}_{address[1]}"


def _netloc_of(url: str) -> Optional[str]:
    try:
        return urlsplit(url).netloc
    except ValueError:
        return None


def _host_of(url: str) -> Optional[str]:
    try:
        return urlsplit(url).hostname
    except ValueError:
        return None


SILENCE_S = 10.0
"""Longest time from a connection's beginning to its first right request, in seconds."""

MOST_SILENT = 64
"""Connections without a right request at a time; another one ends the oldest."""


class SilentConnections:
    """Ends connections without a right request. Used in the server's loop only."""

    def __init__(self) -> None:
        self._waiting: Dict[Any, None] = {}  # in the order of their beginning

    def with_deadline(self, factory: Callable[[], Any],
                loop: asyncio.AbstractEventLoop) -> Callable[[], asyncio.Protocol]:
        """The factory of a server's protocols, each of them with a deadline."""
        def make() -> Any:
            protocol = factory()
            if len(self._waiting) >= MOST_SILENT:
                # Those that were accepted just now have no transport yet.
                self._end(next((one for one in self._waiting if one.transport is not None), None))
            self._waiting[protocol] = None
            loop.call_later(SILENCE_S, self._end, protocol)
            return protocol

        return make

    def request_received(self, protocol: Any) -> None:
        self._waiting.pop(protocol, None)

    def _end(self, protocol: Any) -> None:
        if protocol in self._waiting:
            del self._waiting[protocol]
            if protocol.transport is not None:
                protocol.transport.abort()
