"""Names the Python to use where the running one lacks a package."""
from __future__ import annotations

import importlib.util
import os
import sys

from .errors import CommandError
from .workspace_packages import use_workspace_packages, workspace_pythons


def require(module: str) -> None:
    """Check that a module is installed. Raises CommandError, which says how to get it."""
    if importlib.util.find_spec(module) is None:
        raise CommandError(advice(module))


def require_extra(module: str) -> None:
    """Find a module that a workspace does not bring. Raises ImportError, which says how to get it.

    Packages of the workspace can be imported afterwards.
    """
    use_workspace_packages()
    if importlib.util.find_spec(module) is not None:
        return
    python = next(iter(workspace_pythons()), sys.executable)
    root = os.path.dirname(os.path.dirname(python))
    run = ""
    if os.path.realpath(root) != os.path.realpath(sys.prefix) and not any(
            folder.startswith(root) for folder in sys.path):
        run = f", and run the program with it: {python} {sys.argv[0]}"
    raise ImportError(f"{sys.executable} has no module {module!r}; install it with"
                      f" {python} -m pip install {module}{run}")


def advice(module: str) -> str:
    """A sentence for a program whose Python lacks `module`."""
    for python in workspace_pythons():
        if os.path.realpath(sys.prefix) != os.path.realpath(
                os.path.dirname(os.path.dirname(python))):
            return (f"{sys.executable} has no module {module!r}; run the program with the Python "
                    f"of this workspace: {python} {sys.argv[0]}")
    return f"{sys.executable} has no module {module!r}; pip install my_simulations brings it"
