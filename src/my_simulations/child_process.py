"""Child processes with this interpreter and package, which end with their parent."""
from __future__ import annotations

import contextlib
import ctypes
import os
import signal
import subprocess
import sys
from typing import Any, Dict, Iterator, List, Protocol

from .workspace_packages import site_packages

_PR_SET_PDEATHSIG = 1
_END_S = 3.0  # how long a child may take to end by itself
_PARENT = "MY_SIMULATIONS_PARENT"
_M_TRIM_THRESHOLD, _M_MMAP_THRESHOLD = -1, -3  # of mallopt(3)
_KEPT_BYTES, _HEAP_BYTES = 64 << 20, 32 << 20


class Connection(Protocol):
    """What a child and its parent talk through."""

    def shut_down(self) -> None:
        """Close this end."""


def child_command(module: str, *arguments: str) -> List[str]:
    """The command line that runs `module` of this package; use it with `child_environment`."""
    return [sys.executable, "-m", f"my_simulations.{module}", *arguments]


def child_environment() -> Dict[str, str]:
    """The environment in which a child finds this package first.

    Disables threads of linear algebra, which are slower for small matrices, and passes the process
    id of the parent, for `die_with_parent`.
    """
    root = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    paths = [root] + [p for p in os.environ.get("PYTHONPATH", "").split(os.pathsep) if p]
    paths += [folder for folder in site_packages() if folder in sys.path]
    return {"OPENBLAS_NUM_THREADS": "1", **os.environ, "PYTHONPATH": os.pathsep.join(paths),
            _PARENT: str(os.getpid())}


@contextlib.contextmanager
def signals_blocked() -> Iterator[None]:
    """Block SIGINT and SIGTERM in this thread, and in the children that it starts meanwhile.

    A context manager. Ctrl-C is sent to the whole foreground group, and would end a starting
    interpreter with a traceback. Children inherit blocked signals; the parent ends the child.
    """
    before = signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGINT, signal.SIGTERM))
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def await_end(child: "subprocess.Popen[bytes]", wire: Connection) -> None:
    """Wait for the end of a child whose stream has ended; one that lives on is killed."""
    wire.shut_down()
    wait_or_kill(child, _END_S)


def wait_or_kill(child: "subprocess.Popen[Any]", seconds: float) -> None:
    """Wait for the end of a child; kill it if that does not come within `seconds` of wall time."""
    try:
        child.wait(seconds)
    except subprocess.TimeoutExpired:
        child.kill()
        child.wait()


def signal_name(number: int) -> str:
    """Such as SIGKILL; `signal 40` for one without a name, as most real-time signals are."""
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"


def die_with_parent() -> None:
    """In the child: have the kernel kill it with the thread that started it (Linux).

    Exits if the parent has ended already.
    """
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.environ.get(_PARENT, str(os.getppid())) != str(os.getppid()):
        os._exit(1)


def place_large_blocks_apart(size: int) -> None:
    """In the child: have the C library place blocks of `size` bytes or more apart (glibc)."""
    _mallopt(_M_MMAP_THRESHOLD, size)


def keep_freed_memory() -> None:
    """In the child: have the C library keep freed memory (glibc).

    Bullet allocates 5 MB for every new world; if the kernel provides them page by page, a reset
    takes three times as long (measured).
    """
    _mallopt(_M_TRIM_THRESHOLD, _KEPT_BYTES)
    _mallopt(_M_MMAP_THRESHOLD, _HEAP_BYTES)


def _mallopt(option: int, value: int) -> None:
    """Set an option of the C library's allocator; without effect where it has none (glibc only)."""
    libc = ctypes.CDLL(None)
    if hasattr(libc, "mallopt"):
        libc.mallopt(option, value)
