"""What a material looks like: scripts found and read, Gazebo's own names known, colours on top."""
from __future__ import annotations

import os
import threading
from typing import Any, Dict, List, Optional, Tuple

from ...description.compare import BUILT_IN as BUILT_IN_SCRIPT
from ...description.shapes import Color, Material
from ...resources.resolver import Resolver, ResourceNotFoundError
from ..transport.served_files import ServedFiles
from .gazebo_materials import BUILT_IN, Paint
from .material_script import ScriptMaterial, read_materials

_COLORS = ("ambient", "diffuse", "specular", "emissive")


class Materials:
    """Resolves materials; scripts are kept by path and time. Safe from any thread."""

    def __init__(self, resolver: Resolver, served: ServedFiles) -> None:
        self._resolver = resolver
        self._served = served
        self._scripts: Dict[Tuple[str, int], Dict[str, ScriptMaterial]] = {}
        self._folders: Dict[str, List[str]] = {}
        self._seen: Dict[str, ScriptMaterial] = {}
        self._lock = threading.Lock()

    def document(self, material: Optional[Material]) -> Optional[Dict[str, Any]]:
        """A material as the protocol's `Material`; None for none.

        The script comes first, colours of the file override it (Gazebo behaviour).
        """
        if material is None:
            return None
        with self._lock:
            found = self._named(material)
        for name in _COLORS:
            color = getattr(material, name)
            if color is not None:
                found[name] = list(color)
        if material.texture:
            found["texture"] = self._texture(self._url(material.texture))
        diffuse = found["diffuse"]
        if diffuse is not None and found["transparency"] == 0.0:
            found["transparency"] = min(1.0, max(0.0, 1.0 - diffuse[3]))
        return found

    def _named(self, material: Material) -> Dict[str, Any]:
        name = material.script_name
        if not name:
            return _bare("")
        folders: List[str] = []
        for uri in material.script_uris:
            if uri != BUILT_IN_SCRIPT:
                folders += self._load(uri)
        script = self._seen.get(name)
        if name in BUILT_IN and (script is None or not folders):
            return _of_paint(name, BUILT_IN[name])
        if script is None:
            white = [1.0, 1.0, 1.0, 1.0]
            return {**_bare(name), "ambient": white, "diffuse": white}
        return self._of_script(script, folders or self._folders.get(name, []))

    def _of_script(self, script: ScriptMaterial, folders: List[str]) -> Dict[str, Any]:
        found = _bare(script.name)
        for name in _COLORS:
            color: Optional[Color] = getattr(script, name)
            found[name] = list(color) if color is not None else None
        found["lighting"] = script.lighting
        if script.blend and script.diffuse is not None:
            found["transparency"] = 1.0 - script.diffuse[3]
        elif found["diffuse"] is not None:
            found["diffuse"][3] = 1.0  # without blending Ogre does not look at it
        if script.texture:
            url = self._served.picture(os.path.basename(script.texture), folders)
            found["texture"] = self._texture(url, scale=script.scale)
            if found["diffuse"] is None:
                found["diffuse"] = [1.0, 1.0, 1.0, 1.0]
        return found

    @staticmethod
    def _texture(url: Optional[str], pattern: Optional[str] = None,
                 scale: Tuple[float, float] = (1.0, 1.0)) -> Optional[Dict[str, Any]]:
        if url is None and pattern is None:
            return None
        return {"url": url, "pattern": pattern, "scale": list(scale)}

    def _load(self, uri: str) -> List[str]:
        """Read the scripts a URI names; returns the folders where their pictures may be."""
        try:
            path = self._resolver.resolve(uri)
        except ResourceNotFoundError:
            return []
        if os.path.isdir(path):
            scripts = [os.path.join(path, name) for name in sorted(os.listdir(path))
                       if name.endswith(".material")]
            folders = [path]
        else:
            scripts = [path] if path.endswith(".material") else []
            folders = [os.path.dirname(path)]
        for script in scripts:
            for name, material in self._read(script).items():
                self._seen[name] = material
                self._folders[name] = [os.path.dirname(script)]
        return folders

    def _read(self, path: str) -> Dict[str, ScriptMaterial]:
        try:
            key = (path, os.stat(path).st_mtime_ns)
            if key not in self._scripts:
                with open(path, encoding="utf-8", errors="replace") as stream:
                    self._scripts[key] = read_materials(stream.read(1 << 20))
        except OSError:
            return {}
        return self._scripts[key]

    def _url(self, uri: str) -> Optional[str]:
        try:
            return self._served.url(self._resolver.resolve(uri))
        except ResourceNotFoundError:
            return None


def _bare(name: str) -> Dict[str, Any]:
    return {"ambient": None, "diffuse": None, "specular": None, "emissive": None, "name": name,
            "texture": None, "transparency": 0.0, "lighting": True}


def _of_paint(name: str, paint: Paint) -> Dict[str, Any]:
    found = _bare(name)
    for color in _COLORS:
        found[color] = [*getattr(paint, color), 1.0]
    found.update(transparency=1.0 - paint.alpha, lighting=paint.lit)
    if paint.pattern:
        found["texture"] = {"url": None, "pattern": paint.pattern,
                            "scale": [1.0 / paint.repeats, 1.0 / paint.repeats]}
    return found
