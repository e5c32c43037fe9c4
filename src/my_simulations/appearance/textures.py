"""Finds texture images of materials and meshes."""
from __future__ import annotations

import os
from typing import Iterator, List, Optional

from ..resources.resolver import Resolver

MEDIA = ("", "media", "Media")
"""Folders in a resource folder, with `materials` inside."""

_BESIDE = (os.path.join("..", "materials", "textures"), os.path.join("materials", "textures"),
           "textures", os.path.join("..", "textures"))


def script_image_candidates(name: str, folders: List[str],
                            resource_folders: List[str]) -> Iterator[str]:
    """Yield candidate paths of a script's image, beside the script first (Gazebo behaviour)."""
    for folder in folders:
        for place in (os.path.join(folder, name), os.path.join(folder, "..", "textures", name)):
            yield os.path.normpath(place)
    yield from _media_candidates(name, resource_folders)


def mesh_image_candidates(path: str, resource_folders: List[str]) -> Iterator[str]:
    """Yield candidate paths of a mesh's image that is not at `path` (Gazebo behaviour)."""
    folder, name = os.path.split(path)
    for beside in _BESIDE:
        yield os.path.normpath(os.path.join(folder, beside, name))
    yield from _media_candidates(name, resource_folders)


def _media_candidates(name: str, resource_folders: List[str]) -> Iterator[str]:
    for base in resource_folders:
        for media in MEDIA:
            yield os.path.join(base, media, "materials", "textures", name)


def existing_path(path: str) -> Optional[str]:
    """Return the real path of a file, ignoring the letter case of its name; None if missing."""
    real = os.path.realpath(path)
    if os.path.isfile(real):
        return real
    folder, name = os.path.split(real)
    try:
        same = [entry for entry in os.listdir(folder) if entry.lower() == name.lower()]
    except OSError:
        return None
    found = os.path.realpath(os.path.join(folder, same[0])) if same else ""
    return found if os.path.isfile(found) else None


class TextureFiles:
    """Texture images for renderers on this machine."""

    def __init__(self, resolver: Resolver) -> None:
        self._resolver = resolver

    def texture(self, name: str, folders: List[str]) -> Optional[str]:
        """The path of a script's image; None if there is none."""
        places = script_image_candidates(name, folders, self._resolver.resource_folders())
        return next((found for found in map(existing_path, places) if found), None)
