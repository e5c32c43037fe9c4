"""roslaunch for a workspace that has a package my_simulations of its own.

roslaunch resolves `$(find my_simulations)/FILE` by searching every catkin prefix: it finds the
workspace's file first, else ours in the last prefix. Two cases are not covered and are added here:
a path followed by a quote, `command="cat '$(find my_simulations)/FILE'"`, and
`roslaunch my_simulations FILE`, which searches one package folder only.
"""
from __future__ import annotations

import os
import re
import sys
from typing import Any, Callable, List, Tuple

from ..resources.package_files import PACKAGE, own_directory

_PATH = re.compile(r"[^ '\"]*")


def separate_first_path(value: str) -> Tuple[str, str]:
    """The path after `$(find PKG)`, up to a blank or quote, and the rest."""
    found = _PATH.match(value)
    end = found.end() if found else 0
    return value[:end], value[end:]


def with_own_files(find: Callable[..., List[str]]) -> Callable[..., List[str]]:
    """`roslib.packages.find_resource`, extended to find our launch files after the user's."""

    def find_resource(package: str, name: str, *more: Any, **options: Any) -> List[str]:
        found = find(package, name, *more, **options)
        if found or package != PACKAGE:
            return found
        ours = os.path.join(own_directory(), "launch", name)
        if os.path.dirname(name) or not os.path.isfile(ours):
            return []
        print(f"package {PACKAGE} of the workspace has no {name}; using {ours}", file=sys.stderr,
              flush=True)
        return [ours]

    return find_resource


def main() -> int:
    """Run roslaunch with the command line; returns its exit status."""
    import roslaunch
    import roslib.packages
    from roslaunch import substitution_args

    if hasattr(substitution_args, "_separate_first_path"):
        substitution_args._separate_first_path = separate_first_path
    roslib.packages.find_resource = with_own_files(roslib.packages.find_resource)
    return int(roslaunch.main() or 0)
