"""Processes of our own: the interpreter and the package that run here, and the end of both."""
from __future__ import annotations

import ctypes
import os
import signal
import sys
from typing import Dict, List

_PR_SET_PDEATHSIG = 1
_M_TRIM_THRESHOLD, _M_MMAP_THRESHOLD = -1, -3  # of mallopt(3)
_KEPT_BYTES, _HEAP_BYTES = 64 << 20, 32 << 20


def command(module: str, *arguments: str) -> List[str]:
    """The command line of `module` of this package; run it with `environment`."""
    return [sys.executable, "-m", f"my_simulations.{module}", *arguments]


def environment() -> Dict[str, str]:
    """The environment in which another interpreter finds this package first.

    Its matrices are small: threads for them would cost more than they bring.
    """
    root = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
    paths = [root] + [p for p in os.environ.get("PYTHONPATH", "").split(os.pathsep) if p]
    return {"OPENBLAS_NUM_THREADS": "1", **os.environ, "PYTHONPATH": os.pathsep.join(paths)}


def die_with_parent() -> None:
    """In the child: have the kernel end it with the thread that started it (Linux)."""
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)


def keep_freed_memory() -> None:
    """In the child: have the C library hold freed memory for the next who asks (glibc).

    Bullet takes 5 MB for every new world; when they come from the kernel page by page each time, a
    reset takes three times as long (measured).
    """
    libc = ctypes.CDLL(None)
    if hasattr(libc, "mallopt"):
        libc.mallopt(_M_TRIM_THRESHOLD, _KEPT_BYTES)
        libc.mallopt(_M_MMAP_THRESHOLD, _HEAP_BYTES)
