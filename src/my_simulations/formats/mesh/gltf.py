"""Checks sizes and references of a glTF file before memory is allocated for it."""
from __future__ import annotations

import json
import os
import stat
import struct
from typing import Any, List, Tuple
from urllib.parse import unquote

from .part import MOST_TRIANGLES, MeshError

_LARGEST_BUFFER = 1 << 30
_MOST_NODES = 100_000


def check_gltf(data: bytes, path: str) -> None:
    """Reject a file that expands to a large size or refers to anything but regular files.

    Args:
        data: content of a .gltf or .glb file.
        path: path of the file.

    Raises:
        MeshError: the file is rejected.
    """
    tree = gltf_tree(data)
    if sum(_counts(tree)) > 3 * MOST_TRIANGLES:
        raise MeshError(f"it has more than {MOST_TRIANGLES} triangles")
    nodes = _dicts(tree, "nodes")
    children = [child for node in nodes for child in node.get("children") or ()]
    if len(nodes) > _MOST_NODES or len(children) != len({str(child) for child in children}):
        raise MeshError(f"it has more than {_MOST_NODES} nodes, or one with two parents")
    for _, uri in gltf_file_uris(tree):
        _check_file(os.path.join(os.path.dirname(path), unquote(uri)), uri)


def gltf_file_uris(tree: Any) -> List[Tuple[str, str]]:
    """Return the file URIs of a glTF document as pairs (`buffers` or `images`, URI).

    Raises MeshError: the document is damaged.
    """
    uris = [(kind, item.get("uri")) for kind in ("buffers", "images")
            for item in _dicts(tree, kind)]
    return [(kind, uri) for kind, uri in uris
            if isinstance(uri, str) and not uri.startswith("data:")]


def _counts(tree: Any) -> List[int]:
    """Numbers of vertices and indices; accessors without data stand for zeros."""
    found = []
    for accessor in _dicts(tree, "accessors"):
        count = accessor.get("count")
        if not isinstance(count, int) or count < 0:
            raise MeshError("an accessor has no count")
        found.append(count)
    return found


def _check_file(file: str, uri: str) -> None:
    try:
        status = os.stat(file)
    except (OSError, ValueError):
        return  # the reader reports missing elements
    if not stat.S_ISREG(status.st_mode) or status.st_size > _LARGEST_BUFFER:
        raise MeshError(f"{uri!r} is no plain file of at most {_LARGEST_BUFFER >> 20} MB")


def gltf_tree(data: bytes) -> Any:
    """The JSON document of a .gltf or .glb file. Raises MeshError: it has none."""
    text = data
    if data[:4] == b"glTF":
        if len(data) < 20:
            raise MeshError("the file is cut off")
        text = data[20:20 + struct.unpack("<I", data[12:16])[0]]
    try:
        tree = json.loads(text.decode("utf-8"))
    except (ValueError, RecursionError) as fault:
        raise MeshError(f"it is not glTF: {fault}") from None
    if not isinstance(tree, dict):
        raise MeshError("it is not glTF")
    return tree


def _dicts(tree: Any, name: str) -> List[Any]:
    items = tree.get(name) or []
    if not isinstance(items, list) or not all(isinstance(item, dict) for item in items):
        raise MeshError(f"its {name} are no list of objects")
    return items
