"""Keeps an engine alive: restarts it after a death and has the world put back.

What had no answer when an engine died is sent again. Where that kills the next one, too, the
command is answered with an error: a death that somebody else caused costs nothing, one that a
command causes costs this command. An advance is not sent again: some of its steps are made. All
engines are started from the supervisor's own thread, because the kernel ends a child with the
thread that started it.
"""
from __future__ import annotations

import queue
import threading
import time
from concurrent.futures import TimeoutError as FutureTimeout
from typing import Callable, List, Optional, Tuple

from ..engine.api import Engine, EngineDiedError, Reply
from ..engine.commands import Advance, Batch, Command, LoadModel
from ..engine.ring import HEARTBEAT, PROGRESS
from ..errors import CommandError, EngineLostError, EngineTimeoutError, Issue, error
from .watchdog import PERIOD_S, Watchdog

_COMMAND_S = 120.0    # how long a command may take (a heavy mesh takes a while)
_RAPID_S = 10.0       # this many seconds, so many deaths: the world itself kills the engine
_RAPID_DEATHS = 3
_TRIES = 2            # what kills so many engines is not sent again


class Supervisor:
    """The only one who talks to the engine.

    Args:
        engine_factory: makes the engine; called once, in the supervisor's thread.
        restore: called in that thread after each restart with a submit function; puts the world
            back. With `paused` True it must leave it paused.
        log: who is told of deaths.
        patience: seconds that a command may take without progress while the engine shows signs of
            life. `Advance` may take for ever.
        watchdog: tells an engine that hangs.
    """

    def __init__(self, engine_factory: Callable[[], Engine],
                 restore: Callable[["Callable[[Command], Reply]", bool], None],
                 log: Callable[[Issue], None], patience: float = _COMMAND_S,
                 watchdog: Optional[Watchdog] = None) -> None:
        self._patience = patience
        self._restore = restore
        self._log = log
        self._watchdog = watchdog or Watchdog()
        self._restoring = False
        self._ready = threading.Event()
        self._closing = False
        self._deaths: "queue.Queue[Optional[Tuple[str, bool]]]" = queue.Queue()
        self._killers: List[Tuple[Command, str]] = []
        self._recent: List[float] = []
        self._failure: Optional[str] = None
        self._engine: Optional[Engine] = None
        self._made = threading.Event()
        self._factory = engine_factory
        self._thread = threading.Thread(target=self._watch, name="engine supervisor", daemon=True)
        self._thread.start()

    @property
    def engine(self) -> Engine:
        """The engine; waits until it has been made."""
        self._made.wait()
        if self._engine is None:
            raise CommandError(self._failure or "the physics engine could not be started")
        return self._engine

    def call(self, command: Command) -> Reply:
        """Have a command carried out and wait for its answer.

        Raises:
            CommandError: refused, or no engine can be had.
            EngineTimeoutError: the engine lives, but did not answer in time.
            EngineLostError: engines died over it.
        """
        deaths: List[str] = []
        while True:
            engine = self.engine
            if not self._ready.wait(self._patience):
                raise CommandError("the physics engine has not come back")
            if self._failure:
                raise CommandError(self._failure)
            try:
                reply = self._answer(engine, command)
            except EngineDiedError:
                deaths += self._await_restart(command)
                if isinstance(command, Advance) and deaths:
                    raise EngineLostError(
                        f"{deaths[0]} over this request; the world was put back as "
                        f"it was at step {engine.ring.step}"
                    ) from None
                if len(deaths) >= _TRIES:
                    raise EngineLostError(
                        f"{deaths[-1]} over this request, {_TRIES} times; the world "
                        "was put back as it was before"
                    ) from None
                continue
            if reply.error:
                raise CommandError(reply.error)
            return reply

    def close(self) -> None:
        """End the engine and the thread."""
        self._closing = True
        self._ready.set()
        self._deaths.put(None)
        if self._thread is not threading.current_thread():
            self._thread.join(10.0)

    def _await_restart(self, command: Command) -> List[str]:
        """Why the engine died, if it was at this command that it did."""
        if self._closing:
            raise CommandError("the simulator is ending")
        for killer, why in list(self._killers):
            if killer is command:
                self._killers.remove((killer, why))
                self._ready.wait(self._patience)
                return [why]
        time.sleep(0.005)  # the supervisor clears `ready` a moment after the future fails
        return []

    # -- the supervisor's thread -----------------------------------------------------------------

    def _watch(self) -> None:
        try:
            self._engine = self._factory()
            self._engine.on_death(self._on_death)
            self._ready.set()
        except OSError as fault:
            self._failure = f"the physics engine could not be started: {fault}"
        self._made.set()
        while self._engine is not None:
            try:
                death = self._deaths.get(timeout=PERIOD_S)
            except queue.Empty:
                self._look_after(self._engine)
                continue
            if death is None or self._closing:
                break
            self._revive(*death)
        if self._engine is not None:
            self._engine.close()

    def _look_after(self, engine: Engine) -> None:
        words = engine.ring.words
        silence = self._watchdog.look(engine.pid, (words[HEARTBEAT], words[PROGRESS]))
        if silence:
            self._log(error("engine-stalled", "the physics engine has shown no sign of life for "
                            f"{silence}; it is started anew"))
            engine.kill(f"the physics engine hung: it showed no sign of life for {silence}")
            self._watchdog.begin()

    def _on_death(self, reason: str, unanswered: List[Command]) -> None:
        """Called from the engine's reader thread, before the futures fail."""
        if self._closing:
            return
        self._ready.clear()
        if unanswered and not self._restoring:
            self._killers.append((unanswered[0], reason))
        self._deaths.put((reason, bool(unanswered) and not self._restoring
                          and _brings_models(unanswered[0])))

    def _revive(self, reason: str, at_a_load: bool) -> None:
        now = time.monotonic()
        self._recent = [at for at in self._recent if now - at < _RAPID_S]
        if not at_a_load:  # else it is not the world's fault
            self._recent.append(now)
        paused = len(self._recent) >= _RAPID_DEATHS
        if len(self._recent) > 3 * _RAPID_DEATHS:
            self._failure = f"{reason} again and again; the simulator must be started anew"
            self._log(error("engine-lost", self._failure))
            self._ready.set()
            return
        self._log(error("engine-died", f"{reason}; a new one continues from the last snapshot"
                        + (", paused, because this is happening again and again" if paused
                           else "")))
        assert self._engine is not None
        self._watchdog.begin()
        self._restoring = True
        try:
            self._engine.restart()
            self._restore(self._submit, paused)
        except EngineDiedError:
            return  # it died again: that death is in the queue
        except (OSError, CommandError) as fault:
            self._failure = f"the physics engine could not be restored: {fault}"
            self._log(error("engine-lost", self._failure))
        finally:
            self._restoring = False
        self._ready.set()

    def _submit(self, command: Command) -> Reply:
        assert self._engine is not None
        return self._answer(self._engine, command)

    def _answer(self, engine: Engine, command: Command) -> Reply:
        patience = None if isinstance(command, Advance) else self._patience
        future = engine.submit(command)
        while True:
            beat, progress = engine.ring.words[HEARTBEAT], engine.ring.words[PROGRESS]
            try:
                return future.result(patience)
            except FutureTimeout as late:
                words = engine.ring.words
                if words[HEARTBEAT] == beat and words[PROGRESS] != progress:
                    continue  # it is still at one long row of commands, and gets on
                raise EngineTimeoutError(
                    f"the physics engine has not answered for {self._patience:g} s; "
                    f"{type(command).__name__} may still be carried out") from late


def _brings_models(command: Command) -> bool:
    """Whether a model comes with a command: then this is the first to be suspected."""
    if isinstance(command, Batch):
        return any(map(_brings_models, command.commands))
    return isinstance(command, LoadModel)
