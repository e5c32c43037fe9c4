"""Locates this package's own files, in the source tree or an install space."""
from __future__ import annotations

import os
from typing import List

PACKAGE = "my_simulations"
UNDERLAY = "MY_SIMULATIONS_UNDERLAY"
"""Environment variable of a workspace with its own package of our name: prefix of our package."""


def own_directory() -> str:
    """The folder with `models/`, `world/` and `Media/` of this package; "" where there is none.

    Found without rospkg, which takes start-up time: the source tree contains this module, an
    install space has `share/my_simulations` beside `lib`, and CMAKE_PREFIX_PATH lists the others.
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
    """Folders that are searched for `package://my_simulations/...`, in order.

    Only ours, unless the workspace has its own package of this name (`tools/run --overlay`), which
    comes first. rospack is queried in such a workspace only, because it takes start-up time.
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

    If a user's package with our name lacks the file, the path in our package if it exists there.
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
