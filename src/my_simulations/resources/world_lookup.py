"""Finds world files by name; tells shipped worlds from those of users."""
from __future__ import annotations

import difflib
import os
from typing import List, Tuple

from .package_files import own_directory
from .resolver import Resolver, ResourceNotFoundError

ENDINGS = (".world", ".sdf")
"""File extensions of worlds."""

SHIPPED = (
    "empty_world.world", "exercises.world", "house.world", "lab_course.world", "lab_room.world",
    "street.world", "warehouse.world",
    "worlds/elevator_ros.world", "worlds/empty.world", "worlds/gazebo_ros_range.world",
    "worlds/learning.world", "worlds/mud.world", "worlds/rubble.world", "worlds/shapes.world",
    "worlds/willowgarage.world",
)
"""The worlds of this package, in its folder `world`; all other files there are the user's."""

_SHIPPED_FOLDERS = ("compat", "examples", "models", "objects", "test")
"""The other folders of this package that have SDF files. A clone often is the folder
`~/my_simulations`, so `users_folder` and the folder of `tools/run` can be inside the package."""

_SYSTEM = ("/usr/", "/opt/ros/")
"""Folders of installed packages, which are never used for saving, even if writable."""

WORLDS = os.path.join("my_simulations", "worlds")
"""Default folder for saved worlds, in the home of a user."""


def users_folder() -> str:
    """Default folder for saved worlds; it need not exist."""
    return os.path.join(os.path.expanduser("~"), WORLDS)


def is_shipped(path: str) -> bool:
    """Whether an existing world or model file ships with this package.

    These are the worlds of `SHIPPED` and the files in the folders of its models and objects.

    Symbolic links are resolved: files that are linked into the package do not count.
    """
    own, real = own_directory(), os.path.realpath(path)
    if not own or not os.path.exists(real):
        return False
    inside = os.path.relpath(real, os.path.realpath(own))
    if inside.startswith(os.pardir + os.sep):
        return False
    folder, _, name = inside.partition(os.sep)
    if folder == "world":
        return name.replace(os.sep, "/") in SHIPPED
    return folder in _SHIPPED_FOLDERS


def folder_of_users(world_file: str) -> str:
    """The folder of a user's world file; "" if the file ships or the folder is not writable.

    Symbolic links are resolved.
    """
    if not world_file or not os.path.isfile(world_file):
        return ""
    real = os.path.realpath(world_file)
    folder = os.path.dirname(real)
    if is_shipped(real) or real.startswith(_SYSTEM) or not os.access(folder, os.W_OK):
        return ""
    return folder


def find_world(name: str, resolver: Resolver, caller: str = "") -> str:
    """The absolute path of a world.

    Relative names are searched in the caller's folder, in `users_folder`, then by the resolver
    (Gazebo's order). An absolute path is searched nowhere else.

    Args:
        name: path, URI, or a name in one of those folders; `~` is the home folder.
        resolver: searches Gazebo's resource folders.
        caller: working directory of the user's command; "" for that of this process.

    Raises:
        ResourceNotFoundError: not found; `tried` lists every place.
    """
    name = os.path.expanduser(name.strip())
    tried: List[str] = []
    if os.path.isabs(name):
        if os.path.isfile(name):
            return os.path.abspath(name)
        raise ResourceNotFoundError(name, [name], _reason(name))
    if name and "://" not in name:
        for folder in (caller or os.getcwd(), users_folder()):
            candidate = os.path.abspath(os.path.join(folder, name))
            if os.path.isfile(candidate):
                return candidate
            if candidate not in tried:
                tried.append(candidate)
    try:
        return resolver.resolve(name)
    except ResourceNotFoundError as missing:
        more = [place for place in missing.tried if place not in tried]
        raise ResourceNotFoundError(name, tried + more, missing.reason) from None


def similar_world(name: str, caller: str = "") -> str:
    """A world file that exists and is named like one that was not found; "" for none."""
    path = os.path.expanduser(name.strip().rstrip("/"))
    base = os.path.basename(path)
    beside = _worlds_in(os.path.dirname(path)) if os.path.isabs(path) else []
    known = beside + _known_worlds(caller or os.getcwd())
    same = [os.path.join(folder, file) for folder, file in known
            if os.path.basename(file) == base]
    if same:
        return same[0]
    stems = {_stem(file): file for _, file in reversed(known)}
    stems.update((_stem(file), os.path.join(folder, file)) for folder, file in reversed(beside))
    near = difflib.get_close_matches(_stem(base), stems, 1, 0.7)
    return stems[near[0]] if near else ""


def advice_on(name: str, caller: str = "") -> str:
    """Hint for a world that was not found: similar existing files."""
    path = os.path.expanduser(name.strip().rstrip("/"))
    near = similar_world(name, caller)
    meant = f"did you mean {near}?" if near else ""
    if os.path.isabs(path):
        return meant or "correct the path"
    if os.path.basename(near) == os.path.basename(path):
        return meant
    otherwise = "give its full path, or add its folder to GAZEBO_RESOURCE_PATH"
    return f"{meant} Otherwise {otherwise}" if meant else otherwise


def _reason(path: str) -> str:
    """Why an existing path is no world file; "" if nothing is there."""
    if os.path.isdir(path):
        return "this is a folder"
    return "this is a device or a pipe, not a file" if os.path.exists(path) else ""


def _stem(file: str) -> str:
    """A name without its extension, for comparison."""
    return os.path.splitext(os.path.basename(file))[0].lower()


def _known_worlds(caller: str) -> List[Tuple[str, str]]:
    """Existing world files: (folder, name)."""
    own = own_directory()
    folders = [caller, users_folder(), *([os.path.join(own, "world")] if own else [])]
    return [world for folder in folders for below in ("", "world", "worlds")
            for world in _worlds_in(folder, below)]


def _worlds_in(folder: str, below: str = "") -> List[Tuple[str, str]]:
    """The world files of one folder: (folder, path from there)."""
    try:
        names = sorted(os.listdir(os.path.join(folder, below)))
    except OSError:
        return []
    return [(folder, os.path.join(below, name)) for name in names
            if name.lower().endswith(ENDINGS)
            and os.path.isfile(os.path.join(folder, below, name))]
