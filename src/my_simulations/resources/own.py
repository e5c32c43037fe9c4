"""Where this package's own files lie: in the source tree, or in an install space."""
from __future__ import annotations

import os
from typing import List

PACKAGE = "my_simulations"


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
        if prefix and os.path.isfile(os.path.join(share, "package.xml")):
            return share
    return source_root if has_models else ""


def _parents(path: str) -> List[str]:
    folders: List[str] = []
    while os.path.dirname(path) != path:
        path = os.path.dirname(path)
        folders.append(path)
    return folders
