"""Notices of new publishers that the ROS master holds until the judge permits them.

The node /gazebo connects to a new publisher when the master tells it of it. What the program
publishes until then is lost, so the number of lost messages would depend on how busy the machine
is. The notices are therefore held until the program waits.
"""
from __future__ import annotations

import mmap
import os
import threading
from typing import Callable, Tuple

_NONE, _HELD = 0, 1


class HeldNotices:
    """The end of the judge.

    Attributes:
        descriptors: of the memory and the pipe that the master gets.
    """

    def __init__(self) -> None:
        memory = os.memfd_create("held notices")
        os.ftruncate(memory, mmap.PAGESIZE)
        self._memory = mmap.mmap(memory, mmap.PAGESIZE)
        read, self._write = os.pipe()
        self.descriptors: Tuple[int, int] = (memory, read)

    def permit(self) -> bool:
        """Let the master send all that it holds; whether it held something."""
        if self._memory[0] == _NONE:
            return False
        os.write(self._write, b".")
        return True

    def close(self) -> None:
        self._memory.close()
        for descriptor in (*self.descriptors, self._write):
            os.close(descriptor)


class NoticeGate:
    """The end of the master.

    Args:
        memory, pipe: descriptors of the judge.
        send: sends all that is held; called in a thread of its own.
    """

    def __init__(self, memory: int, pipe: int, send: Callable[[], None]) -> None:
        self._memory = mmap.mmap(memory, mmap.PAGESIZE)
        self._pipe, self._send = pipe, send
        threading.Thread(target=self._listen, name="notices", daemon=True).start()

    def hold(self) -> None:
        """Show the judge that something is held."""
        self._memory[0] = _HELD

    def sent(self) -> None:
        """Show the judge that nothing is held."""
        self._memory[0] = _NONE

    def _listen(self) -> None:
        while os.read(self._pipe, mmap.PAGESIZE):   # ends with the judge
            self._send()
