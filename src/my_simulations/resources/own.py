"""Where this package's own files lie: in the source tree, or in an install space."""
from __future__ import annotations

import os
from pathlib import Path

PACKAGE = "my_simulations"


def own_directory() -> str:
    """The folder with `models/`, `world/` and `Media/` of this package; "" where there is none.

    Found without rospkg, which costs start-up time: the source tree holds this module, an install
    space has `share/my_simulations` beside its `lib`, and CMAKE_PREFIX_PATH names the others.
    """
    here = Path(__file__).resolve()
    source_root = here.parents[3]
    if (source_root / "package.xml").is_file() and (source_root / "models").is_dir():
        return str(source_root)
    prefixes = [str(parent) for parent in here.parents]
    prefixes += os.environ.get("CMAKE_PREFIX_PATH", "").split(os.pathsep)
    for prefix in prefixes:
        share = os.path.join(prefix, "share", PACKAGE)
        if prefix and os.path.isfile(os.path.join(share, "package.xml")):
            return share
    return str(source_root) if (source_root / "models").is_dir() else ""
