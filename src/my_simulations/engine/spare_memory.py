"""Gives back memory that Bullet has filled with zeros and does not use (Linux).

To connect to PyBullet 3.2.7 fills 20 MB of buffers with zeros, which few worlds need. The kernel
takes pages of zeros back and provides them again, as zeros, when they are read or written: so
nothing changes but how much memory a world takes.
"""
from __future__ import annotations

import ctypes
import mmap
from typing import Any, Callable, List, Tuple, TypeVar

import numpy as np

from .. import child_process

Made = TypeVar("Made")
_Range = Tuple[int, int]
_LEAST = 1 << 20
_MADV_DONTNEED = 4
_IS_MMAPPED = 2


def made_without_zero_pages(make: Callable[[], Made]) -> Made:
    """What `make` makes; whole pages of zeros in the large blocks it allocates are given back.

    Call it while the process has one thread: no other thread may write to these blocks. Other
    mappings are left alone, even those that the kernel lists as one range with such a block: Python
    writes to the arenas of its objects at any time.
    """
    child_process.place_large_blocks_apart(_LEAST)
    before = _anonymous()
    made = make()
    for found in _without(_anonymous(), before):
        if found[1] - found[0] >= _LEAST:
            for block in _allocated_in(found):
                _release_zero_pages(block)
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


def _allocated_in(found: _Range) -> List[_Range]:
    """The blocks of the C library in a range of whole pages.

    Before each is a header of two words: zero, and the size with the bit that says that the block
    has a mapping of its own (glibc, malloc/malloc.c, IS_MMAPPED).
    """
    first, end = found
    headers = _pages(found)[:, :2]
    sizes = headers[:, 1] - np.uint64(_IS_MMAPPED)
    begins = (headers[:, 0] == 0) & (sizes % mmap.PAGESIZE == 0) & (sizes >= _LEAST)
    blocks: List[_Range] = []
    for page in np.flatnonzero(begins).tolist():
        at = first + page * mmap.PAGESIZE
        until = at + int(sizes[page])
        # What looks like a header inside of a block is the block's content.
        if until <= end and (not blocks or at >= blocks[-1][1]):
            blocks.append((at, until))
    return blocks


def _pages(block: _Range) -> "np.ndarray[Any, Any]":
    """The memory of a range, a row of 8-byte words for each page."""
    first, end = block
    memory = (ctypes.c_char * (end - first)).from_address(first)
    words: "np.ndarray[Any, Any]" = np.frombuffer(memoryview(memory).cast("B"), np.uint64)
    return words.reshape(-1, mmap.PAGESIZE // 8)


def _release_zero_pages(block: _Range) -> None:
    used = np.concatenate(
        ([True], np.bitwise_or.reduce(_pages(block), axis=1) != 0, [True]))
    edges = np.flatnonzero(used[1:] != used[:-1]).tolist()
    madvise = ctypes.CDLL(None).madvise
    madvise.argtypes = (ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int)
    for at, until in zip(edges[::2], edges[1::2]):
        madvise(block[0] + at * mmap.PAGESIZE, (until - at) * mmap.PAGESIZE, _MADV_DONTNEED)
