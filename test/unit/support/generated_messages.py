"""The code of messages that the workspace under test has generated, for other workspaces.

To generate it again, from the same definitions and by the same commands, takes a minute.
"""
from __future__ import annotations

import os
import shutil
from pathlib import Path
from typing import Callable

DEVEL = Path(os.environ["CMAKE_PREFIX_PATH"].split(":")[0])
"""The workspace under test."""
PACKAGES = ("control_msgs", "controller_manager_msgs", "gazebo_msgs", "my_simulations_msgs")
PARTS = ("lib/python3/dist-packages/{}", "include/{}", "share/{}/msg", "share/common-lisp/ros/{}")
"""Folders of a devel space with what is generated from a package's messages."""
_COMPILED = shutil.ignore_patterns("__pycache__")


def copy_messages(devel: Callable[[str], Path]) -> None:
    """Give a new workspace the generated code; `devel`: the devel space of a package."""
    for package in PACKAGES:
        for part in PARTS:
            generated = DEVEL / part.format(package)
            if generated.is_dir():
                shutil.copytree(generated, devel(package) / part.format(package), ignore=_COMPILED)
