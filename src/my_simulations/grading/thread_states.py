"""The states of all threads below a process, read many times a second."""
from __future__ import annotations

import contextlib
import os
from typing import Callable, Dict, Set, Tuple

from .process_list import ProcessList

_BYTES = 256   # the state stands behind the name of the thread, which has 15 bytes at most


class ThreadStates:
    """Keeps the files of the states open: to open one takes longer than to read it.

    Args:
        root: process id; its threads and those of all processes below it are read.
        ignored: returns thread ids that do not count.
    """

    def __init__(self, root: int, ignored: Callable[[], Set[int]]) -> None:
        self._root = root
        self._processes = ProcessList(root)
        self._ignored = ignored
        self._files: Dict[Tuple[int, int], int] = {}
        """By process and thread id."""

    def refresh(self) -> bool:
        """Find threads that have started, and forget those that have ended.

        Returns:
            Whether threads have started since the last call.
        """
        if not self._processes.is_outdated:
            return False
        ignored = self._ignored()
        found: Set[Tuple[int, int]] = set()
        for pid in (self._root, *self._processes.pids()):
            with contextlib.suppress(OSError):
                found |= {(pid, int(name)) for name in os.listdir(f"/proc/{pid}/task")
                          if int(name) not in ignored}
        for gone in self._files.keys() - found:
            os.close(self._files.pop(gone))
        new = found - self._files.keys()
        for pid, thread in new:
            with contextlib.suppress(OSError):
                self._files[pid, thread] = os.open(f"/proc/{pid}/task/{thread}/stat", os.O_RDONLY)
        return bool(new)

    def any_runs(self) -> bool:
        """Whether a known thread runs, can run or waits for a disk."""
        return self._any_is((b"R", b"D"))

    def any_awake(self) -> bool:
        """Whether a known thread runs or sleeps, so that no signal has stopped it yet."""
        return self._any_is((b"R", b"S"))

    def _any_is(self, states: Tuple[bytes, ...]) -> bool:
        for file in self._files.values():
            with contextlib.suppress(OSError):   # it has ended
                text = os.pread(file, _BYTES, 0)
                at = text.rfind(b")")
                if text[at + 2:at + 3] in states:
                    return True
        return False

    def sockets(self) -> Set[str]:
        """The inodes of the sockets of all known processes, as in `/proc/net/tcp`."""
        found: Set[str] = set()
        for pid in {pid for pid, _ in self._files}:
            with contextlib.suppress(OSError):
                for file in os.scandir(f"/proc/{pid}/fd"):
                    with contextlib.suppress(OSError):
                        link = os.readlink(file.path)
                        found |= {link[8:-1]} if link.startswith("socket:[") else set()
        return found

    def close(self) -> None:
        self._processes.close()
        for file in self._files.values():
            os.close(file)
        self._files.clear()
