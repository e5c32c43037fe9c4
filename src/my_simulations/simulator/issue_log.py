"""Issues that come before anybody listens."""
from __future__ import annotations

import threading
from collections import deque
from typing import Callable, Deque, List, Optional

from ..errors import Issue

RECENT_ISSUES = 100


class IssueLog:
    """Keeps issues until there is somebody to tell, and the last ones for one who comes later."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._kept: List[Issue] = []
        self._recent: Deque[Issue] = deque(maxlen=RECENT_ISSUES)
        self._sink: Optional[Callable[[Issue], None]] = None
        self._also: Optional[Callable[[Issue], None]] = None

    def __call__(self, issue: Issue) -> None:
        with self._lock:
            sink, also = self._sink, self._also
            self._recent.append(issue)
            if sink is None:
                self._kept.append(issue)
        for hears in (sink, also):
            if hears is not None:
                hears(issue)

    def also(self, sink: Callable[[Issue], None]) -> None:
        """Tell one more, from the last `RECENT_ISSUES` on."""
        with self._lock:
            self._also, recent = sink, list(self._recent)
        for issue in recent:
            sink(issue)

    def open(self, sink: Callable[[Issue], None]) -> None:
        """From now on, and for what was kept, use `sink`."""
        with self._lock:
            self._sink, kept, self._kept = sink, self._kept, []
        for issue in kept:
            sink(issue)
