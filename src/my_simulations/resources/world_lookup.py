"""Which world file a name means, which ones ship with this package, and where a user's are kept."""
from __future__ import annotations

import difflib
import os
from typing import List, Tuple

from .package_files import own_directory
from .resolver import Resolver, ResourceNotFoundError

ENDINGS = (".world", ".sdf")
"""What a world's file name ends in."""

SHIPPED = (
    "empty_world.world", "lab_course.world", "lab_room.world", "worlds/elevator_ros.world",
    "worlds/empty.world", "worlds/gazebo_ros_range.world", "worlds/mud.world",
    "worlds/rubble.world", "worlds/shapes.world", "worlds/willowgarage.world",
)
"""The worlds of this package, below its folder `world`; every other file there is a user's."""

_SYSTEM = ("/usr/", "/opt/ros/")
"""Below these, files belong to installed packages, also where an administrator may write."""


def users_folder() -> str:
    """Where worlds are saved that belong to no other place; it need not exist yet."""
    return os.path.expanduser("~/my_simulations/worlds")


def ships(path: str) -> bool:
    """Whether a file that exists came with this package: a world of `SHIPPED`, a model, an object.

    Links are followed: what lies in the package by a link alone is not the package's.
    """
    own, real = own_directory(), os.path.realpath(path)
    if not own or not os.path.exists(real):
        return False
    inside = os.path.relpath(real, os.path.realpath(own))
    if inside.startswith(os.pardir + os.sep):
        return False
    folder, _, name = inside.partition(os.sep)
    return folder != "world" or name.replace(os.sep, "/") in SHIPPED


def folder_of_users(world_file: str) -> str:
    """The folder of a world file that is the user's own; "" when it ships or nobody may write.

    Links are followed.
    """
    if not world_file or not os.path.isfile(world_file):
        return ""
    real = os.path.realpath(world_file)
    folder = os.path.dirname(real)
    if ships(real) or real.startswith(_SYSTEM) or not os.access(folder, os.W_OK):
        return ""
    return folder


def find_world(name: str, resolver: Resolver, caller: str = "") -> str:
    """The absolute path of the world that a name means.

    Relative names are looked for in the caller's folder, then in `users_folder`, then where the
    resolver looks (Gazebo's order).

    Args:
        name: path, URI, or a name in one of those folders; `~` is the home folder.
        resolver: see above.
        caller: folder in which the command was typed; "" for the working directory.

    Raises:
        ResourceNotFoundError: it is in none of them; `tried` names every place.
    """
    name = os.path.expanduser(name.strip())
    tried: List[str] = []
    if name and "://" not in name and not os.path.isabs(name):
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


def advice_on(name: str, caller: str = "") -> str:
    """What to do about a world that was not found: the files it may have meant."""
    known = _known(caller or os.getcwd())
    base = os.path.basename(name.strip().rstrip("/"))
    same = [os.path.join(folder, file) for folder, file in known
            if os.path.basename(file) == base]
    if same:
        return f"did you mean {same[0]}?"
    stems = {_stem(file): file for _, file in reversed(known)}
    near = difflib.get_close_matches(_stem(base), stems, 1, 0.7)
    meant = f"did you mean {stems[near[0]]}? Otherwise " if near else ""
    return f"{meant}give its full path, or add its folder to GAZEBO_RESOURCE_PATH"


def _stem(file: str) -> str:
    """A name without its ending, which is often forgotten or another one."""
    return os.path.splitext(os.path.basename(file))[0].lower()


def _known(caller: str) -> List[Tuple[str, str]]:
    """World files that a name could mean: folder, and name in it."""
    own = own_directory()
    folders = [caller, users_folder(), *([os.path.join(own, "world")] if own else [])]
    found: List[Tuple[str, str]] = []
    for folder in folders:
        for below in ("", "world", "worlds"):
            try:
                names = sorted(os.listdir(os.path.join(folder, below)))
            except OSError:
                continue
            found += [(folder, os.path.join(below, name)) for name in names
                      if name.lower().endswith(ENDINGS)]
    return found
