"""Refuses mesh files that are, or declare to be, too large, before their content is read."""
from __future__ import annotations

import os
import struct

from .gltf import check_gltf
from .part import MOST_TRIANGLES, MeshError
from .stl import HEADER, binary_stl_size

LARGEST = 600 << 20
"""Bytes of a file: more than a binary STL file of `MOST_TRIANGLES` has."""

_LARGEST_HEADER = 64 << 20
_PLY_HEADER = 64 << 10
_GLB_HEADER = 20


def check_declared_size(path: str, size: int) -> None:
    """Check the size of a file and the numbers in the header of an STL, PLY or GLB file.

    Args:
        path: the file.
        size: its size, bytes.

    Raises:
        MeshError: it has too many bytes or triangles, or fewer bytes than its header declares.
        OSError: it cannot be read.
    """
    if size > LARGEST:
        raise MeshError(f"it has {size >> 20} MB; {LARGEST >> 20} MB are possible")
    extension = os.path.splitext(path)[1].lower()
    if extension in (".stl", ".stla", ".stlb"):
        with open(path, "rb") as stream:
            head = stream.read(HEADER)
        count = int.from_bytes(head[80:], "little")
        if count > MOST_TRIANGLES and binary_stl_size(count) <= size:
            raise MeshError(f"its header declares {count} triangles; {MOST_TRIANGLES} are possible")
    elif extension == ".ply":
        with open(path, "rb") as stream:
            _check_ply(stream.read(_PLY_HEADER), size)
    elif extension == ".glb":
        _check_glb(path, size)


def _check_ply(head: bytes, size: int) -> None:
    for row in head.partition(b"end_header")[0].split(b"\n"):
        words = row.split()
        if words[:1] != [b"element"] or len(words) != 3 or not words[2].isdigit():
            continue
        name, count = words[1].decode("latin-1"), int(words[2])
        most = MOST_TRIANGLES if name == "face" else 3 * MOST_TRIANGLES
        if count > most:
            raise MeshError(f"its header declares {count} elements {name!r}; {most} are possible")
        if count > size:  # each takes a byte at least
            raise MeshError(f"its header declares {count} elements {name!r}, more than the file"
                            " has bytes; the file may be cut off")


def _check_glb(path: str, size: int) -> None:
    with open(path, "rb") as stream:
        head = stream.read(_GLB_HEADER)
        if head[:4] != b"glTF" or len(head) < _GLB_HEADER:
            return  # its reader reports it
        length = struct.unpack("<I", head[12:16])[0]
        if length > min(size, _LARGEST_HEADER):
            raise MeshError(f"its header declares a document of {length} bytes; the file may be"
                            " cut off")
        check_gltf(head + stream.read(length), path)
