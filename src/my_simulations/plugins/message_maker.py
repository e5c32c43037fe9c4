"""Messages that take long to make: made and published by a thread of their own."""
from __future__ import annotations

import queue
import threading
from typing import Any, Callable, Deque, NamedTuple, Optional, Tuple

from .graph import Topic

_END_S = 2.0


class PendingMessage(NamedTuple):
    """A message to be made; a mark is taken from `unsent` once it has left."""

    make: Callable[[], Any]
    unsent: Deque[None]


_Job = Tuple[Topic, PendingMessage, Callable[[Exception], None]]


class MessageMaker:
    """Makes and publishes, in order. Its thread begins with the first message.

    Args:
        sent: called, in that thread, after each message.
    """

    def __init__(self, sent: Callable[[], None] = lambda: None) -> None:
        self._sent = sent
        self._queue: "queue.Queue[Optional[_Job]]" = queue.Queue()
        self._thread: Optional[threading.Thread] = None

    def put(self, topic: Topic, later: PendingMessage, fail: Callable[[Exception], None]) -> None:
        """Queue a message to make and publish; `fail` gets an exception, in that thread."""
        later.unsent.append(None)
        if self._thread is None:
            self._thread = threading.Thread(target=self._run, name="plugin messages", daemon=True)
            self._thread.start()
        self._queue.put((topic, later, fail))

    def stop(self) -> None:
        if self._thread is not None:
            self._queue.put(None)
            self._thread.join(_END_S)

    def _run(self) -> None:
        while True:
            item = self._queue.get()
            if item is None:
                return
            topic, later, fail = item
            try:
                topic.send(later.make())
            except Exception as fault:  # of a plugin, which is reported and switched off
                fail(fault)
            finally:
                later.unsent.popleft()
                self._sent()
