"""The sensing process, seen from the parent."""
from __future__ import annotations

import importlib
import logging
import queue
import socket
import subprocess
import threading
import time
from concurrent.futures import Future
from typing import Any, Callable, Dict, List, Optional, Tuple, Union

from ..child_process import (
    await_end,
    child_command,
    child_environment,
    signal_name,
    signals_blocked,
    wait_or_kill,
)
from ..engine.message_pipe import Wire
from .api import (
    PROBLEM,
    READY,
    CastBatch,
    CastRays,
    Change,
    Pictures,
    RayReturns,
    RenderCamera,
    Request,
    SensingEndedError,
    SensingError,
    SensingUnavailableError,
)
from .scene import SceneState

_log = logging.getLogger(__name__)
_END_S = 3.0  # how long a child may take to end by itself
_START_S = 60.0  # and to start, on a machine that does much else
_MOST_WAITING = 256
_MOST_DEATHS = 3


class _Waiting:
    """A request on its way."""

    def __init__(self, request: Request) -> None:
        self.request = request
        self.future: "Future[Any]" = Future()
        self.since = time.monotonic()


class _Rest:
    """The rest of a message, which the wire keeps."""


class SensingProcess:
    """A child that casts rays or draws, one request after the other.

    All calls return at once and are safe from any thread. Changes and requests take effect in the
    order of the calls. A future of a request fails with a `SensingError`.

    The child process starts with the first request. Separate threads do everything that could
    block, so a child that hangs blocks no caller: it is ended after `patience` s. After a death
    the next request starts another child with the same scene; three deaths in a row without an
    answer, and requests fail at once until the scene changes.

    Args:
        sensors: what it is for, as messages say it.
        patience: s without an answer to a request, once the child has started.
    """

    def __init__(self, sensors: str = "lasers and cameras", patience: float = 60.0) -> None:
        self._sensors = sensors
        self._patience = patience
        self._lock = threading.Lock()
        self._scene = SceneState()  # the writer's, once there is one
        self._outbox: "queue.Queue[Union[None, Change, _Rest, Tuple[int, _Waiting]]]" = \
            queue.Queue()
        self._unsent = 0  # in the outbox, or with the writer
        self._waiting: Dict[int, _Waiting] = {}
        self._numbers = 0
        self._deaths = 0   # while requests waited, in a row
        self._refusal = ""
        self._closing = False
        self._writer: Optional[threading.Thread] = None
        self._reader: Optional[threading.Thread] = None
        self._child: "Optional[subprocess.Popen[bytes]]" = None
        self._wire: Optional[Wire] = None
        self._verdict = ""
        self._listener: Callable[[str], None] = _log.warning

    @property
    def pid(self) -> int:
        """The child's process number; 0 where there is none."""
        child = self._child
        return child.pid if child is not None and child.poll() is None else 0

    def on_problem(self, listener: Callable[[str], None]) -> None:
        """Set who gets one sentence of each death and of each shape or texture left out."""
        self._listener = listener

    def change(self, change: Change) -> None:
        with self._lock:
            self._refusal, self._deaths = "", 0
            if self._writer is None:
                self._scene.apply(change)
            else:
                self._put(change)

    def cast(self, request: CastRays) -> "Future[RayReturns]":
        return self._submit(request)

    def cast_all(self, request: CastBatch) -> "Future[List[Union[RayReturns, SensingError]]]":
        """Rays of several sensors, in one message each way."""
        return self._submit(request)

    def render(self, request: RenderCamera) -> "Future[Pictures]":
        return self._submit(request)

    def _submit(self, request: Request) -> "Future[Any]":
        waiting = _Waiting(request)
        with self._lock:
            fault = self._fault()
            if fault is None:
                self._numbers += 1
                self._waiting[self._numbers] = waiting
                self._send_or_put(self._numbers, waiting)
        if fault is not None:
            waiting.future.set_exception(fault)
        return waiting.future

    def _send_or_put(self, number: int, waiting: _Waiting) -> None:
        """Send a request from this thread if nothing is before it, else through the writer."""
        if self._wire is None or self._unsent:
            self._put((number, waiting))
            if self._writer is None:
                self._writer = threading.Thread(target=self._write, name="sensing requests",
                                                daemon=True)
                self._writer.start()
            return
        try:
            if not self._wire.send_now((number, waiting.request)):
                self._put(_Rest())
        except OSError as fault:
            self._log_lost_wire(fault)

    def _put(self, item: "Union[Change, _Rest, Tuple[int, _Waiting]]") -> None:
        self._unsent += 1
        self._outbox.put(item)

    def _fault(self) -> Optional[SensingError]:
        if self._closing:
            return SensingEndedError("the sensing process is being closed")
        if self._refusal:
            return SensingUnavailableError(self._refusal)
        if len(self._waiting) >= _MOST_WAITING:
            return SensingError(f"{_MOST_WAITING} rays and pictures are waiting already: "
                                "this one is left out")
        return None

    def close(self) -> None:
        with self._lock:
            self._closing = True
            writer, child = self._writer, self._child
        if writer is None:
            return
        self._outbox.put(None)
        self._shut_down_wire()
        if child is not None:
            wait_or_kill(child, _END_S)
        writer.join(_END_S)
        reader = self._reader
        if reader is not None:
            reader.join(_END_S)
        self._fail_all("the sensing process was ended")  # what came before a child was there

    def _shut_down_wire(self) -> None:
        with self._lock:
            wire = self._wire
        if wire is not None:
            wire.shut_down()

    # The writer: keeps the scene, starts children. It lives as long as this object, as it must: the
    # kernel ends a child with the thread that started it.

    def _write(self) -> None:
        while True:
            item = self._outbox.get()
            if item is None:
                break
            if isinstance(item, tuple):
                self._write_request(*item)
            elif isinstance(item, _Rest):
                self._send(Wire.send_held)
            else:
                self._scene.apply(item)
                self._send(Wire.send, (0, item))
            with self._lock:
                self._unsent -= 1
        self._shut_down_wire()

    def _write_request(self, number: int, waiting: _Waiting) -> None:
        with self._lock:
            known = number in self._waiting
        if known and (self._wire is not None or self._start()):
            self._send(Wire.send, (number, waiting.request))

    def _start(self) -> bool:
        reader = self._reader
        if reader is not None:
            reader.join()  # the one before has been buried
        with self._lock:
            if self._closing:
                return False
        try:
            child, wire = self._spawn()
        except OSError as fault:  # no memory, processes or descriptors are left
            self._fail_all(f"the sensing process cannot be started ({fault})")
            return False
        with self._lock:
            self._child, self._wire = child, wire
        self._reader = threading.Thread(target=self._read, args=(child, wire),
                                        name="sensing answers", daemon=True)
        self._reader.start()
        self._send(Wire.send, (0, self._scene.load_command()))
        return True

    def _spawn(self) -> "Tuple[subprocess.Popen[bytes], Wire]":
        """A child, and this end of what it is talked to through. Raises OSError."""
        ours, theirs = socket.socketpair()
        try:
            with signals_blocked():
                child = subprocess.Popen(
                    child_command("sensing", str(theirs.fileno())), pass_fds=[theirs.fileno()],
                    stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, env=child_environment())
        except OSError:
            ours.close()
            raise
        finally:
            theirs.close()
        return child, Wire(ours)

    def _send(self, send: Callable[..., None], *message: object) -> None:
        """Call a method of the wire, if there is one."""
        wire = self._wire
        try:
            if wire is not None:
                send(wire, *message)
        except OSError as fault:
            self._log_lost_wire(fault)

    @staticmethod
    def _log_lost_wire(fault: OSError) -> None:
        # The reader sees the same end, and fails the pending requests.
        _log.debug("the sensing process does not listen: %s", fault)

    # The reader of one child.

    def _read(self, child: "subprocess.Popen[bytes]", wire: Wire) -> None:
        # Answers need it. It is read while the child reads its own, and not after that.
        importlib.import_module("numpy")
        patience = max(_START_S, self._patience)
        while True:
            try:
                messages = wire.receive(min(1.0, self._patience / 4))
            except (EOFError, OSError):
                break
            for number, message in messages:
                self._answer(number, message)
                if number == READY:
                    patience = self._patience
            if not messages and self._overdue(patience):
                self._verdict = (f"the sensing process has not answered for {patience:g} s "
                                 "and was ended")
                child.kill()
        await_end(child, wire)
        self._fail_all(self._verdict or _reason(child.returncode), wire)

    def _answer(self, number: int, message: Any) -> None:
        if number == PROBLEM:
            self._listener(message)
            return
        with self._lock:
            waiting = self._waiting.pop(number, None)
            if waiting is not None:
                self._deaths = 0
            for later in self._waiting.values():
                later.since = time.monotonic()  # it works through them
        if waiting is None:
            return  # the first message, which asks for nothing
        if isinstance(message, SensingError):
            waiting.future.set_exception(message)
        else:
            waiting.future.set_result(message)

    def _overdue(self, patience: float) -> bool:
        with self._lock:
            oldest = min((one.since for one in self._waiting.values()), default=None)
        return oldest is not None and time.monotonic() - oldest > patience

    def _fail_all(self, reason: str, wire: Optional[Wire] = None) -> None:
        """Fail all pending requests; `wire`: of the child that has ended, None if none started."""
        with self._lock:
            self._verdict = ""
            if self._wire is wire:
                self._wire = None
            waiting, self._waiting = self._waiting, {}
            closing = self._closing
            if wire is not None:
                wire.sock.close()
            if waiting:
                self._count_death(reason)
            refusal = self._refusal
        if not closing:
            self._listener(refusal or f"{reason}; physics goes on, and the next ray or picture "
                           "starts another")
        for one in waiting.values():
            one.future.set_exception(SensingEndedError(reason))

    def _count_death(self, reason: str) -> None:
        """Count a death with requests pending; refuse more after too many."""
        self._deaths += 1
        if self._deaths >= _MOST_DEATHS:
            self._refusal = (f"{reason}, the {_MOST_DEATHS}rd time in a row: {self._sensors} stay"
                             " off until the world changes")


def _reason(code: int) -> str:
    if code < 0:
        return f"the sensing process was killed by {signal_name(-code)}"
    return f"the sensing process ended with code {code}"
