"""Importing rospy without what the node never uses."""
from __future__ import annotations

import sys


def import_genpy() -> None:
    """Import ROS's message library without NumPy, which it takes when it can and does without.

    NumPy would cost the node 14 MB and 40 ms; only its number types in message fields go missing,
    and those the node never sends. Call this before any other import of ROS or NumPy, while there
    is one thread.
    """
    if "numpy" in sys.modules or "genpy" in sys.modules:
        return
    sys.modules["numpy"] = None  # type: ignore[assignment]
    try:
        import genpy  # noqa: F401
    finally:
        del sys.modules["numpy"]
