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
from typing import Any, Callable, Dict, List, Optional, Set, Tuple, Union

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
_RAYS, _PICTURES = "lasers", "cameras"


class _Waiting:
    """A request on its way."""

    def __init__(self, request: Request) -> None:
        self.request = request
        self.future: "Future[Any]" = Future()
        self.since = time.monotonic()

    @property
    def kind(self) -> str:
        return _PICTURES if isinstance(self.request, RenderCamera) else _RAYS


class SensingProcess:
    """A child that casts rays and draws.

    All calls return at once and are safe from any thread. Changes and requests take effect in the
    order of the calls. A future of a request fails with a `SensingError`.

    The child process starts with the first request. Separate threads do everything that could
    block, so a child that hangs blocks no caller: it is ended after `patience` s. After a death
    the next request starts another child with the same scene; three deaths in a row without an
    answer to rays, or to pictures, and requests of that kind fail at once until the scene changes.

    Args:
        ring_fd: descriptor of the engine's ring; -1 where all requests bring their rows.
        patience: s without an answer to a request, once the child has started.
    """

    def __init__(self, ring_fd: int = -1, patience: float = 60.0) -> None:
        self._ring_fd = ring_fd
        self._patience = patience
        self._lock = threading.Lock()
        self._scene = SceneState()  # the writer's, once there is one
        self._outbox: "queue.Queue[Union[None, Change, Tuple[int, _Waiting]]]" = queue.Queue()
        self._waiting: Dict[int, _Waiting] = {}
        self._numbers = 0
        self._deaths = {_RAYS: 0, _PICTURES: 0}   # while such requests waited, in a row
        self._refusals: Dict[str, str] = {}
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
            self._refusals.clear()
            self._deaths = dict.fromkeys(self._deaths, 0)
            if self._writer is None:
                self._scene.apply(change)
            else:
                self._outbox.put(change)

    def cast(self, request: CastRays) -> "Future[RayReturns]":
        return self._submit(request)

    def cast_all(self, request: CastBatch) -> "Future[List[Union[RayReturns, SensingError]]]":
        """Rays of several sensors, in one message each way."""
        return self._submit(request)

    def render(self, request: RenderCamera) -> "Future[Pictures]":
        """Pictures; rays do not wait for them."""
        return self._submit(request)

    def _submit(self, request: Request) -> "Future[Any]":
        waiting = _Waiting(request)
        with self._lock:
            fault = self._fault(waiting.kind)
            if fault is None:
                self._numbers += 1
                self._waiting[self._numbers] = waiting
                self._outbox.put((self._numbers, waiting))
                if self._writer is None:
                    self._writer = threading.Thread(target=self._write, name="sensing requests",
                                                    daemon=True)
                    self._writer.start()
        if fault is not None:
            waiting.future.set_exception(fault)
        return waiting.future

    def _fault(self, kind: str) -> Optional[SensingError]:
        if self._closing:
            return SensingEndedError("the sensing process is being closed")
        if kind in self._refusals:
            return SensingUnavailableError(self._refusals[kind])
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
            if not isinstance(item, tuple):
                self._scene.apply(item)
                if self._wire is not None:
                    self._send((0, item))
                continue
            number, waiting = item
            with self._lock:
                known = number in self._waiting
            if known:
                if self._wire is None and not self._start():
                    continue
                self._send((number, waiting.request))
        self._shut_down_wire()

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
        self._send((0, self._scene.load_command()))
        return True

    def _spawn(self) -> "Tuple[subprocess.Popen[bytes], Wire]":
        """A child, and this end of what it is talked to through. Raises OSError."""
        ours, theirs = socket.socketpair()
        inherited = [theirs.fileno()] + ([self._ring_fd] if self._ring_fd >= 0 else [])
        arguments = [str(theirs.fileno()), str(self._ring_fd)]
        try:
            with signals_blocked():
                child = subprocess.Popen(
                    child_command("sensing", *arguments), pass_fds=inherited,
                    stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, env=child_environment())
        except OSError:
            ours.close()
            raise
        finally:
            theirs.close()
        return child, Wire(ours)

    def _send(self, message: object) -> None:
        wire = self._wire
        try:
            if wire is not None:
                wire.send(message)
        except OSError as fault:
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
                self._deaths[waiting.kind] = 0
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
            given_up = self._count_death(reason, {one.kind for one in waiting.values()})
        if not closing:
            self._listener(given_up or f"{reason}; physics goes on, and the next ray or picture "
                           "starts another")
        for one in waiting.values():
            one.future.set_exception(SensingEndedError(reason))

    def _count_death(self, reason: str, kinds: Set[str]) -> str:
        """Count a death with such requests pending; returns the message if a kind is given up."""
        for kind in kinds:
            self._deaths[kind] += 1
        ended = sorted(kind for kind in kinds if self._deaths[kind] >= _MOST_DEATHS)
        text = (f"{reason}, the {_MOST_DEATHS}rd time in a row: {' and '.join(ended)} stay off "
                "until the world changes")
        self._refusals.update((kind, text) for kind in ended)
        return text if ended else ""


def _reason(code: int) -> str:
    if code < 0:
        return f"the sensing process was killed by {signal_name(-code)}"
    return f"the sensing process ended with code {code}"
