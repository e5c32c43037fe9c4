#!/usr/bin/env python3
"""Starts xacro, with the Python of the workspace that has it."""
import os
import sys

# The folder of this script may hold a script xacro.py, which would hide the module xacro.
sys.path[:] = [entry for entry in sys.path
               if not os.path.isfile(os.path.join(entry or os.curdir, "xacro.py"))]


def main() -> int:
    """Run xacro here, or in the workspace's Python where this one is another."""
    python = os.environ.pop("MY_SIMULATIONS_PYTHON", "")
    prefix = os.path.dirname(os.path.dirname(python))
    if os.path.isfile(python) and os.path.realpath(prefix) != os.path.realpath(sys.prefix):
        os.execv(python, [python, os.path.abspath(__file__), *sys.argv[1:]])
    try:
        import xml.parsers.expat  # noqa: F401 - xacro uses it and does not import it

        import xacro
    except ImportError as fault:
        sys.stderr.write(f"xacro: {fault}\n")
        return 2
    return xacro.main()


if __name__ == "__main__":
    sys.exit(main())
