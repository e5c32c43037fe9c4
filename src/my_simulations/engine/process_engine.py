"""The engine in a child process: the parent's side."""
from __future__ import annotations

import logging
import os
import socket
import subprocess
import threading
from collections import OrderedDict, deque
from concurrent.futures import Future
from typing import Callable, Deque, Dict, List, Optional, Tuple

from ..child_process import (
    await_end,
    child_command,
    child_environment,
    signal_name,
    signals_blocked,
    wait_or_kill,
)
from . import ring as ring_module
from .api import MOST_POSTED, EngineDiedError, EngineNotRunningError, Event, Reply
from .commands import (
    Command,
    Ping,
    Post,
    SetJoints,
    SetLinkState,
    SetModelState,
    SetStepBudget,
)
from .message_pipe import Wire
from .ring import RingReader
from .scratch_folder import remove_stale_folders
from .wake_pipe import WakePipe

_log = logging.getLogger(__name__)
_END_S = 3.0  # how long a child may take to end by itself


class ProcessEngine:
    """PyBullet in a child process. The constructor returns at once; commands are queued.

    After its death `restart` starts another child on the same ring; the last complete snapshot
    stays readable until the world was restored.
    """

    def __init__(self) -> None:
        self._ring_fd = ring_module.create()
        self._ring = RingReader(self._ring_fd)
        self._wake_pipe, self._notices = WakePipe(), WakePipe()
        # A sender may block until the child reads, which may wait for the reader thread to take its
        # replies: what that thread needs is never held over a send.
        self._lock = threading.Lock()
        self._send_lock = threading.Lock()  # taken before the other: numbers leave in order
        self._waiting: "OrderedDict[int, Tuple[Command, Future[Reply]]]" = OrderedDict()
        self._posts = PostedCommands(self._ring)
        self._numbers = 0
        self._closing = False
        self._verdict = ""
        self._event_listener: Callable[[Event], None] = lambda event: None
        self._unreported_death: Optional[Tuple[str, List[Command]]] = None
        self._death_listener: Callable[[str, List[Command]], bool] = self._note_death
        self._child: Optional[subprocess.Popen[bytes]] = None
        self._wire: Optional[Wire] = None
        self._reader: Optional[threading.Thread] = None
        remove_stale_folders()  # files left behind when a whole node was killed
        self.restart()

    @property
    def ring(self) -> RingReader:
        return self._ring

    @property
    def pid(self) -> int:
        return self._child.pid if self._child else 0

    @property
    def exit_code(self) -> Optional[int]:
        """How the child ended: -N by signal N, else its exit code; None while it runs."""
        return self._child.poll() if self._child else None

    def on_event(self, listener: Callable[[Event], None]) -> None:
        self._event_listener = listener

    def on_death(self, listener: Callable[[str, List[Command]], bool]) -> None:
        """Set the listener of a child's death, called from its reader thread, once per child.

        It is called at once if a child has already died.
        """
        with self._send_lock:   # held while a death is reported
            self._death_listener = listener
            unreported, self._unreported_death = self._unreported_death, None
        if unreported is not None:
            listener(*unreported)

    def _note_death(self, reason: str, lost: List[Command]) -> bool:
        self._unreported_death = reason, lost
        return False

    def restart(self) -> None:
        """Start a child. Call it from a thread that lives as long as the child.

        The kernel kills the child when the thread that started it ends (PR_SET_PDEATHSIG).
        """
        ours, theirs = socket.socketpair()
        descriptors = (theirs.fileno(), self._ring_fd, self._wake_pipe.input, self._notices.input)
        with self._lock, signals_blocked():
            self._child = subprocess.Popen(
                child_command("engine", *map(str, descriptors)),
                pass_fds=descriptors, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                env=child_environment(),
            )
            self._wire = Wire(ours)
        theirs.close()
        self._reader = threading.Thread(
            target=self._read, args=(self._child, self._wire), name="engine replies", daemon=True)
        self._reader.start()

    def submit(self, command: Command) -> "Future[Reply]":
        future: "Future[Reply]" = Future()
        with self._send_lock:
            with self._lock:
                wire = self._wire
                if wire is None:
                    future.set_exception(
                        EngineNotRunningError("the physics engine is not running"))
                    return future
                self._numbers += 1
                number = self._numbers
                self._waiting[number] = (command, future)
            try:
                wire.send((number, command))
            except OSError as fault:
                # The reader thread sees the same end, and fails this future with the others.
                _log.debug("the engine does not listen: %s", fault)
            except BaseException:   # it cannot be pickled, so nothing was sent
                with self._lock:
                    self._waiting.pop(number, None)
                raise
        return future

    def post(self, command: Command, at_once: bool = True) -> bool:
        with self._send_lock:
            with self._lock:
                wire = self._wire
                if wire is None or self._posts.full():
                    return False
                self._numbers += 1
                number, post = self._numbers, Post(command)
                self._posts.add(number, post)
            message = (number, command.plain() if isinstance(command, SetModelState) else post)
            if not at_once:
                wire.hold(message)
                return True
            try:
                wire.send(message)
            except OSError as fault:
                # The reader thread sees the same end, and reports the command as lost.
                _log.debug("the engine does not listen: %s", fault)
        return True

    def send_posted(self) -> None:
        self._use_wire(Wire.send_held)

    @property
    def posted(self) -> int:
        return self._posts.last

    def notify(self, budget: Optional[int] = None) -> None:
        command = Ping() if budget is None else SetStepBudget(budget)
        self._use_wire(lambda wire: wire.send((0, command)))

    def _use_wire(self, send: Callable[[Wire], None]) -> None:
        with self._send_lock:
            wire = self._wire
            if wire is not None:
                try:
                    send(wire)
                except OSError as fault:
                    _log.debug("the engine does not listen: %s", fault)

    def notify_host(self) -> None:
        self._notices.wake()

    def wait_for_notice(self, timeout: float) -> bool:
        return self._notices.wait(timeout)

    def wait_for_wake(self, timeout: float) -> bool:
        return self._wake_pipe.wait(timeout)

    def kill(self, reason: str = "") -> None:
        """Kill the child; `reason` is reported instead of the signal."""
        if self._child is not None and self._child.poll() is None:
            self._verdict = reason
            self._child.kill()

    def close(self) -> None:
        """Stop the child, wait until it has ended, and close what was shared with it.

        The ring stays readable.
        """
        self._closing = True
        with self._lock:
            wire, self._wire = self._wire, None
        if wire is not None:
            wire.shut_down()
        if self._child is not None:
            wait_or_kill(self._child, _END_S)
        if self._reader is not None and self._reader is not threading.current_thread():
            self._reader.join(_END_S)
        self._close_descriptors()

    def _close_descriptors(self) -> None:
        self._wake_pipe.close()
        self._notices.close()
        if self._ring_fd >= 0:
            os.close(self._ring_fd)
            self._ring_fd = -1

    def _read(self, process: "subprocess.Popen[bytes]", wire: Wire) -> None:
        while True:
            try:
                messages = wire.receive(60.0)
            except (EOFError, OSError):
                break
            for number, message in messages:
                if number < 0:
                    self._event_listener(message)
                    continue
                with self._lock:
                    waiting = self._waiting.pop(number, None)
                if waiting is not None:
                    waiting[1].set_result(message)
        await_end(process, wire)
        remove_stale_folders()  # what a killed child could not take along
        self._reap(process, wire)

    def _reap(self, process: "subprocess.Popen[bytes]", wire: Wire) -> None:
        first, is_suspect = 0, False
        with self._send_lock:   # a sender that finds no engine comes after the listener
            with self._lock:
                if self._wire is wire:
                    self._wire = None
                waiting, self._waiting = self._waiting, OrderedDict()
                lost: Dict[int, Command] = dict(self._posts.take_unapplied())
            wire.sock.close()
            shown = answer_shown(self._ring, waiting)
            reason = self._verdict or _reason(process.returncode)
            self._verdict = ""
            if not self._closing:
                lost.update((number, command) for number, (command, _) in waiting.items())
                first = min(lost, default=0)
                is_suspect = self._death_listener(reason, [lost[key] for key in sorted(lost)])
        for future, reply in shown:
            future.set_result(reply)
        for number, (_, future) in waiting.items():
            future.set_exception(EngineDiedError(reason, is_suspect and number == first))


def answer_shown(ring: RingReader, waiting: "Dict[int, Tuple[Command, Future[Reply]]]"
                 ) -> "List[Tuple[Future[Reply], Reply]]":
    """Remove commands from `waiting` whose effect the last snapshot shows; returns replies.

    An engine may die after it has applied a command and before it has replied. The world is
    restored from that snapshot, so commands that change only states have taken effect and must not
    be repeated. Other changes are not in a snapshot.
    """
    applied, found = ring.applied, []
    for number in [n for n in waiting if n <= applied]:
        command, future = waiting[number]
        if isinstance(command, (SetModelState, SetLinkState, SetJoints)):
            del waiting[number]
            found.append((future, Reply(ring.step, ring.latest)))
    return found


def _reason(code: int) -> str:
    if code < 0:
        return f"the physics engine was killed by {signal_name(-code)}"
    return f"the physics engine ended with code {code}"


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
