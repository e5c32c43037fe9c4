"""The content type of every kind of file the server gives away; none of them runs in a browser
but the page's own scripts.

The kind is that of the file's own name, which a link to it need not have. SVG is not among them: it
may hold scripts, and Gazebo does not read it.
"""
from __future__ import annotations

import os

MESHES = {".dae", ".stl", ".obj", ".glb", ".gltf", ".ply", ".off", ".stla", ".stlb", ".mtl",
          ".bin", ".3ds", ".fbx", ".bvh"}

_PICTURES = {".png": "image/png", ".jpg": "image/jpeg", ".jpeg": "image/jpeg",
             ".gif": "image/gif", ".bmp": "image/bmp", ".webp": "image/webp",
             ".tif": "image/tiff", ".tiff": "image/tiff"}
PICTURES = {*_PICTURES, ".tga", ".dds", ".hdr"}

_PAGE = {".css": "text/css", ".js": "text/javascript", ".mjs": "text/javascript",
         ".json": "application/json", ".wasm": "application/wasm", ".woff2": "font/woff2"}
PAGE = {*_PAGE, ".png"}

BYTES = "application/octet-stream"


def resource_type(path: str) -> str:
    """The content type of a mesh or picture that is not ours."""
    return _PICTURES.get(extension(path), BYTES)


def page_type(path: str) -> str:
    """The content type of a file that belongs to the page."""
    kind = _PAGE.get(extension(path))
    return f"{kind}; charset=utf-8" if kind and kind.startswith("text/") else (
        kind or resource_type(path))


def extension(path: str) -> str:
    """In small letters, with the dot; "" for none."""
    return os.path.splitext(path)[1].lower()
