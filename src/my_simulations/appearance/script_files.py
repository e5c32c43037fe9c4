"""Finds the material scripts of a URI and reads them; each file is read once."""
from __future__ import annotations

import contextlib
import functools
import os
from typing import Dict, List, Optional, Tuple

from ..resources.resolver import Resolver
from .material_script import LARGEST, ScriptMaterial, read_materials
from .textures import MEDIA

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
    return _read(script, status.st_mtime_ns, status.st_size)


@functools.lru_cache(maxsize=256)
def _read(script: str, _changed: int, _size: int) -> Dict[str, ScriptMaterial]:
    with open(script, encoding="utf-8", errors="replace") as stream:
        return read_materials(stream.read(LARGEST))


def _scripts_in(folder: str) -> List[str]:
    """Return the *.material files of a folder, sorted, up to the limit of their total size."""
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
