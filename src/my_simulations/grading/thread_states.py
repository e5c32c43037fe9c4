"""The states of all threads below a process, read many times a second."""
from __future__ import annotations

import contextlib
import os
from typing import Callable, Dict, Set, Tuple

from . import box

_BYTES = 256   # the state stands behind the name of the thread, which has 15 bytes at most


class ThreadStates:
    """Keeps the files of the states open: to open one takes longer than to read it.

    Args:
        root: process id; its threads and those of all processes below it are read.
        ignored: returns thread ids that do not count.
    """

    def __init__(self, root: int, ignored: Callable[[], Set[int]]) -> None:
        self._root = root
        self._ignored = ignored
        self._files: Dict[Tuple[int, int], int] = {}

    def refresh(self) -> None:
        """Find threads that have started, and forget those that have ended."""
        ignored = self._ignored()
        found: Set[Tuple[int, int]] = set()
        for pid in (self._root, *box.descendants(self._root)):
            with contextlib.suppress(OSError):
                found |= {(pid, int(name)) for name in os.listdir(f"/proc/{pid}/task")
                          if int(name) not in ignored}
        for gone in self._files.keys() - found:
            os.close(self._files.pop(gone))
        for pid, thread in found - self._files.keys():
            with contextlib.suppress(OSError):
                self._files[pid, thread] = os.open(f"/proc/{pid}/task/{thread}/stat", os.O_RDONLY)

    def any_runs(self) -> bool:
        """Whether a known thread runs, can run or waits for a disk."""
        for file in self._files.values():
            with contextlib.suppress(OSError):   # it has ended
                text = os.pread(file, _BYTES, 0)
                at = text.rfind(b")")
                if text[at + 2:at + 3] in (b"R", b"D"):
                    return True
        return False

    def close(self) -> None:
        for file in self._files.values():
            os.close(file)
        self._files.clear()
