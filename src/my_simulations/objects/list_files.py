"""Where the object list of a world is kept in a package: config/WORLD/object_locations.yaml."""
from __future__ import annotations

import os

from ..resources.package_files import file_in_package

_LOCATIONS = "object_locations.yaml"
_GROUPS = "object_groups.yaml"
_WORLD_ENDINGS = (".world", ".sdf", ".xml")


def world_name(world: str) -> str:
    """The base name of a world, from its name or the path of its file."""
    base = os.path.basename(world.strip())
    root, ending = os.path.splitext(base)
    return root if ending in _WORLD_ENDINGS else base


def list_file(folder: str, package: str, world: str) -> str:
    """Path of the object list of a world, whether it exists or not.

    Args:
        folder: folder of the package.
        package: name of the package.
        world: name or file of the world.
    """
    inside = os.path.join("config", world_name(world), _LOCATIONS)
    return file_in_package(folder, package, inside)


def groups_file(locations: str) -> str:
    """Path of the groups that belong to an object list, whether it exists or not."""
    return os.path.join(os.path.dirname(locations), _GROUPS)
