"""Allocation of rows in the tables of the ring."""
from __future__ import annotations

from bisect import bisect
from typing import List, Optional, Tuple


class RowAllocator:
    """Allocates contiguous rows of a table, first fit. Not thread safe: its owner locks.

    Args:
        size: number of rows.
    """

    def __init__(self, size: int) -> None:
        self._free: List[Tuple[int, int]] = [(0, size)]

    def allocate(self, count: int) -> Optional[int]:
        """The first of `count` contiguous free rows; None if there are none."""
        if count == 0:
            return 0
        for n, (start, length) in enumerate(self._free):
            if length >= count:
                rest = (start + count, length - count)
                self._free[n:n + 1] = [rest] if rest[1] else []
                return start
        return None

    def claim(self, start: int, count: int) -> None:
        """Take `count` free rows from `start` on."""
        for n, (first, length) in enumerate(self._free):
            if count and first <= start and start + count <= first + length:
                around = [(first, start - first), (start + count, first + length - start - count)]
                self._free[n:n + 1] = [part for part in around if part[1]]
                return

    def free(self, start: int, count: int) -> None:
        if count == 0:
            return
        free = self._free
        n = bisect(free, (start, count))
        if n < len(free) and start + count == free[n][0]:
            count += free.pop(n)[1]
        if n and sum(free[n - 1]) == start:
            n -= 1
            start, more = free.pop(n)
            count += more
        free.insert(n, (start, count))
