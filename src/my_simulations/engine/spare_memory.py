"""Gives back memory that Bullet has filled with zeros and does not use (Linux).

To connect to PyBullet 3.2.7 fills 20 MB of buffers with zeros, which few worlds need. The kernel
takes pages of zeros back and provides them again, as zeros, when they are read or written: so
nothing changes but how much memory a world takes.
"""
from __future__ import annotations

import ctypes
import mmap
from typing import Callable, List, Tuple, TypeVar

import numpy as np

from .. import child_process

Made = TypeVar("Made")
_Range = Tuple[int, int]
_LEAST = 1 << 20
_MADV_DONTNEED = 4


def made_sparingly(make: Callable[[], Made]) -> Made:
    """What `make` makes; whole pages of zeros in the large blocks it allocates are given back.

    Call it while the process has one thread: nobody else may write to these blocks.
    """
    child_process.place_large_blocks_apart(_LEAST)
    before = _anonymous()
    made = make()
    for block in _without(_anonymous(), before):
        if block[1] - block[0] >= _LEAST:
            _give_back(block)
    return made


def _anonymous() -> List[_Range]:
    """The addresses of private memory behind no file, by proc(5), maps; the heap is left out."""
    found = []
    with open("/proc/self/maps", encoding="ascii", errors="replace") as stream:
        for line in stream:
            words = line.split()
            if words[1] == "rw-p" and len(words) == 5:
                first, _, end = words[0].partition("-")
                found.append((int(first, 16), int(end, 16)))
    return found


def _without(ranges: List[_Range], others: List[_Range]) -> List[_Range]:
    """What of `ranges` is in none of `others`; both are sorted, as the kernel lists them."""
    found = []
    for first, end in ranges:
        for low, high in others:
            if low < end and high > first:
                if low > first:
                    found.append((first, low))
                first = min(high, end)
        if first < end:
            found.append((first, end))
    return found


def _give_back(block: _Range) -> None:
    first, end = block
    memory = (ctypes.c_char * (end - first)).from_address(first)
    pages = np.frombuffer(memoryview(memory).cast("B"), np.uint64).reshape(-1, mmap.PAGESIZE // 8)
    used = np.concatenate(([True], np.bitwise_or.reduce(pages, axis=1) != 0, [True]))
    edges = np.flatnonzero(used[1:] != used[:-1]).tolist()
    madvise = ctypes.CDLL(None).madvise
    madvise.argtypes = (ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int)
    for at, until in zip(edges[::2], edges[1::2]):
        madvise(first + at * mmap.PAGESIZE, (until - at) * mmap.PAGESIZE, _MADV_DONTNEED)
