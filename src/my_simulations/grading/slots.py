"""Slots in which submissions are graded side by side: each has user ids of its own."""
from __future__ import annotations

import contextlib
import fcntl
import os
from typing import Iterator, List

from ..errors import CommandError

MOST_SLOTS = 999
"""Of all runs of this machine: user ids of a slot are a first id and its number."""

_FOLDER = "/run/my_simulations_grade"


@contextlib.contextmanager
def reserved_slots(count: int, folder: str = _FOLDER) -> Iterator[List[int]]:
    """Reserve numbers of slots, from 0, that no other run of this machine has.

    A limit of processes counts all processes of a user, also those of another run. Locks of a run
    that was killed are free again. Only root changes the user of a submission, so others need no
    locks.

    Args:
        count: number of slots.
        folder: of the locks; created.

    Raises:
        CommandError: the folder cannot be written, or all slots are in use.
    """
    if os.geteuid() != 0:
        yield list(range(count))
        return
    slots: List[int] = []
    with contextlib.ExitStack() as locks:
        try:
            os.makedirs(folder, 0o700, exist_ok=True)
            for slot in range(MOST_SLOTS):
                if len(slots) < count and _lock(os.path.join(folder, str(slot)), locks):
                    slots.append(slot)
        except OSError as fault:
            raise CommandError(f"cannot reserve user ids in {folder}: {fault.strerror}") from None
        if len(slots) < count:
            raise CommandError(f"only {len(slots)} of {count} user ids are free; use --jobs")
        yield slots


def _lock(path: str, locks: contextlib.ExitStack) -> bool:
    """Whether a file could be locked until the stack ends."""
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC, 0o600)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(descriptor)
        return False
    locks.callback(os.close, descriptor)
    return True
