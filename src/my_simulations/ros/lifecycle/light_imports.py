"""Imports rospy without NumPy, which the node does not need."""
from __future__ import annotations

import sys


def import_genpy() -> None:
    """Import ROS's message library without NumPy, which is optional for it.

    NumPy takes 14 MB and 40 ms; without it only NumPy types in message fields are not supported,
    which the node never sends. Call this before any other import of ROS or NumPy, while there is
    one thread.
    """
    if "numpy" in sys.modules or "genpy" in sys.modules:
        return
    sys.modules["numpy"] = None  # type: ignore[assignment]
    try:
        import genpy  # noqa: F401
    finally:
        del sys.modules["numpy"]
