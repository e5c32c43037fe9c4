"""Assignments that come with the package, by name."""
from __future__ import annotations

import os
from typing import List

from ..resources.package_files import own_directory


def folder() -> str:
    return os.path.join(own_directory(), "config", "assignments")


def names() -> List[str]:
    return sorted(os.path.splitext(name)[0] for name in os.listdir(folder())
                  if name.endswith(".yaml"))


def shipped_assignment(name: str) -> str:
    """The path of an assignment file: `name` itself if there is such a file or no shipped one."""
    found = os.path.join(folder(), f"{name}.yaml")
    return found if not os.path.isfile(name) and os.path.isfile(found) else name
