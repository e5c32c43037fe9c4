"""Commands that were sent without a reply and whose effect no snapshot shows yet."""
from __future__ import annotations

from collections import deque
from typing import Deque, List, Tuple

from .api import MOST_POSTED
from .commands import Post
from .ring import RingReader


class PostedCommands:
    """The posted commands of one engine. The caller holds a lock.

    Attributes:
        last: number of the last posted command; 0 before the first.
    """

    def __init__(self, ring: RingReader) -> None:
        self._ring = ring
        self._unshown: Deque[Tuple[int, Post]] = deque()
        self.last = 0

    def add(self, number: int, command: Post) -> None:
        """Store a command that is about to be sent with a number."""
        self._unshown.append((number, command))
        self.last = number

    def full(self) -> bool:
        """Whether so many commands wait that another one must wait for its reply."""
        if self._unshown:
            self._drop_applied()
        return len(self._unshown) >= MOST_POSTED

    def take_unapplied(self) -> List[Tuple[int, Post]]:
        """Remove and return the commands, with their numbers, that the last snapshot lacks."""
        self._drop_applied()
        found = list(self._unshown)
        self._unshown.clear()
        return found

    def _drop_applied(self) -> None:
        applied, unshown = self._ring.applied, self._unshown
        while unshown and unshown[0][0] <= applied:
            unshown.popleft()
