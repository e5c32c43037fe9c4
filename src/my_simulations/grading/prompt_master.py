"""A ROS master that tells nodes of new publishers at once.

    python3 -m my_simulations.grading.prompt_master --core -p PORT

The threads of rosmaster look for tasks every 0.1 s of wall time. So the sim time at which the first
command of a program arrives would depend on chance.
"""
from __future__ import annotations

import threading
from typing import Any, Callable, Optional

import rosmaster
import rosmaster.threadpool

from ..child_process import die_with_parent


class PromptThreadPool(rosmaster.threadpool.MarkedThreadPool):   # type: ignore[misc]
    """A pool whose threads wait for tasks in place of looking for them.

    Args:
        threads: their number.
    """

    def __init__(self, threads: int) -> None:
        self._changed = threading.Condition()
        super().__init__(threads)

    def queue_task(self, marker: Any, task: Callable[..., Any], args: Any = None,
                   taskCallback: Optional[Callable[[Any], None]] = None) -> bool:
        """Add a task; tasks with the same marker run one after the other."""
        added: bool = super().queue_task(marker, task, args, taskCallback)
        self._notify()
        return added

    def remove_marker(self, marker: Any) -> None:
        """Permit the next task with a marker."""
        super().remove_marker(marker)
        self._notify()

    def get_next_task(self) -> Any:
        """Wait for the next task."""
        with self._changed:
            while True:
                found = super().get_next_task()
                if found[1] is not None:
                    return found
                self._changed.wait()

    def _notify(self) -> None:
        with self._changed:
            self._changed.notify_all()


if __name__ == "__main__":
    die_with_parent()
    rosmaster.threadpool.MarkedThreadPool = PromptThreadPool
    rosmaster.rosmaster_main()
