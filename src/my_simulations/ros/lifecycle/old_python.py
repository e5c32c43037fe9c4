"""What Debian 11's interpreter, Python 3.9.2, needs to run the node.

Its imports in several threads may fail: `from package.module import name` can see a module that
another thread has imported half (issue 43517 of CPython, mended in 3.8.9 and 3.9.3). And its rospy
calls `Thread.isAlive`, which Python 3.9 has removed.
"""
from __future__ import annotations

import sys
import threading
from typing import Any, Tuple


def imports_race(version: Tuple[int, ...] = tuple(sys.version_info[:3])) -> bool:
    """Whether an interpreter may fail when several threads import."""
    return version < (3, 8, 9) or (3, 9) <= version < (3, 9, 3)


def import_in_turn() -> None:
    """Import in this thread what several threads import while the node starts."""
    from ...resources.database import download_notes  # noqa: F401
    from ...simulator import world_loading  # noqa: F401
    from ..topics import state_publishers  # noqa: F401
    from . import editor_launcher  # noqa: F401


def give_threads_is_alive() -> None:
    """Give threads the name that rospy asks for when it shuts down, where they lack it."""
    if not hasattr(threading.Thread, "isAlive"):
        thread: Any = threading.Thread
        thread.isAlive = thread.is_alive


def prepare_threads() -> None:
    """Work around the faults of Debian 11's Python; call this before starting threads."""
    if imports_race():
        give_threads_is_alive()
        import_in_turn()
