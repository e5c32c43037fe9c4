"""Reads the subset of Ogre's `.material` scripts that models use: colours and one texture.

Only the first pass of the first technique is read, and of its texture units the first with a
texture. Of a derived material, the first unit changes the first of its parent unless it has another
name (Ogre behaviour); further units are added to those of the parent. Source: Ogre's script format,
as used by public Gazebo models.
"""
from __future__ import annotations

import contextlib
import functools
import math
import os
import re
from dataclasses import dataclass, field, replace
from typing import Dict, List, Optional, Sequence, Tuple

from ..description.shapes import Color
from ..resources.resolver import Resolver
from .textures import MEDIA

_TOKEN = re.compile(r'"[^"]*"|[{}]|\n|[^\s{}"]+')
# An open comment ends with the text; to look for the end of each would take hours.
_COMMENT = re.compile(r"//[^\n]*|/\*.*?(?:\*/|\Z)", re.DOTALL)
LARGEST = 1 << 20
"""Characters of a script that are read: they take a second at most."""

_DEEPEST = 20


@dataclass
class ScriptMaterial:
    """A material of a script; None and "" for values that it does not set."""

    name: str
    ambient: Optional[Color] = None
    diffuse: Optional[Color] = None
    specular: Optional[Color] = None
    emissive: Optional[Color] = None
    lighting: bool = True
    blend: bool = False
    alpha_test: float = 0.0
    double_sided: bool = False
    texture: str = ""
    scale: Tuple[float, float] = (1.0, 1.0)
    parent: str = field(default="", repr=False)
    unit: str = field(default="", repr=False, compare=False)
    """Name of the texture unit that is read."""


def read_materials(text: str) -> Dict[str, ScriptMaterial]:
    """The materials of a script by name; unknown statements are skipped."""
    words = [word.strip('"') if word.startswith('"') else word
             for word in _TOKEN.findall(_COMMENT.sub("", text[:LARGEST]))]
    found: Dict[str, ScriptMaterial] = {}
    at = 0
    while at < len(words):
        if words[at] != "material":
            at += 1
            continue
        line, at = _line(words, at + 1)
        while at < len(words) and words[at] == "\n":
            at += 1
        if not line or at >= len(words) or words[at] != "{":
            continue
        name, parent = _heading(line)
        base = found.get(parent)
        material = replace(base, name=name) if base else ScriptMaterial(name, parent=parent)
        at = _block(words, at + 1, material, (), {})
        found[name] = material
    return found


def _heading(line: List[str]) -> Tuple[str, str]:
    text = " ".join(line)
    name, _, parent = text.partition(" : ")
    return name.strip(), parent.strip()


def _line(words: Sequence[str], at: int) -> Tuple[List[str], int]:
    """The words up to the end of the line or a brace."""
    line: List[str] = []
    while at < len(words) and words[at] not in ("\n", "{", "}"):
        line.append(words[at])
        at += 1
    return line, at


def _block(words: Sequence[str], at: int, material: ScriptMaterial, above: Tuple[str, ...],
           seen: Dict[str, int]) -> int:
    """Read the contents of a block; returns the position after its closing brace."""
    while at < len(words):
        if words[at] == "}":
            return at + 1
        line, at = _line(words, at)
        after = at
        while after < len(words) and words[after] == "\n":
            after += 1
        if after < len(words) and words[after] == "{" and len(above) < _DEEPEST:
            kind = line[0] if line else ""
            seen[kind] = seen.get(kind, 0) + 1
            if kind == "texture_unit":
                _choose_unit(" ".join(line[1:]), material, seen)
            at = _block(words, after + 1, material, (*above, kind), seen)
        else:
            first = all(seen.get(kind, 1) == 1 for kind in ("technique", "pass"))
            if line and first and (above[-1:] != ("texture_unit",) or seen.get("chosen unit")):
                _setting(line, material)
            at = max(after, at + (0 if at < len(words) and words[at] == "}" else 1)) \
                if after < len(words) else len(words)
    return at


def _choose_unit(name: str, material: ScriptMaterial, seen: Dict[str, int]) -> None:
    """Note whether the texture unit that begins is the one to read."""
    first = seen["texture_unit"] == 1 and name in ("", material.unit)
    chosen = first or not material.texture
    seen["chosen unit"] = int(chosen)
    if chosen and name:
        material.unit = name


def _setting(line: List[str], material: ScriptMaterial) -> None:
    word, values = line[0], line[1:]
    if word in ("ambient", "diffuse", "specular", "emissive"):
        numbers = _numbers(values)
        if len(numbers) >= 3:
            # A specular line of 4 numbers is r g b shininess; of 5, r g b a shininess.
            has_alpha = len(numbers) >= (5 if word == "specular" else 4)
            alpha = numbers[3] if has_alpha else 1.0
            setattr(material, word, (numbers[0], numbers[1], numbers[2], alpha))
    elif word == "lighting" and values:
        material.lighting = values[0] != "off"
    elif word == "scene_blend" and values:
        material.blend = values[0] == "alpha_blend"
    elif word == "alpha_rejection" and values:
        # Ogre keeps a pixel whose alpha, 0 to 255, is (for example) `greater` than the number.
        numbers = _numbers(values[1:])
        kept = values[0] in ("greater", "greater_equal")
        material.alpha_test = min(numbers[0] / 255.0, 1.0) if kept and numbers else 0.0
    elif word == "cull_hardware" and values:
        material.double_sided = values[0] == "none"
    elif word == "texture" and values:
        material.texture = "" if "\0" in values[0] else values[0]
    elif word == "scale" and len(_numbers(values)) >= 2:
        u, v = _numbers(values)[:2]
        material.scale = (u or 1.0, v or 1.0)


def _numbers(values: Sequence[str]) -> List[float]:
    """The finite numbers that the line begins with."""
    found: List[float] = []
    for value in values:
        try:
            number = float(value)
        except ValueError:
            break
        if not math.isfinite(number):
            break
        found.append(number)
    return found


_MOST_OF_A_FOLDER = 8 * LARGEST
"""Bytes of scripts that are read of one folder."""


def scripts_of(uri: str, resolver: Resolver, base_dir: str = "") -> Tuple[List[str], List[str]]:
    """The scripts of a URI, relative to `base_dir`, and the folders that may contain their images.

    Raises ResourceNotFoundError: neither a file nor a folder.
    """
    path = resolver.resolve(uri, base_dir)
    if os.path.isdir(path):
        return _scripts_in(path), [path]
    return [path] if path.endswith(".material") else [], [os.path.dirname(path)]


def shared_material(name: str, resolver: Resolver) -> Optional[Tuple[ScriptMaterial, str]]:
    """A material that a script of a resource folder defines, and the script; None for none.

    Gazebo reads all these scripts at its start (RenderEngine::SetupResources), so that a name is
    enough. Scripts that cannot be read are left out.
    """
    for base in resolver.media_folders():
        for media in MEDIA:
            for script in _scripts_in(os.path.join(base, media, "materials", "scripts")):
                with contextlib.suppress(OSError):
                    found = materials_of(script)
                    if name in found:
                        return found[name], script
    return None


def materials_of(script: str) -> Dict[str, ScriptMaterial]:
    """The materials of a script by name, cached by time; none for what is not a plain file.

    Callers must not change them. Raises OSError: it cannot be read.
    """
    status = os.stat(script)
    if not os.path.isfile(script):  # a named pipe may never have a writer
        return {}
    return _read_script(script, status.st_mtime_ns, status.st_size)


@functools.lru_cache(maxsize=256)
def _read_script(script: str, _changed: int, _size: int) -> Dict[str, ScriptMaterial]:
    with open(script, encoding="utf-8", errors="replace") as stream:
        return read_materials(stream.read(LARGEST))


def _scripts_in(folder: str) -> List[str]:
    """The scripts of a folder, as many as may be read."""
    try:
        names = [name for name in sorted(os.listdir(folder)) if name.endswith(".material")]
    except OSError:
        return []
    found, size = [], 0
    for path in (os.path.join(folder, name) for name in names):
        size += min(os.path.getsize(path), LARGEST) if os.path.isfile(path) else 0
        if size > _MOST_OF_A_FOLDER:
            break
        found.append(path)
    return found
