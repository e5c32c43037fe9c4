"""Resolves materials: scripts, Gazebo's built-in materials, and colours of the file."""
from __future__ import annotations

import os
import threading
from dataclasses import replace
from typing import Dict, List, Optional, Protocol

from ..description.compare import BUILT_IN as BUILT_IN_SCRIPT
from ..description.shapes import Color, Material, Visual
from ..resources.resolver import Resolver, ResourceNotFoundError
from .gazebo_materials import BUILT_IN, Paint, Rgb
from .looks import Look
from .material_script import ScriptMaterial, materials_of, scripts_of, shared_material
from .terrain_layers import terrain_layers

_COLORS = ("ambient", "diffuse", "specular", "emissive")
_WHITE: Color = (1.0, 1.0, 1.0, 1.0)


class Textures(Protocol):
    """Finds texture images of scripts: `textures.TextureFiles`, or the editor's served files."""

    def texture(self, name: str, folders: List[str]) -> Optional[str]:
        """The path of an image by file name, searched in these folders first."""


class Materials:
    """Resolves materials; scripts are cached by path and time. Safe from any thread."""

    def __init__(self, resolver: Resolver, textures: Textures) -> None:
        self._resolver = resolver
        self._textures = textures
        self._scripts: Dict[str, Dict[str, ScriptMaterial]] = {}
        self._folders: Dict[str, List[str]] = {}
        self._seen: Dict[str, ScriptMaterial] = {}
        self._lock = threading.Lock()

    def resolve(self, material: Optional[Material]) -> Optional[Look]:
        """The resolved material; None for none.

        Colours of the file override those of the script (Gazebo behaviour).
        """
        if material is None:
            return None
        with self._lock:
            found = self._find_named_look(material)
        said = {name: getattr(material, name) for name in _COLORS}
        found = replace(found, **{name: color for name, color in said.items() if color is not None})
        if material.texture:
            found = replace(found, texture=self._path(material.texture), pattern="",
                            scale=(1.0, 1.0))
        if material.double_sided:
            found = replace(found, double_sided=True)
        if found.diffuse is not None and found.transparency == 0.0:
            found = replace(found, transparency=min(1.0, max(0.0, 1.0 - found.diffuse[3])))
        return found

    def of_visual(self, visual: Visual) -> Optional[Look]:
        """The resolved material of a visual, with the layers of a terrain; None for none."""
        found = self.resolve(visual.material)
        layers = terrain_layers(visual, self._resolver)
        return replace(found or Look(), layers=layers) if layers else found

    def _find_named_look(self, material: Material) -> Look:
        name = material.script_name
        if not name:
            return Look()
        folders: List[str] = []
        for uri in material.script_uris:
            if uri != BUILT_IN_SCRIPT:
                folders += self._load(uri, name)
        if name not in self._seen and name not in BUILT_IN:
            shared = shared_material(name, self._resolver)
            if shared is not None:
                self._seen[name], path = shared
                self._folders[name] = folders = [os.path.dirname(path)]
        script = self._seen.get(name)
        if name in BUILT_IN and (script is None or not folders):
            return _of_paint(name, BUILT_IN[name])
        if script is None:
            return Look(name, ambient=_WHITE, diffuse=_WHITE)
        return self._of_script(script, folders or self._folders.get(name, []))

    def _of_script(self, script: ScriptMaterial, folders: List[str]) -> Look:
        diffuse, transparency, texture = script.diffuse, 0.0, ""
        if script.blend and diffuse is not None:
            transparency = 1.0 - diffuse[3]
        elif diffuse is not None:
            diffuse = (*diffuse[:3], 1.0)  # Ogre ignores it without blending
        if script.texture:
            texture = self._textures.texture(os.path.basename(script.texture), folders) or ""
            diffuse = _WHITE if diffuse is None else diffuse
        return Look(script.name, script.ambient, diffuse, script.specular, script.emissive,
                    texture, scale=script.scale if texture else (1.0, 1.0),
                    transparency=transparency, lit=script.lighting,
                    alpha_test=script.alpha_test if texture else 0.0,
                    blended=script.blend and bool(texture), double_sided=script.double_sided)

    def _load(self, uri: str, wanted: str) -> List[str]:
        """Read the scripts of a URI; returns the folders that may contain their images."""
        try:
            scripts, folders = scripts_of(uri, self._resolver)
        except ResourceNotFoundError:
            return []
        for script in scripts:
            self._read_script(script, wanted)
        return folders

    def _read_script(self, path: str, wanted: str) -> None:
        """Note the materials of a script: all when it is read, then the wanted one.

        Many visuals may name a folder of many materials.
        """
        try:
            found = materials_of(path)
        except OSError:
            return
        names = [wanted] if wanted in found else []
        if self._scripts.get(path) is not found:
            self._scripts[path], names = found, list(found)
        for name in names:
            self._seen[name] = found[name]
            self._folders[name] = [os.path.dirname(path)]

    def _path(self, uri: str) -> str:
        """Return the path of a URI; "" if there is no such file."""
        try:
            return self._resolver.resolve(uri)
        except ResourceNotFoundError:
            return ""


def _of_paint(name: str, paint: Paint) -> Look:
    part = 1.0 / paint.repeats if paint.pattern else 1.0
    return Look(name, _opaque(paint.ambient), _opaque(paint.diffuse), _opaque(paint.specular),
                _opaque(paint.emissive), pattern=paint.pattern, scale=(part, part),
                transparency=1.0 - paint.alpha, lit=paint.lit)


def _opaque(color: Rgb) -> Color:
    return (color[0], color[1], color[2], 1.0)
