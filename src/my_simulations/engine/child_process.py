"""Processes of our own: the interpreter and the package that run here, and the end of both."""
from __future__ import annotations

import contextlib
import ctypes
import os
import signal
import sys
from typing import Dict, Iterator, List

_PR_SET_PDEATHSIG = 1
_PARENT = "MY_SIMULATIONS_PARENT"
_M_TRIM_THRESHOLD, _M_MMAP_THRESHOLD = -1, -3  # of mallopt(3)
_KEPT_BYTES, _HEAP_BYTES = 64 << 20, 32 << 20


def command(module: str, *arguments: str) -> List[str]:
    """The command line of `module` of this package; run it with `environment`."""
    return [sys.executable, "-m", f"my_simulations.{module}", *arguments]


def environment() -> Dict[str, str]:
    """The environment in which another interpreter finds this package first.

    Its matrices are small: threads for them would cost more than they bring. It also says who
    started it, for `die_with_parent`.
    """
    root = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
    paths = [root] + [p for p in os.environ.get("PYTHONPATH", "").split(os.pathsep) if p]
    return {"OPENBLAS_NUM_THREADS": "1", **os.environ, "PYTHONPATH": os.pathsep.join(paths),
            _PARENT: str(os.getpid())}


@contextlib.contextmanager
def shielded() -> Iterator[None]:
    """What this thread starts meanwhile hears neither Ctrl-C nor SIGTERM, from its first moment.

    A Ctrl-C reaches the whole foreground group; while an interpreter starts it would end it with a
    traceback. The blocked signals are inherited, and the parent ends such a child.
    """
    before = signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGINT, signal.SIGTERM))
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def die_with_parent() -> None:
    """In the child: have the kernel end it with the thread that started it (Linux).

    One whose parent has ended while it was still importing ends here.
    """
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.environ.get(_PARENT, str(os.getppid())) != str(os.getppid()):
        os._exit(1)


def keep_freed_memory() -> None:
    """In the child: have the C library hold freed memory for the next who asks (glibc).

    Bullet takes 5 MB for every new world; when they come from the kernel page by page each time, a
    reset takes three times as long (measured).
    """
    libc = ctypes.CDLL(None)
    if hasattr(libc, "mallopt"):
        libc.mallopt(_M_TRIM_THRESHOLD, _KEPT_BYTES)
        libc.mallopt(_M_MMAP_THRESHOLD, _HEAP_BYTES)
