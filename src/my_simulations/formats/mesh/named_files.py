"""Lists the files that a mesh file refers to, and checks its outer form, without its triangles.

This takes milliseconds, so each visual can be checked when it is read. `loading` decodes meshes.
"""
from __future__ import annotations

import functools
import os
import re
from dataclasses import dataclass
from typing import Any, Callable, Dict, List, Optional, Tuple, Union
from urllib.parse import unquote

from ...resources.lfs_pointer import LFS_POINTER, is_lfs_pointer
from ...resources.limited_file import at_most
from .gltf import gltf_file_uris, gltf_tree
from .part import MeshError
from .stl import binary_stl_end

LARGEST = 64 << 20
"""Bytes; larger files are not checked."""

_HEAD_BYTES = 1024
_LAST_LINE = 65535
"""Largest line number of libxml2; elements further down have this line number, too."""

_OBJ_FACE = re.compile(rb"^[ \t]*f[ \t]", re.MULTILINE)
_OBJ_LIBRARY = re.compile(rb"^[ \t]*mtllib[ \t]+([^\r\n]+)", re.MULTILINE)
_MTL_PICTURE = re.compile(rb"^[ \t]*map_Kd[ \t]+([^\r\n]+)", re.MULTILINE | re.IGNORECASE)
_MTL_OPTION = re.compile(r"-[a-zA-Z]+(?:\s+(?:on|off|[-+.\d]+(?:e[-+]?\d+)?|[rgbmlz](?=\s)))*\s+")

IMAGE, MATERIALS, BUFFER = "image", "material library", "buffer"


@dataclass(frozen=True)
class NamedFile:
    """A file that another one refers to.

    Attributes:
        kind: IMAGE, MATERIALS or BUFFER.
        name: path as written, without percent encoding; relative to the folder of the mesh.
        line: line of the reference, from 1; 0 if unknown.
    """

    kind: str
    name: str
    line: int = 0


Names = Tuple[NamedFile, ...]


def named_files(path: str) -> Names:
    """The files that a mesh or .mtl file refers to, in the order of the file.

    Of a COLLADA effect, only the image that Gazebo shows. Formats other than COLLADA, OBJ, MTL and
    glTF refer to no files. The result is cached by time and size of the file.

    Raises:
        MeshError: the file is not of its format, is cut off, or is a Git LFS pointer.
        OSError: it cannot be read.
    """
    status = os.stat(path)
    if status.st_size > LARGEST:
        return ()
    found = _read(path, status.st_mtime_ns, status.st_size)
    if isinstance(found, MeshError):
        raise found
    return found


@functools.lru_cache(maxsize=1024)
def _read(path: str, _changed: int, size: int) -> Union[Names, MeshError]:
    reader = _READERS.get(os.path.splitext(path)[1].lower())
    with open(path, "rb") as stream:
        data = at_most(stream, LARGEST if reader else _HEAD_BYTES)
    try:
        if not data.strip():
            raise MeshError("the file is empty", code="mesh-empty")
        if is_lfs_pointer(data):
            raise MeshError(LFS_POINTER)
        if path.lower().endswith((".stl", ".stla", ".stlb")):
            binary_stl_end(data, size)
        return tuple(reader(data)) if reader else ()
    except MeshError as fault:
        return fault


def _of_obj(data: bytes) -> List[NamedFile]:
    if not _OBJ_FACE.search(data):
        raise MeshError("it has no faces", code="mesh-empty")
    if b"mtllib" not in data:
        return []
    return [NamedFile(MATERIALS, _text(found.group(1)), _line(data, found.start(1)))
            for found in _OBJ_LIBRARY.finditer(data)]


def _of_mtl(data: bytes) -> List[NamedFile]:
    named = []
    for found in _MTL_PICTURE.finditer(data):
        name = _text(found.group(1))
        option = _MTL_OPTION.match(name)
        while option is not None:
            name = name[option.end():]
            option = _MTL_OPTION.match(name)
        named.append(NamedFile(IMAGE, name, _line(data, found.start(1))))
    return named


def _text(value: bytes) -> str:
    return value.decode("utf-8", "replace").partition("#")[0].strip().strip('"')


def _line(data: bytes, at: int) -> int:
    return data.count(b"\n", 0, at) + 1


def _of_gltf(data: bytes) -> List[NamedFile]:
    named = []
    for kind, uri in gltf_file_uris(gltf_tree(data)):
        at = data.find(b'"' + uri.encode() + b'"')
        named.append(NamedFile(IMAGE if kind == "images" else BUFFER, unquote(uri),
                               _line(data, at) if at >= 0 and data[:4] != b"glTF" else 0))
    return named


def _of_collada(data: bytes) -> List[NamedFile]:
    """The images of all materials that a geometry uses, each once."""
    from .collada import parse_collada
    from .collada_materials import ColladaMaterials

    root = parse_collada(data)
    materials = ColladaMaterials(root)
    urls = dict.fromkeys(one.get("target", "") for one in root.iter("{*}instance_material"))
    pictures = (materials.picture_of(url) for url in urls)
    found = (_file_of_image(picture) for picture in pictures if picture is not None)
    return list(dict.fromkeys(file for file in found if file is not None))


def _file_of_image(element: Any) -> Optional[NamedFile]:
    name = unquote((element.text or "").strip())
    line: int = element.sourceline or 0
    return NamedFile(IMAGE, name, line if line < _LAST_LINE else 0) if name else None


_READERS: Dict[str, Callable[[bytes], List[NamedFile]]] = {
    ".dae": _of_collada, ".obj": _of_obj, ".mtl": _of_mtl, ".gltf": _of_gltf, ".glb": _of_gltf,
}
