"""The processes below one, found again only after a process or thread has started."""
from __future__ import annotations

import contextlib
import os
import threading
from typing import List, Optional, Sequence

from . import box

_BYTES = 100


def processor_seconds(pids: Sequence[int]) -> float:
    """Processor time of processes and of their children that have ended, s (proc(5), stat)."""
    ticks = 0
    for pid in pids:
        with contextlib.suppress(OSError, ValueError):   # it has ended
            with open(f"/proc/{pid}/stat", encoding="utf-8", errors="replace") as stat:
                ticks += sum(map(int, stat.read().rpartition(")")[2].split()[11:15]))
    return ticks / os.sysconf("SC_CLK_TCK")


class ProcessList:
    """Lists processes; to list all of `/proc` takes longer than most steps of a world.

    The last process id that was given is in `/proc/loadavg` (proc(5)): while it stays, nothing has
    started. It is that of the own process id namespace, so the rest of the machine does not matter
    in a box. A process that has ended may be listed until the next one starts.

    Args:
        root: process id; it is not listed.
    """

    def __init__(self, root: int) -> None:
        self._root = root
        self._file = os.open("/proc/loadavg", os.O_RDONLY)
        self._last: Optional[bytes] = None
        self._found: List[int] = []
        before = self._last_started()
        probe = threading.Thread(target=int)
        probe.start()
        probe.join()
        self._counts = self._last_started() != before
        """False on kernels that do not give the last process id."""

    def pids(self) -> List[int]:
        """All living processes below the root."""
        if self.is_outdated:
            # Read first: what starts during the search is found by the next one.
            self._last = self._last_started() if self._counts else None
            self._found = box.descendants(self._root)
        return self._found

    @property
    def is_outdated(self) -> bool:
        """Whether a process or thread may have started since the last search."""
        return self._last is None or self._last_started() != self._last

    def close(self) -> None:
        os.close(self._file)

    def _last_started(self) -> bytes:
        return os.pread(self._file, _BYTES, 0).rpartition(b" ")[2]
