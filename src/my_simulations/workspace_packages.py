"""The Python packages of the sourced workspace, for programs that its own Python does not run."""
from __future__ import annotations

import os
import sys
from typing import List


def workspace_pythons() -> List[str]:
    """The Pythons of the virtual environments of the sourced workspaces, innermost first."""
    found = []
    for prefix in os.environ.get("CMAKE_PREFIX_PATH", "").split(os.pathsep):
        python = os.path.join(os.path.dirname(prefix), ".my_simulations", "venv", "bin", "python3")
        if prefix and os.path.exists(python):
            found.append(python)
    return found


def site_packages() -> List[str]:
    """The folders of packages that the running Python can use: those made for this very Python."""
    found = []
    for python in workspace_pythons():
        root = os.path.dirname(os.path.dirname(python))
        folder = os.path.join(root, "lib", "python{}.{}".format(*sys.version_info), "site-packages")
        if (os.path.realpath(python) == os.path.realpath(sys.executable)
                and os.path.realpath(root) != os.path.realpath(sys.prefix)
                and os.path.isdir(folder)):
            found.append(folder)
    return found


def use_workspace_packages() -> None:
    """Let this program import the packages of the sourced workspace, if they suit its Python."""
    if sys.prefix == sys.base_prefix:   # a virtual environment of the user has its own packages
        sys.path += [folder for folder in site_packages() if folder not in sys.path]
