"""HTTP: the page with meshes and textures, thumbnails, uploads and downloads."""
from __future__ import annotations

import os
import re
from typing import Callable, List

from aiohttp import hdrs, web

from ...errors import CommandError, InputError
from ...simulator.safe_file import write_atomically
from ..editor_options import EditorOptions
from ..scene.content_types import BYTES
from ..scene.scene_json import Documents
from ..scene.served_files import SERVED
from .page_files import PageFiles, file_response

_THUMB = re.compile(r"[0-9a-f]{16,64}\Z")
_THUMB_BYTES = 2 << 20
_PNG = b"\x89PNG\r\n\x1a\n"
_NAME = re.compile(r"[\w][\w .()+-]{0,120}\Z")
_UPLOADED = SERVED | {".sdf", ".urdf", ".world", ".xml"}

Export = Callable[[str], "tuple[bytes, str]"]


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
        super().__init__(page, options.cache_dir)
        self._documents = documents
        self._upload_bytes = upload_bytes
        self._export = export
        self._thumbs = os.path.join(options.cache_dir, "thumbnails")
        self._uploads = os.path.join(os.path.dirname(options.data_dir), "uploads")

    def routes(self) -> List[web.RouteDef]:
        return [
            *super().routes(),
            web.get("/resource/{root}/{inside:.+}", self._resource),
            web.get("/solid/{id}.stl", self._solid), web.get("/solid/{id}.ply", self._solid),
            web.get("/thumb/{id}.png", self._thumb), web.put("/thumb/{id}.png", self._put_thumb),
            web.put("/upload/{name}", self._put_upload), web.get("/export/{name}", self._download),
        ]

    async def _resource(self, request: web.Request) -> web.StreamResponse:
        path = self._documents.served.path(request.match_info["root"], request.match_info["inside"])
        return file_response(path)

    async def _solid(self, request: web.Request) -> web.StreamResponse:
        import asyncio

        loop = asyncio.get_running_loop()
        try:
            data = await loop.run_in_executor(None, self._documents.solids.file,
                                              request.match_info["id"])
        except InputError as fault:
            raise web.HTTPNotFound(text=f"{fault}\n") from None
        if not data:
            raise web.HTTPNotFound
        form = request.path.rsplit(".", 1)[-1]
        return web.Response(body=data, content_type=f"model/{form}")

    async def _thumb(self, request: web.Request) -> web.StreamResponse:
        known = request.match_info["id"]
        if not _THUMB.match(known):
            raise web.HTTPNotFound
        path = os.path.join(self._thumbs, known + ".png")
        # A picture that was not drawn yet is no fault: the page draws it then.
        return file_response(path) if os.path.isfile(path) else web.Response(
            status=204, headers={hdrs.CACHE_CONTROL: "no-store"})

    async def _put_thumb(self, request: web.Request) -> web.StreamResponse:
        known = request.match_info["id"]
        data = await _body(request, _THUMB_BYTES)
        if not _THUMB.match(known) or not data.startswith(_PNG):
            raise web.HTTPBadRequest(text="a thumbnail is a PNG\n")
        return _write_file(os.path.join(self._thumbs, known + ".png"), data, overwrite=True)

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
        _write_file(path, data, overwrite=False)
        return web.json_response({"path": path, "uri": "file://" + path})

    async def _download(self, request: web.Request) -> web.StreamResponse:
        import asyncio

        if not _NAME.match(request.match_info["name"]):
            raise web.HTTPNotFound
        loop = asyncio.get_running_loop()
        try:
            data, name = await loop.run_in_executor(None, self._export, request.match_info["name"])
        except CommandError as fault:
            raise web.HTTPNotFound(text=f"{fault}\n") from None
        return web.Response(body=data, content_type=BYTES, headers={
            hdrs.CONTENT_DISPOSITION: f'attachment; filename="{name}"'})


async def _body(request: web.Request, largest: int) -> bytes:
    """The whole body, refused as soon as it is too large, and if it is compressed."""
    if hdrs.CONTENT_ENCODING in request.headers:
        raise web.HTTPUnsupportedMediaType(text="a compressed body is not accepted\n")
    if (request.content_length or 0) > largest:
        raise web.HTTPRequestEntityTooLarge(largest, request.content_length or 0)
    data = bytearray()
    async for chunk in request.content.iter_chunked(1 << 16):
        data += chunk
        if len(data) > largest:
            raise web.HTTPRequestEntityTooLarge(largest, len(data))
    return bytes(data)


def _write_file(path: str, data: bytes, overwrite: bool) -> web.StreamResponse:
    try:
        write_atomically(path, data, overwrite, private=True)
    except CommandError as fault:
        raise web.HTTPInsufficientStorage(text=f"{fault}\n") from None
    return web.Response(status=204)
