"""Who may talk to the server: pages that it served itself, on names that are its own."""
from __future__ import annotations

import hmac
import secrets
from typing import Awaitable, Callable, Optional
from urllib.parse import urlsplit

from aiohttp import web

from ..editor_options import EditorOptions, is_loopback

COOKIE = "my_simulations_editor"
Handler = Callable[[web.Request], Awaitable[web.StreamResponse]]

_HEADERS = {
    "X-Content-Type-Options": "nosniff", "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin", "X-Frame-Options": "DENY",
}
_POLICY = "Content-Security-Policy"
_NOTHING = "sandbox; default-src 'none'; frame-ancestors 'none'"


class Guard:
    """Checks Host, Origin and, where others can reach the server, a token.

    A page of another site cannot use a browser on this machine against us: its Origin is foreign,
    and a name that was made to point here (DNS rebinding) is no name of ours.
    """

    def __init__(self, options: EditorOptions) -> None:
        self._open = is_loopback(options.host)
        self.token = "" if self._open else options.token or secrets.token_urlsafe(24)
        self._hosts = {"127.0.0.1", "localhost", "::1", options.host.lower().strip("[]")}

    @web.middleware
    async def middleware(self, request: web.Request, handler: Handler) -> web.StreamResponse:
        """Refuse what is foreign; every answer gets careful headers, refusals too.

        Whatever is not the page may do nothing if a browser opens it by itself: it may come from a
        model that somebody else made.
        """
        problem = self._problem(request)
        try:
            if problem:
                raise web.HTTPForbidden(text=problem + "\n")
            response = await handler(request)
        except web.HTTPException as refusal:
            refusal.headers.update(_HEADERS)
            refusal.headers[_POLICY] = _NOTHING
            raise
        if not response.prepared:
            response.headers.update(_HEADERS)
            response.headers.setdefault(_POLICY, _NOTHING)
            if self.token and request.query.get("token"):
                response.set_cookie(COOKIE, self.token, httponly=True, samesite="Strict")
        return response

    def _problem(self, request: web.Request) -> str:
        host = _host_of("//" + request.headers.get("Host", ""))
        if host is None or (self._open and host not in self._hosts):
            return "this server is not known by that name"
        origin = request.headers.get("Origin")
        if origin is not None and _netloc_of(origin) != request.headers.get("Host", ""):
            return "pages of other sites may not use this server"
        if request.headers.get("Sec-Fetch-Site", "none") == "cross-site" and (
                request.path != "/"):
            return "pages of other sites may not use this server"
        if self.token:
            shown = request.query.get("token") or request.cookies.get(COOKIE, "")
            if not hmac.compare_digest(shown.encode(), self.token.encode()):
                return "the token is missing or wrong; use the whole address that was printed"
        return ""


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
