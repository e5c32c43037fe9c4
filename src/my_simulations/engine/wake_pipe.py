"""A pipe that wakes a thread: written by other threads and a child process, read by one."""
from __future__ import annotations

import os
import threading

from ..readable import wait_until_readable


class WakePipe:
    """Several wake-ups before a wait count as one."""

    def __init__(self) -> None:
        self.output, self.input = os.pipe()
        os.set_blocking(self.output, False)
        os.set_blocking(self.input, False)
        self._lock = threading.Lock()

    def wake(self) -> None:
        """Wake the thread that waits, or the next one that will."""
        wake(self.input)

    def wait(self, timeout: float) -> bool:
        """Wait for a wake-up; False after `timeout` s, or once it is closed."""
        with self._lock:   # close() must not take the descriptor away meanwhile
            if self.output < 0 or not wait_until_readable(self.output, timeout):
                return False
            try:
                os.read(self.output, 4096)
            except BlockingIOError:
                return False
            return True

    def close(self) -> None:
        """Wake the thread that waits, and close both ends."""
        if self.output < 0:
            return
        self.wake()
        with self._lock:
            os.close(self.output)
            os.close(self.input)
            self.output = self.input = -1


def wake(descriptor: int) -> None:
    """Wake the thread that waits at the other end."""
    if descriptor < 0:
        return
    try:
        os.write(descriptor, b"\0")
    except BlockingIOError:
        return   # the pipe is full: the thread is awake already
