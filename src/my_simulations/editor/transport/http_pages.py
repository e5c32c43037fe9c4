"""HTTP: the page, its modules, meshes and textures, thumbnails, uploads and downloads."""
from __future__ import annotations

import base64
import hashlib
import os
import re
from typing import Callable, List, Optional

from aiohttp import hdrs, web

from ...errors import CommandError, InputError
from ...resources.package_files import own_directory
from ...simulator.safe_file import write_whole
from ..editor_options import EditorOptions
from ..scene.content_types import BYTES, PAGE, page_type, resource_type
from ..scene.scene_json import Documents
from ..scene.served_files import SERVED

_SCRIPT = re.compile(r"<script\b(?![^>]*\bsrc=)[^>]*>(.*?)</script>", re.DOTALL | re.IGNORECASE)
_HOST = re.compile(r"[\w.-]+(:\d+)?\Z|\[[0-9a-fA-F:.]+\](:\d+)?\Z")
_THUMB = re.compile(r"[0-9a-f]{16,64}\Z")
_THUMB_BYTES = 2 << 20
_PNG = b"\x89PNG\r\n\x1a\n"
_NAME = re.compile(r"[\w][\w .()+-]{0,120}\Z")
_UPLOADED = SERVED | {".sdf", ".urdf", ".world", ".xml"}

Export = Callable[[str], "tuple[bytes, str]"]


class PageFiles:
    """Routes of the page itself: its HTML, modules and libraries.

    Args:
        page: the page's folder; "" for the package's own.
    """

    def __init__(self, page: str) -> None:
        self.web = page or Pages.own_folder()
        self._modules = node_modules(self.web)

    def routes(self) -> List[web.RouteDef]:
        """For the application."""
        return [
            web.get("/", self._index), web.get("/protocol.json", self._protocol),
            web.get("/{part:js|css|img}/{inside:.+}", self._part),
            web.get("/three/{inside:.+}", self._three),
        ]

    async def _index(self, request: web.Request) -> web.StreamResponse:
        path = os.path.join(self.web, "index.html")
        try:
            with open(path, encoding="utf-8") as stream:
                text = stream.read()
        except OSError:
            raise web.HTTPNotFound(text="the editor's page is not installed\n") from None
        response = web.Response(text=text, content_type="text/html")
        response.headers["Content-Security-Policy"] = _policy(text, request.host)
        response.headers[hdrs.CACHE_CONTROL] = "no-cache"
        return response

    async def _protocol(self, _request: web.Request) -> web.StreamResponse:
        return _page_file(os.path.join(self.web, "protocol.json"))

    async def _part(self, request: web.Request) -> web.StreamResponse:
        folder = os.path.join(self.web, request.match_info["part"])
        return _page_file(_inside(folder, request.match_info["inside"]))

    async def _three(self, request: web.Request) -> web.StreamResponse:
        if not self._modules:
            raise web.HTTPNotFound(text="three is not installed: run tools/run, or `npm ci` in "
                                        "the folder web\n")
        folder = os.path.join(self._modules, "three")
        return _page_file(_inside(folder, request.match_info["inside"]))


class Pages(PageFiles):
    """Routes of everything but the web socket.

    Args:
        options: where things lie.
        page: the page's folder.
        documents: knows what may be served.
        upload_bytes: the largest upload.
        export: the bytes and the file name of a download; raises CommandError for none.
    """

    def __init__(self, options: EditorOptions, page: str, documents: Documents,
                 upload_bytes: int, export: Export) -> None:
        super().__init__(page)
        self._documents = documents
        self._upload_bytes = upload_bytes
        self._export = export
        self._thumbs = os.path.join(options.cache_dir, "thumbnails")
        self._uploads = os.path.join(os.path.dirname(options.data_dir), "uploads")

    @staticmethod
    def own_folder() -> str:
        """The page of this package."""
        return os.path.join(own_directory(), "web")

    def routes(self) -> List[web.RouteDef]:
        """For the application."""
        return [
            *super().routes(),
            web.get("/resource/{root}/{inside:.+}", self._resource),
            web.get("/solid/{id}.stl", self._solid),
            web.get("/thumb/{id}.png", self._thumb), web.put("/thumb/{id}.png", self._put_thumb),
            web.put("/upload/{name}", self._put_upload), web.get("/export/{name}", self._download),
        ]

    async def _resource(self, request: web.Request) -> web.StreamResponse:
        path = self._documents.served.path(request.match_info["root"],
                                           request.match_info["inside"])
        return _file(path)

    async def _solid(self, request: web.Request) -> web.StreamResponse:
        import asyncio

        loop = asyncio.get_running_loop()
        try:
            data = await loop.run_in_executor(None, self._documents.solids.stl,
                                              request.match_info["id"])
        except InputError as fault:
            raise web.HTTPNotFound(text=f"{fault}\n") from None
        if not data:
            raise web.HTTPNotFound
        return web.Response(body=data, content_type="model/stl")

    async def _thumb(self, request: web.Request) -> web.StreamResponse:
        known = request.match_info["id"]
        if not _THUMB.match(known):
            raise web.HTTPNotFound
        path = os.path.join(self._thumbs, known + ".png")
        # A picture that was not drawn yet is no fault: the page draws it then.
        return _file(path) if os.path.isfile(path) else web.Response(
            status=204, headers={hdrs.CACHE_CONTROL: "no-store"})

    async def _put_thumb(self, request: web.Request) -> web.StreamResponse:
        known = request.match_info["id"]
        data = await _body(request, _THUMB_BYTES)
        if not _THUMB.match(known) or not data.startswith(_PNG):
            raise web.HTTPBadRequest(text="a thumbnail is a PNG\n")
        return _written(os.path.join(self._thumbs, known + ".png"), data, overwrite=True)

    async def _put_upload(self, request: web.Request) -> web.StreamResponse:
        name = request.match_info["name"]
        stem, extension = os.path.splitext(name)
        if not _NAME.match(name) or extension.lower() not in _UPLOADED:
            raise web.HTTPBadRequest(text=f"{name!r} is not a file that models use\n")
        data = await _body(request, self._upload_bytes)
        number, path = 0, os.path.join(self._uploads, name)
        while os.path.lexists(path):
            number += 1
            path = os.path.join(self._uploads, f"{stem}_{number}{extension}")
        self._documents.served.add_root(self._uploads)
        _written(path, data, overwrite=False)
        return web.json_response({"path": path, "uri": "file://" + path})

    async def _download(self, request: web.Request) -> web.StreamResponse:
        import asyncio

        if not _NAME.match(request.match_info["name"]):
            raise web.HTTPNotFound
        loop = asyncio.get_running_loop()
        try:
            data, name = await loop.run_in_executor(None, self._export,
                                                    request.match_info["name"])
        except CommandError as fault:
            raise web.HTTPNotFound(text=f"{fault}\n") from None
        return web.Response(body=data, content_type=BYTES, headers={
            hdrs.CONTENT_DISPOSITION: f'attachment; filename="{name}"'})


def node_modules(page: str) -> str:
    """The folder that holds `three`; "" where it is not installed."""
    places = [os.environ.get("MY_SIMULATIONS_NODE_MODULES", ""),
              os.path.join(page, "node_modules")]
    for prefix in os.environ.get("CMAKE_PREFIX_PATH", "").split(os.pathsep):
        places.append(os.path.join(prefix, "share", "my_simulations", "node_modules"))
        places.append(os.path.join(os.path.dirname(prefix), ".my_simulations", "node_modules"))
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


def _page_file(path: Optional[str]) -> web.StreamResponse:
    return _file(path, page_type(path or ""))


def _file(path: Optional[str], kind: str = "") -> web.StreamResponse:
    if path is None or not os.path.isfile(path):
        raise web.HTTPNotFound
    return web.FileResponse(path, headers={hdrs.CACHE_CONTROL: "no-cache",
                                           hdrs.CONTENT_TYPE: kind or resource_type(path)})


async def _body(request: web.Request, largest: int) -> bytes:
    """The whole body, refused as soon as it is too large."""
    if (request.content_length or 0) > largest:
        raise web.HTTPRequestEntityTooLarge(largest, request.content_length or 0)
    data = bytearray()
    async for chunk in request.content.iter_chunked(1 << 16):
        data += chunk
        if len(data) > largest:
            raise web.HTTPRequestEntityTooLarge(largest, len(data))
    return bytes(data)


def _written(path: str, data: bytes, overwrite: bool) -> web.StreamResponse:
    try:
        write_whole(path, data, overwrite)
    except CommandError as fault:
        raise web.HTTPInsufficientStorage(text=f"{fault}\n") from None
    return web.Response(status=204)
