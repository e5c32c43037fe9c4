"""COLLADA files with bytes that are not UTF-8, which are usually in comments or names.

TinyXML, Gazebo's XML parser, passes over such bytes; libxml2 rejects the file.
"""
from __future__ import annotations

import functools
import os
import re
from typing import List

from ...description.shapes import Mesh
from ...errors import Issue, warning

_OTHER_ENCODING = re.compile(
    rb"\xff\xfe|\xfe\xff|\s*<\?xml[^>]*\bencoding\s*=\s*[\"'](?![uU][tT][fF]-8[\"'])")


def without_stray_bytes(data: bytes) -> bytes:
    """The content of a file without bytes that are not UTF-8, unless it names another encoding."""
    return data if _first_stray_byte(data) < 0 else data.decode("utf-8", "ignore").encode()


def encoding_issues(mesh: Mesh) -> List[Issue]:
    """A warning for a COLLADA file from which `without_stray_bytes` removes something."""
    if not mesh.path.lower().endswith(".dae"):
        return []
    line = _line_of_stray_byte(mesh.path, os.stat(mesh.path).st_mtime_ns)
    return [warning("xml-encoding", "the mesh file is not UTF-8; the bytes that are not are left"
                    " out", file=mesh.path, line=line)] if line else []


@functools.lru_cache(maxsize=256)
def _line_of_stray_byte(path: str, changed: int) -> int:
    """The line of the first stray byte of a file, from 1; 0 if there is none."""
    with open(path, "rb") as stream:
        data = stream.read()
    at = _first_stray_byte(data)
    return data.count(b"\n", 0, at) + 1 if at >= 0 else 0


def _first_stray_byte(data: bytes) -> int:
    """Return the index of the first byte that is not UTF-8; -1 for none, or another encoding."""
    try:
        data.decode("utf-8")
    except UnicodeDecodeError as fault:
        return -1 if _OTHER_ENCODING.match(data) else fault.start
    return -1
