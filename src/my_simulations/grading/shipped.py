"""Assignments that come with the package, by name."""
from __future__ import annotations

import os
from typing import List

from ..errors import CommandError
from ..resources.package_files import own_directory


def _folder() -> str:
    return os.path.join(own_directory(), "config", "assignments")


def shipped_assignments() -> List[str]:
    return sorted(os.path.splitext(name)[0] for name in os.listdir(_folder())
                  if name.endswith(".yaml"))


def shipped_assignment(name: str) -> str:
    """The path of an assignment file: `name` itself if there is such a file or no shipped one.

    Raises CommandError: it is neither a path nor the name of a shipped one.
    """
    found = os.path.join(_folder(), f"{name}.yaml")
    if not os.path.isfile(name) and os.path.isfile(found):
        return found
    if not os.path.exists(name) and os.path.basename(name) == name and "." not in name:
        raise CommandError(f"there is no assignment {name!r}: it is neither a file nor one of"
                           f" {', '.join(shipped_assignments())}")
    return name
