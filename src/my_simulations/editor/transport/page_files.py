"""HTTP: the page itself, with its modules and libraries."""
from __future__ import annotations

import asyncio
import base64
import gzip
import hashlib
import os
import re
from typing import Dict, Iterator, List, Optional, Tuple

from aiohttp import hdrs, web

from ...resources.package_files import own_directory
from ..scene.content_types import PAGE, page_type, resource_type
from .page_bundle import PageBundle
from .private_file import page_key

_SCRIPT = re.compile(r"<script\b(?![^>]*\bsrc=)[^>]*>(.*?)</script>", re.DOTALL | re.IGNORECASE)
_HOST = re.compile(r"[\w.-]+(:\d+)?\Z|\[[0-9a-fA-F:.]+\](:\d+)?\Z")
_ADDRESS = re.compile(r'"/(js|css|img|three)/')
_CHECKED = "no-cache"
_FOR_GOOD = "private, max-age=31536000, immutable"
"""RFC 8246: what has this address never changes, so a browser need not ask for it again."""

_NOT_BUILT = "the editor's page was not built from the sources that are there: run tools/run\n"


class PageFiles:
    """Routes of the page itself: its HTML, modules and libraries.

    The HTML names them by addresses that change with the files, `/v/STAMP/js/main.js`: a browser
    that has them asks for none of them when the page is opened again.

    Args:
        page: the page's folder; "" for the package's own.
        cache_dir: keeps the key that addresses are made with.
    """

    def __init__(self, page: str, cache_dir: str) -> None:
        self.web = page or self.own_folder()
        self._node_modules = node_modules(self.web)
        self._key = page_key(cache_dir)
        self._bundle = PageBundle(self.web, self._node_modules)
        self._compressed = CompressedFiles()
        self._stamp = ""
        # Stamp, HTML, and the HTML with packed modules.
        self._packed: Tuple[str, str, Optional[str]] = ("", "", "")

    @staticmethod
    def own_folder() -> str:
        return os.path.join(own_directory(), "web")

    def routes(self) -> List[web.RouteDef]:
        return [
            web.get("/", self._index), web.get("/protocol.json", self._protocol),
            web.get("/{part:js|css|img}/{inside:.+}", self._part),
            web.get("/three/{inside:.+}", self._three),
            web.get("/v/{stamp}/{part:js|css|img}/{inside:.+}", self._part),
            web.get("/v/{stamp}/three/{inside:.+}", self._three),
        ]

    async def _index(self, request: web.Request) -> web.StreamResponse:
        path = os.path.join(self.web, "index.html")
        try:
            with open(path, encoding="utf-8") as stream:
                text = stream.read()
        except OSError:
            raise web.HTTPNotFound(text="the editor's page is not installed\n") from None
        stamp = self.stamp()
        if (stamp, text) != self._packed[:2]:
            self._packed = (stamp, text, self._bundle.html(text))
        self._stamp, packed = stamp, self._packed[2]
        if packed is None:
            raise web.HTTPServiceUnavailable(text=_NOT_BUILT)
        text = _ADDRESS.sub(rf'"/v/{self._stamp}/\1/', packed)
        response = web.Response(text=text, content_type="text/html")
        response.headers["Content-Security-Policy"] = _policy(text, request.host)
        response.headers[hdrs.CACHE_CONTROL] = _CHECKED
        return response

    async def _protocol(self, request: web.Request) -> web.StreamResponse:
        return await self._page_file(request, os.path.join(self.web, "protocol.json"))

    async def _part(self, request: web.Request) -> web.StreamResponse:
        part, inside = request.match_info["part"], request.match_info["inside"]
        path = _inside(os.path.join(self.web, part), inside)
        if part == "js" and (path is None or not os.path.isfile(path)):
            folder, inside = self._bundle.module(inside)
            path = _inside(folder, inside) if folder else None
        return await self._page_file(request, path)

    async def _three(self, request: web.Request) -> web.StreamResponse:
        if not self._node_modules:
            raise web.HTTPNotFound(text="three is not installed: run tools/run, or `npm ci` in "
                                        "the folder web\n")
        folder = os.path.join(self._node_modules, "three")
        return await self._page_file(request, _inside(folder, request.match_info["inside"]))

    async def _page_file(self, request: web.Request,
                         path: Optional[str]) -> web.StreamResponse:
        kept = _CHECKED
        stamp = request.match_info.get("stamp")
        if stamp is not None:
            # A page that was opened while the world was loading was given by another server.
            self._stamp = self._stamp or self.stamp()
            if stamp == self._stamp:
                kept = _FOR_GOOD
        kind = page_type(path or "")
        response: Optional[web.StreamResponse] = None
        if path is not None:
            response = await self._compressed.response(request, path, kind, kept)
        if response is None:
            response = file_response(path, kind)
        response.headers[hdrs.CACHE_CONTROL] = kept
        return response

    def stamp(self) -> str:
        """Equal as long as no file has another name, size or time; only this user knows it."""
        state = hashlib.sha256(self._key)
        for path, found in sorted(self._files()):
            state.update(f"{path}\0{found.st_size}\0{found.st_mtime_ns}\0".encode())
        return state.hexdigest()[:16]

    def _files(self) -> Iterator[Tuple[str, os.stat_result]]:
        waiting = [os.path.join(self.web, part) for part in ("js", "css", "img")]
        if self._node_modules:
            three = os.path.join(self._node_modules, "three")
            waiting += [os.path.join(three, "build"), os.path.join(three, "package.json"),
                        self._bundle.folder]
        while waiting:
            path = waiting.pop()
            try:
                if os.path.isdir(path):
                    waiting += [os.path.join(path, name) for name in os.listdir(path)]
                else:
                    yield path, os.stat(path)
            except OSError:     # gone since it was listed, or there is no such folder
                continue


def node_modules(page: str) -> str:
    """The folder that holds `three`; "" where it is not installed.

    An installation has it beside the page, a workspace in its folder `.my_simulations`.
    """
    places = [os.environ.get("MY_SIMULATIONS_NODE_MODULES", ""),
              os.path.join(page, "node_modules"),
              os.path.join(os.path.dirname(page), "node_modules")]
    for prefix in os.environ.get("CMAKE_PREFIX_PATH", "").split(os.pathsep):
        places.append(os.path.join(prefix, "share", "my_simulations", "node_modules"))
        above = os.path.dirname(prefix)
        # catkin_make_isolated has its prefixes in devel_isolated/NAME.
        for workspace in (above, os.path.dirname(above)):
            places.append(os.path.join(workspace, ".my_simulations", "node_modules"))
    return next((place for place in places
                 if place and os.path.isdir(os.path.join(place, "three"))), "")


def _policy(html: str, host: str) -> str:
    """What the page may load: our own files, the scripts that stand in it, and our own socket."""
    hashes = "".join(
        " 'sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() + "'"
        for text in _SCRIPT.findall(html))
    # 'self' means no web socket in older browsers. A host that is no plain name is not passed on.
    own = f" ws://{host} wss://{host}" if _HOST.match(host) else ""
    return (f"default-src 'self'; script-src 'self'{hashes}; style-src 'self' 'unsafe-inline'; "
            f"img-src 'self' data: blob:; connect-src 'self' data: blob:{own}; "
            "worker-src 'self' blob:; object-src 'none'; base-uri 'none'; "
            "frame-ancestors 'none'; form-action 'none'")


def _inside(folder: str, inside: str) -> Optional[str]:
    """A file of the page below a folder; None else."""
    if "\0" in inside:
        return None
    real = os.path.realpath(folder)
    path = os.path.realpath(os.path.join(real, inside))
    if not path.startswith(real + os.sep) or os.path.splitext(path)[1].lower() not in PAGE:
        return None
    return path


def file_response(path: Optional[str], kind: str = "") -> web.StreamResponse:
    """A file, to be asked for each time whether it has changed.

    Raises web.HTTPNotFound: `path` is None or no file.
    """
    if path is None or not os.path.isfile(path):
        raise web.HTTPNotFound
    return web.FileResponse(path, headers={hdrs.CACHE_CONTROL: _CHECKED,
                                           hdrs.CONTENT_TYPE: kind or resource_type(path)})


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
