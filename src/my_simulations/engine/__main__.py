"""The engine process: `python -m my_simulations.engine COMMANDS RING WAKE NOTICES`, descriptors."""
from __future__ import annotations

import contextlib
import os
import signal
import socket
import sys
from typing import Iterator, List, Tuple

from ..child_process import die_with_parent, keep_freed_memory
from ..readable import lowest_descriptor
from .api import Event, Reply
from .commands import Command, Post, SetModelState
from .message_pipe import Wire
from .ring import RingWriter
from .runner import Runner
from .wake_pipe import wake


class _Pipes:
    """The channel of a child: a socket for commands, a wake pipe, and a pipe for notices to the
    host.
    """

    def __init__(self, wire: Wire, wake_pipe: int, notices: int) -> None:
        self._wire = wire
        self._wake_pipe, self._notices = wake_pipe, notices

    def receive(self, timeout: float) -> List[Tuple[int, Command]]:
        return [(number, Post(SetModelState.of_plain(message)) if isinstance(message, tuple)
                 else message) for number, message in self._wire.receive(timeout)]

    def reply(self, number: int, reply: Reply) -> None:
        self._send((number, reply))

    def event(self, event: Event) -> None:
        self._send((-1, event))

    def wake_host_thread(self) -> None:
        wake(self._wake_pipe)

    def notify(self) -> None:
        wake(self._notices)

    def _send(self, message: object) -> None:
        try:
            self._wire.send(message)
        except OSError as fault:
            raise EOFError from fault


@contextlib.contextmanager
def _silent_stderr() -> Iterator[None]:
    """PyBullet writes its build time there when it is imported; faults are raised all the same."""
    kept, nothing = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nothing, 2)
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(nothing)


def main(argv: List[str]) -> int:
    """Run the engine until the parent closes the socket or ends."""
    # The parent decides when to stop: Ctrl-C is sent to the whole process group, and must not
    # stop the engine while the parent is saving or responding.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    die_with_parent()
    commands, states, wake_pipe, notices = (int(word) for word in argv[1:5])
    with _silent_stderr():
        from .bullet.backend import BulletBackend
        from .spare_memory import made_without_zero_pages

    backend = made_without_zero_pages(BulletBackend)
    keep_freed_memory()
    wire = Wire(socket.socket(fileno=lowest_descriptor(commands)))
    try:
        Runner(backend, RingWriter(states), _Pipes(wire, wake_pipe, notices)).run()
    finally:
        backend.close()
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv))
