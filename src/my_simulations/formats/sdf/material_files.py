"""Warns about material scripts, materials and textures that do not exist."""
from __future__ import annotations

import os
import re
from typing import Any, Dict, List, Tuple

from ...appearance.gazebo_materials import BUILT_IN
from ...appearance.material_script import ScriptMaterial, materials_of, scripts_of, shared_material
from ...appearance.textures import TextureFiles
from ...description.compare import BUILT_IN as BUILT_IN_SCRIPT
from ...description.shapes import Material
from ...description.validate import closest_name_hint
from ...errors import warning
from ...resources.resolver import ResourceNotFoundError
from ..xml.source import Source


def check_script(material: Material, element: Any, source: Source) -> None:
    """Check the scripts of a material, its name, and its texture.

    Args:
        material: with absolute script URIs.
        element: its `<material>`.
        source: receives warnings, and resolves URIs.
    """
    known, folders, complete = _read_scripts(material.script_uris, element, source)
    name = material.script_name
    found = known.get(name)
    if found is None and name and name not in BUILT_IN:
        found = shared_material(name, source.resolver)
        folders = [os.path.dirname(found[1])] if found is not None else folders
    if found is not None:
        _check_texture(*found, folders, source)
    elif name and name not in BUILT_IN and material.script_uris and complete:
        source.warn("material-unknown", f"no material script defines {name!r}; white is shown",
                    element, closest_name_hint(name, [*known, *BUILT_IN]))


def _read_scripts(uris: List[str], element: Any, source: Source
                  ) -> "Tuple[Dict[str, Tuple[ScriptMaterial, str]], List[str], bool]":
    """The materials of scripts with their files, the folders of images, and whether all exist."""
    known: Dict[str, Tuple[ScriptMaterial, str]] = {}
    folders: List[str] = []
    complete = True
    written = element.findall("script/uri")
    for number, uri in enumerate(uris):
        if uri == BUILT_IN_SCRIPT:
            continue
        named = written[number] if len(written) == len(uris) else element
        source.report_home_path(uri, named)
        try:
            scripts, more = scripts_of(uri, source.resolver, source.base_dir)
            folders += more
            for script in scripts:
                known.update((name, (found, script))
                             for name, found in materials_of(script).items())
        except (ResourceNotFoundError, OSError) as fault:
            complete = False
            text, hint = (source.resolver.explain(fault, "check the path and GAZEBO_MODEL_PATH")
                          if isinstance(fault, ResourceNotFoundError)
                          else (f"{uri!r} cannot be read: {fault.strerror}", ""))
            source.warn("material-script-not-found", f"the material script {text}; it is left"
                        " out", named, hint)
    return known, folders, complete


def _check_texture(material: ScriptMaterial, script: str, folders: List[str],
                   source: Source) -> None:
    name = os.path.basename(material.texture)
    if not name or TextureFiles(source.resolver).texture(name, folders) is not None:
        return
    expected = os.path.normpath(os.path.join(os.path.dirname(script), "..", "textures"))
    source.log.add(warning(
        "image-not-found", f"the texture {material.texture!r} of material {material.name!r} was"
        " not found; the material is shown without it", file=script,
        line=_line_of(material.texture, script),
        hint=closest_name_hint(name, _files_of([*folders, expected])) or f"copy it to {expected}"))


def _files_of(folders: List[str]) -> List[str]:
    """The names of the files in folders that exist."""
    return [name for folder in folders if os.path.isdir(folder) for name in os.listdir(folder)]


def _line_of(texture: str, script: str) -> int:
    """The first line of a script that names a texture, from 1; 0 if there is none."""
    named = re.compile(rf'(?:^|\s)texture\s+"?{re.escape(texture)}(?!\S*[^\s"])')
    with open(script, encoding="utf-8", errors="replace") as stream:
        return next((number for number, line in enumerate(stream, 1) if named.search(line)), 0)


def check_texture_uri(uri: str, element: Any, source: Source) -> None:
    """Check the texture of a URDF material.

    Args:
        uri: as written.
        element: the `<texture>` or its material.
        source: receives a warning, and resolves the URI.
    """
    try:
        source.report_home_path(uri, element)
        source.resolver.resolve(uri)
    except ResourceNotFoundError as missing:
        text, hint = source.resolver.explain(missing, "check the path and ROS_PACKAGE_PATH")
        source.warn("image-not-found", f"the texture {text}; the visual is shown without it",
                    element, hint)
