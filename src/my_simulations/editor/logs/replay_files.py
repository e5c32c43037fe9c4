"""Collects the meshes and pictures that the world documents of a log refer to."""
from __future__ import annotations

import json
import os
from dataclasses import fields
from typing import Any, Dict, Iterator, List, Optional, Type
from urllib.parse import unquote

from ...description.shapes import Heightmap, ImageMap, Mesh, Polyline, Solid
from ...errors import InputError
from ...formats.mesh.named_files import named_files
from ...formats.mesh.part import MeshError
from ...resources.resolver import Resolver, ResourceNotFoundError
from ..scene.generated_meshes import Solids
from ..scene.served_files import ServedFiles

_SOLIDS: Dict[str, Type[Any]] = {"mesh": Mesh, "heightmap": Heightmap, "polyline": Polyline,
                                 "image": ImageMap}
_RESOURCE, _SOLID = "/resource/", "/solid/"


class ReplayFiles:
    """The files of worlds, by the address under which the page asks for them.

    Attributes:
        found: contents by address, percent encoding removed.
        missing: addresses of files that do not exist or may not be served.
    """

    def __init__(self, resolver: Resolver) -> None:
        self.found: Dict[str, bytes] = {}
        self.missing: List[str] = []
        self._resolver = resolver
        self._served = ServedFiles(resolver)
        self._solids = Solids()

    def add_world(self, document: Dict[str, Any]) -> None:
        """Add the files of one world document, with the files that those refer to."""
        text = json.dumps(document).encode()
        folder = os.path.dirname(document.get("file") or "")
        self._served.add_root(folder)
        self._served.serve_again(text, folder)
        for geometry in _geometries(document):
            url = geometry.get("url") or ""
            if url.startswith(_SOLID) and url not in self.found:
                self._add_solid(url, geometry, folder)
        for url in _strings(document):
            if url.startswith(_RESOURCE):
                self._add(unquote(url))

    def _add(self, address: str) -> None:
        """Add a file, and those that it names."""
        address = _without_dots(address)
        if address in self.found or address in self.missing:
            return
        root, _, inside = address[len(_RESOURCE):].partition("/")
        path = self._served.path(root, inside)
        try:
            if path is None:
                raise FileNotFoundError(address)
            with open(path, "rb") as stream:
                self.found[address] = stream.read()
        except OSError:
            self.missing.append(address)
            return
        for name in _named_in(path):
            self._add(f"{address.rpartition('/')[0]}/{name}")

    def _add_solid(self, url: str, geometry: Dict[str, Any], folder: str) -> None:
        """Make the triangles of a shape that no page can read or make itself."""
        try:
            solid = self._solid(geometry, folder)
            own = self._solids.url(solid) if solid is not None else ""
            data = self._solids.file(own.rpartition("/")[2].partition(".")[0])
        except (InputError, ResourceNotFoundError):
            data = b""
        if data:
            self.found[url] = data
        else:
            self.missing.append(url)

    def _solid(self, geometry: Dict[str, Any], folder: str) -> Optional[Solid]:
        kind = _SOLIDS.get(geometry["type"])
        if kind is None:
            return None
        given = {field.name: _tuples(geometry[field.name]) for field in fields(kind)
                 if field.name in geometry and field.name not in ("textures", "blends")}
        if geometry.get("uri"):
            given["path"] = self._resolver.resolve(geometry["uri"], folder)
        solid: Solid = kind(**given)
        return solid


def _named_in(path: str) -> Iterator[str]:
    """The files that a mesh or material file names; none for one that is damaged."""
    try:
        named = named_files(path)
    except (MeshError, OSError):
        return
    for file in named:
        yield file.name


def _geometries(value: Any) -> Iterator[Dict[str, Any]]:
    """All geometries below a JSON value, fallbacks removed: the page reads the file itself."""
    if isinstance(value, dict):
        if isinstance(value.get("type"), str) and value.get("url"):
            value["fallback"] = None
            yield value
        for inner in value.values():
            yield from _geometries(inner)
    elif isinstance(value, list):
        for inner in value:
            yield from _geometries(inner)


def _strings(value: Any) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, (dict, list)):
        for inner in value.values() if isinstance(value, dict) else value:
            yield from _strings(inner)


def _tuples(value: Any) -> Any:
    """Lists of JSON as the description's tuples."""
    return tuple(_tuples(item) for item in value) if isinstance(value, list) else value


def _without_dots(address: str) -> str:
    """An address without `.` and `..`, as a browser asks for it."""
    found: List[str] = []
    for part in address.split("/"):
        if part == "..":
            del found[-1:]
        elif part != ".":
            found.append(part)
    return "/".join(found)
