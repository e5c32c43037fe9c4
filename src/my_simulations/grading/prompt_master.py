"""A ROS master that tells nodes of new publishers at once, or when the judge permits it.

    python3 -m my_simulations.grading.prompt_master [--hold MEMORY PIPE] --core -p PORT

The threads of rosmaster look for tasks every 0.1 s of wall time. So the sim time at which the first
command of a program arrives would depend on chance. MEMORY and PIPE are descriptors of
`held_notices`.
"""
from __future__ import annotations

import functools
import sys
import threading
from typing import Any, Callable, List, Optional, Sequence, Tuple

import rosmaster
import rosmaster.threadpool

from ..child_process import die_with_parent
from .held_notices import NoticeGate

_Task = Tuple[Any, Callable[..., Any], Any, Optional[Callable[[Any], None]]]


class PromptThreadPool(rosmaster.threadpool.MarkedThreadPool):   # type: ignore[misc]
    """A pool whose threads wait for tasks in place of looking for them.

    Args:
        threads: their number.
        hold: descriptors of the judge, which permits all tasks; None to run them at once.
    """

    def __init__(self, threads: int, hold: Optional[Tuple[int, int]] = None) -> None:
        self._changed = threading.Condition()
        self._held: List[_Task] = []
        self._gate = None if hold is None else NoticeGate(*hold, self._run_held)
        super().__init__(threads)

    def queue_task(self, marker: Any, task: Callable[..., Any], args: Any = None,
                   taskCallback: Optional[Callable[[Any], None]] = None) -> bool:
        """Add a task; tasks with the same marker run one after the other."""
        if self._gate is not None:
            with self._changed:
                self._held.append((marker, task, args, taskCallback))
                self._gate.hold()
            return True
        added: bool = super().queue_task(marker, task, args, taskCallback)
        self._notify()
        return added

    def _run_held(self) -> None:
        with self._changed:
            for task in self._held:
                super().queue_task(*task)
            self._held.clear()
            if self._gate is not None:
                self._gate.sent()
            self._changed.notify_all()

    def remove_marker(self, marker: Any) -> None:
        """Permit the next task with a marker."""
        super().remove_marker(marker)
        self._notify()

    def get_next_task(self) -> Any:
        with self._changed:
            while True:
                found = super().get_next_task()
                if found[1] is not None:
                    return found
                self._changed.wait()

    def _notify(self) -> None:
        with self._changed:
            self._changed.notify_all()


def main(words: Sequence[str]) -> None:
    """Run the master with the command line `words`, without the name of the program."""
    die_with_parent()
    hold = None
    if words[:1] == ["--hold"]:
        hold, words = (int(words[1]), int(words[2])), words[3:]
    rosmaster.threadpool.MarkedThreadPool = functools.partial(PromptThreadPool, hold=hold)
    rosmaster.rosmaster_main([sys.argv[0], *words])


if __name__ == "__main__":
    main(sys.argv[1:])
