"""The tutor's page: a tile for each student, with a link to the student's world."""
from __future__ import annotations

import hmac
import os
from typing import Any, Awaitable, Callable, Dict, List, Protocol

from aiohttp import web

from ..editor.transport.page_files import PageFiles
from ..errors import CommandError
from .class_marks import mark_shown, marks_file
from .class_plan import ClassPlan

_COOKIE = "my_simulations_class"
_HEADERS = {
    "X-Content-Type-Options": "nosniff", "Referrer-Policy": "no-referrer",
    "X-Frame-Options": "DENY", "Cache-Control": "no-store",
    "Content-Security-Policy": "default-src 'none'; style-src 'self'; script-src 'self';"
                               " connect-src 'self'; img-src 'self'; frame-ancestors 'none';"
                               " base-uri 'none'"}
_FILES = {"/tutor.js": "text/javascript", "/tutor.css": "text/css"}

Handler = Callable[[web.Request], Awaitable[web.StreamResponse]]


class ClassControl(Protocol):
    """What the page requires of the manager of the class."""

    def tiles(self) -> List[Dict[str, Any]]:
        """Return the values that the page shows, one dictionary for each student."""

    def picture(self, name: str) -> str:
        """Return a picture of a student's world, SVG. Raises CommandError: no such student."""

    async def start_world(self, name: str) -> None:
        """Start the world of a student. Raises CommandError: no such student."""

    async def stop_world(self, name: str) -> None:
        """Stop the world of a student. Raises CommandError: no such student."""


class TutorPage:
    """Serves the page to clients that show the tutor's token.

    Args:
        plan: the class.
        token: of the tutor.
        control: the class.
    """

    def __init__(self, plan: ClassPlan, token: str, control: ClassControl) -> None:
        self._plan, self._token, self._control = plan, token, control
        application = web.Application(middlewares=[self._guard])
        application.add_routes([
            web.get("/", self._file), *(web.get(path, self._file) for path in _FILES),
            web.get("/status.json", self._status),
            web.get("/students/{name}/picture.svg", self._picture),
            web.get("/marks/{inside:.*}", self._marks),
            web.post("/students/{name}/{action}", self._act)])
        self._runner = web.AppRunner(application, access_log=None)

    async def start(self) -> str:
        """Listen; returns the address with the token. Raises CommandError: the port is in use."""
        await self._runner.setup()
        try:
            await web.TCPSite(self._runner, self._plan.host, self._plan.port).start()
        except OSError as fault:
            raise CommandError(f"port {self._plan.port} cannot be used: {fault}") from None
        host = "127.0.0.1" if self._plan.host in ("0.0.0.0", "::") else self._plan.host
        return f"http://{host}:{self._plan.port}/?token={self._token}"

    async def close(self) -> None:
        """Stop."""
        await self._runner.cleanup()

    @web.middleware
    async def _guard(self, request: web.Request, handler: Handler) -> web.StreamResponse:
        shown = (request.query.get("token", ""), request.cookies.get(self._cookie, ""))
        origin = request.headers.get("Origin")
        foreign = origin is not None and origin.partition("//")[2] != request.headers.get("Host")
        site = request.headers.get("Sec-Fetch-Site", "none")
        # A page of a student is the same site, but another origin: it may only open the page.
        foreign = foreign or (site not in ("none", "same-origin") and request.path != "/")
        if foreign or not any(hmac.compare_digest(one.encode("utf-8", "replace"),
                                                  self._token.encode()) for one in shown):
            return web.Response(status=403, text="the token is missing or wrong\n",
                                headers=_HEADERS)
        response = await handler(request)
        for name, value in _HEADERS.items():
            response.headers.setdefault(name, value)
        if request.query.get("token"):
            response.set_cookie(self._cookie, self._token, httponly=True, samesite="Strict")
        return response

    @property
    def _cookie(self) -> str:
        return f"{_COOKIE}_{self._plan.port}"

    async def _file(self, request: web.Request) -> web.StreamResponse:
        name = "tutor.html" if request.path == "/" else request.path[1:]
        with open(os.path.join(PageFiles.own_folder(), "class", name), encoding="utf-8") as stream:
            return web.Response(text=stream.read(),
                                content_type=_FILES.get(request.path, "text/html"))

    async def _status(self, _request: web.Request) -> web.StreamResponse:
        students = [{**tile, "mark": mark_shown(self._plan, tile["name"])}
                    for tile in self._control.tiles()]
        return web.json_response({"class": self._plan.name, "students": students})

    async def _picture(self, request: web.Request) -> web.StreamResponse:
        try:
            return web.Response(text=self._control.picture(request.match_info["name"]),
                                content_type="image/svg+xml")
        except CommandError as fault:
            return web.Response(status=404, text=f"{fault}\n")

    async def _marks(self, request: web.Request) -> web.StreamResponse:
        found = marks_file(self._plan, request.match_info["inside"] or "index.html")
        if found is None:
            return web.Response(status=404, text="there is no such file\n")
        path, kind, policy = found
        return web.FileResponse(path, headers={
            "Content-Type": kind, "Content-Security-Policy": policy,
            "X-Frame-Options": "SAMEORIGIN"})

    async def _act(self, request: web.Request) -> web.StreamResponse:
        actions = {"start": self._control.start_world, "stop": self._control.stop_world}
        action = actions.get(request.match_info["action"])
        if action is None:
            return web.Response(status=404, text="unknown action\n")
        try:
            await action(request.match_info["name"])
        except CommandError as fault:
            return web.Response(status=404, text=f"{fault}\n")
        return web.json_response({})
