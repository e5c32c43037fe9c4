"""Where this package's own files lie: in the source tree, or in an install space."""
from __future__ import annotations

import os
from typing import List

PACKAGE = "my_simulations"
UNDERLAY = "MY_SIMULATIONS_UNDERLAY"
"""Variable of a workspace that has a package of our name of its own: a prefix with ours in it."""


def own_directory() -> str:
    """The folder with `models/`, `world/` and `Media/` of this package; "" where there is none.

    Found without rospkg, which costs start-up time: the source tree holds this module, an install
    space has `share/my_simulations` beside its `lib`, and CMAKE_PREFIX_PATH names the others.
    """
    above = _parents(os.path.realpath(__file__))
    source_root = above[3]  # resources/, my_simulations/, src/, the root
    has_models = os.path.isdir(os.path.join(source_root, "models"))
    if has_models and os.path.isfile(os.path.join(source_root, "package.xml")):
        return source_root
    prefixes = above + os.environ.get("CMAKE_PREFIX_PATH", "").split(os.pathsep)
    for prefix in prefixes:
        share = os.path.join(prefix, "share", PACKAGE)
        # A user's package of this name has a package.xml too, but not our models.
        if prefix and os.path.isdir(os.path.join(share, "models", "ground_plane")):
            return share
    return source_root if has_models else ""


def package_directories() -> List[str]:
    """The folders in which `package://my_simulations/...` is looked for, best first.

    Ours alone, unless the workspace has a package of this name of its own (`tools/run --overlay`):
    that one comes first then. ROS is asked in such a workspace only; it costs start-up time.
    """
    own = own_directory()
    folders = [own] if own else []
    if os.environ.get(UNDERLAY):
        from .ros_packages import PackageIndex

        users = PackageIndex().find(PACKAGE)
        if users and os.path.realpath(users) != os.path.realpath(own):
            folders.insert(0, users)
    return folders


def file_in_package(folder: str, package: str, inside: str) -> str:
    """The path of `inside` below the folder of a package.

    Where a user's package has our name and no such file, the path below ours if there is one.
    """
    path = os.path.join(folder, inside)
    if package == PACKAGE and not os.path.exists(path):
        own = os.path.join(own_directory(), inside)
        return own if os.path.exists(own) else path
    return path


def _parents(path: str) -> List[str]:
    folders: List[str] = []
    while os.path.dirname(path) != path:
        path = os.path.dirname(path)
        folders.append(path)
    return folders
