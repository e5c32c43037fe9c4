"""Warns about meshes whose numbers are probably inches or millimetres, read as metres.

The mesh is not changed, because the size may be intended. Public models of that size are either
buildings, which are static, or files with a wrong unit, which their models correct by `<scale>`.
"""
from __future__ import annotations

import os
import re
from typing import List

from ...description.shapes import Mesh, MeshData
from ...errors import Issue, warning

_LARGEST_M = 25.0
_SMALLEST_M = 3.0
_STATIC_M = 10.0
_INCH_M = 0.0254
_HEAD_BYTES = 8192  # the <asset> of a .dae is at its beginning
_TOOL = re.compile(rb"<authoring_tool>[^<]*SketchUp", re.IGNORECASE)
_UNIT = re.compile(rb"<unit\b[^>]*\bmeter\s*=\s*[\"']([^\"']*)[\"']")


def odd_size(mesh: Mesh, data: MeshData, moves: bool) -> List[Issue]:
    """A warning for a mesh of more than 25 m in a model that is not static.

    Also for a static model if the file claims to be written by SketchUp, which uses inches, in
    metres. For a Collada file without `<unit>`, which means metres, the limit is 3 m, or 10 m in a
    static model: half a metre written in inches is 20.

    Args:
        mesh: the mesh, with the path of its file.
        data: its triangles, scale applied.
        moves: False for a static model.
    """
    size = float((data.vertices.max(axis=0) - data.vertices.min(axis=0)).max())
    if size <= _SMALLEST_M:
        return []
    head = _collada_head(mesh.path)
    unitless = bool(head) and _UNIT.search(head) is None
    if unitless:
        odd = size > (_SMALLEST_M if moves else _STATIC_M)
    else:
        odd = size > _LARGEST_M and (moves or _lost_inches(head))
    if not odd:
        return []
    why = (": its file names no <unit>, so its numbers are metres" if unitless
           else ", which may be a lost unit")
    return [warning(
        "mesh-size-odd", f"the mesh is {size:.4g} m long{why}", file=mesh.path,
        hint=f"with a scale of {_INCH_M} it is {size * _INCH_M:.3g} m (inches), with 0.001 "
             f"{size * 0.001:.3g} m (millimetres)")]


def _collada_head(path: str) -> bytes:
    """The beginning of a Collada file with its `<asset>`; b"" for other files."""
    if os.path.splitext(path)[1].lower() != ".dae":
        return b""
    try:
        with open(path, "rb") as stream:
            return stream.read(_HEAD_BYTES)
    except OSError:  # deleted since it was loaded; the warning is optional
        return b""


def _lost_inches(head: bytes) -> bool:
    unit = _UNIT.search(head)
    return bool(_TOOL.search(head)) and (unit is None or unit.group(1).strip() in (b"1", b"1.0"))
