#!/usr/bin/env python3
"""Starts pip's xacro 1.13, with the Python that has it."""
import importlib.util
import os
import sys

# The folder of this script may hold a script xacro.py, which would hide the module xacro.
sys.path[:] = [entry for entry in sys.path
               if not os.path.isfile(os.path.join(entry or os.curdir, "xacro.py"))]


def main() -> int:
    """Run xacro here, or in the workspace's Python where this one has none."""
    if importlib.util.find_spec("xacro") is not None:
        import xacro
        return xacro.main()
    python = os.environ.pop("MY_SIMULATIONS_PYTHON", "")
    if python:
        os.execv(python, [python, os.path.abspath(__file__), *sys.argv[1:]])
    sys.stderr.write("xacro: this Python has no module xacro; source the setup file of the "
                     "workspace first (devel/setup.bash).\n")
    return 2


if __name__ == "__main__":
    sys.exit(main())
