"""Supervises the engine: restarts it after a crash and has the world restored.

Commands without a reply are sent again after a crash. If a command crashes the next engine, too,
it fails: only a command that causes crashes is lost. The same holds for posted commands, whose
senders do not wait: the supervisor sends them again, and reports what fails. `Advance` is not sent
again, because some of its steps were executed. All engines are started from the supervisor's own
thread, because the kernel ends a child with the thread that started it.
"""
from __future__ import annotations

import queue
import threading
import time
from collections import deque
from concurrent.futures import TimeoutError as FutureTimeout
from typing import Callable, Deque, List, NamedTuple, Optional

from ..engine.api import Engine, EngineDiedError, EngineNotRunningError, Reply
from ..engine.commands import Advance, Batch, Command, LoadModel, Ping, Post
from ..engine.ring import HEARTBEAT, PROGRESS
from ..errors import (
    CommandError,
    EngineLostError,
    EngineTimeoutError,
    Issue,
    OutdatedCommandError,
    error,
    warning,
)
from .watchdog import PERIOD_S, Watchdog

_COMMAND_S = 120.0    # time limit of a command (a large mesh takes long)
_RAPID_S = 10.0       # _RAPID_DEATHS crashes in this time: stepping the world crashes the engine
_RAPID_DEATHS = 3
_TRIES = 2            # a command that crashes this many engines is not sent again


class _EngineEnd(NamedTuple):
    """The end of an engine.

    Attributes:
        reason: why it ended.
        is_replaced: it was killed because a change had failed halfway.
        is_during_load: it crashed while it loaded a model.
    """

    reason: str
    is_replaced: bool
    is_during_load: bool


class Supervisor:
    """Sends commands to the engine and restarts it.

    Args:
        engine_factory: makes the engine; called once, in the supervisor's thread.
        restore: called in that thread after each restart with a submit function; restores the
            world. With `paused` True it must leave it paused.
        log: receives issues about crashes.
        timeout: wall seconds that a command may take without progress while the engine responds.
            `Advance` has no limit.
        watchdog: detects an engine that hangs.
    """

    def __init__(self, engine_factory: Callable[[], Engine],
                 restore: Callable[["Callable[[Command], Reply]", bool], None],
                 log: Callable[[Issue], None], timeout: float = _COMMAND_S,
                 watchdog: Optional[Watchdog] = None) -> None:
        self._timeout = timeout
        self._restore = restore
        self._log = log
        self._watchdog = watchdog or Watchdog()
        self._restoring = False
        self.restarts = 0  # how many engines have received the world after a crash
        self._is_replacing = False  # the engine was killed to undo a part of a change
        self._ready = threading.Event()
        self._closing = False
        self._deaths: "queue.Queue[Optional[_EngineEnd]]" = queue.Queue()
        self._lost: Deque[Command] = deque()  # posted commands that no engine has applied
        self._ping_lock = threading.Lock()
        self._visible = 0   # number of the last posted command that snapshots contain
        self._recent: List[float] = []
        self._failure: Optional[str] = None
        self._engine: Optional[Engine] = None
        self._made = threading.Event()
        self._factory = engine_factory
        self._thread = threading.Thread(target=self._watch, name="engine supervisor", daemon=True)
        self._thread.start()

    @property
    def engine(self) -> Engine:
        """The engine; waits until it has been created."""
        if self._engine is None:
            self._made.wait()
        if self._engine is None:
            raise CommandError(self._failure or "cannot start the physics engine")
        return self._engine

    @property
    def is_over(self) -> bool:
        """Whether no command will be carried out any more."""
        return self._closing or self._failure is not None

    def call(self, command: Command) -> Reply:
        """Send a command and wait for the reply.

        Raises:
            CommandError: the engine rejected it, or cannot be started.
            EngineTimeoutError: the engine runs, but did not reply in time.
            EngineLostError: the command crashed the engine.
        """
        deaths: List[str] = []
        while True:
            engine = self.engine
            if not self._ready.wait(self._timeout):
                raise CommandError("the physics engine did not restart within "
                                   f"{self._timeout:g} s")
            if self._failure:
                raise CommandError(self._failure)
            try:
                reply = self._answer(engine, command)
            except EngineDiedError as death:
                if self._closing:
                    raise CommandError("the simulator is shutting down") from death
                deaths += [str(death)] if death.is_suspect else []
                self._ready.wait(self._timeout)
                if isinstance(command, Advance) and not isinstance(death, EngineNotRunningError):
                    raise EngineLostError(
                        f"{death} during this request; the world was restored to "
                        f"its state at step {engine.ring.step}"
                    ) from None
                if len(deaths) >= _TRIES:
                    raise EngineLostError(
                        f"{deaths[-1]} during this request, {_TRIES} times; the world "
                        "was restored to its state before the request"
                    ) from None
                continue
            if reply.is_partial:
                self._replace(engine, reply.error)
            if reply.is_outdated:
                raise OutdatedCommandError(reply.error)
            if reply.error:
                raise CommandError(reply.error)
            return reply

    def post(self, command: Command, at_once: bool = True) -> bool:
        """Send a command without waiting for the reply, if possible; see `Engine.post`.

        `await_posted` waits until snapshots show its effect.
        """
        engine = self._engine
        return engine is not None and self._ready.is_set() and engine.post(command, at_once)

    def await_posted(self) -> None:
        """Wait until snapshots show the effect of all posted commands.

        Do not call it from a thread of the engine or the supervisor. Raises as `call`.
        """
        engine = self._engine
        if engine is None or engine.posted <= self._visible or self.is_over:
            return
        wanted = engine.posted
        with self._ping_lock:  # one ping serves all waiting threads
            if self._visible < wanted:
                number = engine.posted
                if not self._ready.is_set() or engine.ring.applied < number:
                    self.call(Ping())
                self._visible = number

    def close(self) -> None:
        """Stop the engine and the thread."""
        self._closing = True
        self._ready.set()
        self._deaths.put(None)
        if self._thread is not threading.current_thread():
            self._thread.join(10.0)

    def _replace(self, engine: Engine, why: str) -> None:
        """Replace an engine that holds a part of a change; returns when its successor has the world
        before that change. Raises CommandError if there is none in time.
        """
        self._ready.clear()
        self._is_replacing = True
        engine.kill(f"a change failed halfway: {why}")
        if not self._ready.wait(self._timeout):
            raise CommandError(f"{why}; the physics engine did not restart within "
                               f"{self._timeout:g} s")

    # -- the supervisor's thread -----------------------------------------------------------------

    def _watch(self) -> None:
        try:
            self._engine = self._factory()
            self._engine.on_death(self._on_death)
            self._ready.set()
        except OSError as fault:
            self._failure = f"cannot start the physics engine: {fault}"
        self._made.set()
        while self._engine is not None:
            try:
                death = self._deaths.get(timeout=PERIOD_S)
            except queue.Empty:
                self._watch_engine(self._engine)
                continue
            if death is None or self._closing:
                break
            self._restart_engine(death)
        if self._engine is not None:
            self._engine.close()

    def _watch_engine(self, engine: Engine) -> None:
        words = engine.ring.words
        silence = self._watchdog.check(engine.pid, (words[HEARTBEAT], words[PROGRESS]))
        if silence:
            self._log(error("engine-stalled", "the physics engine did not respond for "
                            f"{silence}; restarting it"))
            engine.kill(f"the physics engine hung: no response for {silence}")
            self._watchdog.begin()

    def _on_death(self, reason: str, unanswered: List[Command]) -> bool:
        """Record a crash, before the futures fail; see `Engine.on_death`."""
        if self._closing:
            return False
        self._ready.clear()
        self._lost.extend(one.command for one in unanswered if isinstance(one, Post))
        death = _EngineEnd(reason, self._is_replacing, bool(unanswered) and not self._restoring
                       and _loads_models(unanswered[0]))
        self._is_replacing = False
        self._deaths.put(death)
        return bool(unanswered) and not isinstance(unanswered[0], Post) \
            and not death.is_replaced and not self._restoring

    def _restart_engine(self, death: _EngineEnd) -> None:
        now = time.monotonic()
        self._recent = [at for at in self._recent if now - at < _RAPID_S]
        if not (death.is_replaced or death.is_during_load):  # otherwise the world is not the cause
            self._recent.append(now)
        paused = len(self._recent) >= _RAPID_DEATHS
        if len(self._recent) > 3 * _RAPID_DEATHS:
            self._failure = f"{death.reason} repeatedly; restart the simulator"
            self._log(error("engine-lost", self._failure))
            self._ready.set()
            return
        if death.is_replaced:
            self._log(warning("engine-replaced", f"{death.reason}; the physics engine is replaced "
                              "by one with the world before the change"))
        else:
            self._log(error("engine-died", f"{death.reason}; restarting from the last snapshot"
                            + (", paused because of repeated crashes" if paused else "")))
        assert self._engine is not None
        self._watchdog.begin()
        self._restoring = True
        try:
            self._engine.restart()
            self.restarts += 1
            self._restore(self._submit, paused)
            self._send_lost()
        except EngineDiedError:
            return  # it crashed again: that crash is in the queue
        except (OSError, CommandError) as fault:
            self._failure = f"cannot restore the world after a crash: {fault}"
            self._log(error("engine-lost", self._failure))
        finally:
            self._restoring = False
        self._ready.set()

    def _send_lost(self) -> None:
        """Send the posted commands again that no engine has applied, each of them once."""
        while self._lost:
            command = self._lost.popleft()
            try:
                fault = self._submit(command).error
            except EngineDiedError as death:
                self._log(error("command-refused", f"{death} during {type(command).__name__}, "
                                f"{_TRIES} times; it has no effect"))
                raise
            if fault:
                self._log(error("command-refused", fault))

    def _submit(self, command: Command) -> Reply:
        assert self._engine is not None
        return self._answer(self._engine, command)

    def _answer(self, engine: Engine, command: Command) -> Reply:
        timeout = None if isinstance(command, Advance) else self._timeout
        future = engine.submit(command)
        while True:
            beat, progress = engine.ring.words[HEARTBEAT], engine.ring.words[PROGRESS]
            try:
                return future.result(timeout)
            except FutureTimeout as late:
                words = engine.ring.words
                if words[HEARTBEAT] == beat and words[PROGRESS] != progress:
                    continue  # it is still working through a long batch of commands
                raise EngineTimeoutError(
                    f"the physics engine did not respond for {self._timeout:g} s; "
                    f"{type(command).__name__} may still be executed") from late


def _loads_models(command: Command) -> bool:
    """Whether a command loads models, which is the likeliest cause of a crash."""
    if isinstance(command, Batch):
        return any(map(_loads_models, command.commands))
    return isinstance(command, LoadModel)
