"""Orders accesses to memory that two processes share without a lock.

x86 lets other processes see the stores of a thread in their order, and a thread's loads happen in
theirs; only a load may overtake an earlier store. Other processors (arm64) reorder any two accesses
to different addresses. `fence` keeps all accesses before it from all accesses after it.

Python has no fence, but its locks have: to release a lock is a store-release, to acquire it is a
load-acquire, and a load-acquire does not overtake an earlier store-release (RCsc: Arm Architecture
Reference Manual, B2.3; on x86 both are locked instructions, which are full fences). So everything
before the release of the first `with` happens before everything after the acquisition of the second
one. That the lock belongs to one process does not matter: the order is that of this thread's
accesses.
"""
from __future__ import annotations

import platform
import threading

IS_WEAKLY_ORDERED = platform.machine() not in ("x86_64", "AMD64", "i386", "i686")
"""Whether stores, or loads, of a thread may be reordered among themselves."""


_lock = threading.Lock()


def fence() -> None:
    """Complete all earlier accesses to memory before all later ones; takes about 0.1 us."""
    with _lock:
        pass
    with _lock:
        pass


def keep_order() -> None:
    """Keep earlier loads and stores before later stores, and earlier loads before later loads."""


if IS_WEAKLY_ORDERED:
    keep_order = fence
