"""An engine in a thread of this process, for tests."""
from __future__ import annotations

import queue
import threading
from collections import deque
from concurrent.futures import Future
from typing import Callable, Deque, Dict, List, Optional, Tuple

from kinematic_backend import KinematicBackend

from my_simulations.engine.api import Backend, EngineDiedError, EngineNotRunningError, Event, Reply
from my_simulations.engine.commands import Command, Ping, Post, SetStepBudget
from my_simulations.engine.process_engine import PostedCommands
from my_simulations.engine.ring import Memory, RingReader, RingWriter
from my_simulations.engine.runner import Runner


class _Queues:
    """The channel of a thread."""

    def __init__(self, engine: "InlineEngine") -> None:
        self._engine = engine
        self.commands: "queue.Queue[Tuple[int, Command]]" = queue.Queue()

    def receive(self, timeout: float) -> List[Tuple[int, Command]]:
        found = []
        try:
            found.append(self.commands.get(timeout=timeout) if timeout > 0.0
                         else self.commands.get_nowait())
            while True:
                found.append(self.commands.get_nowait())
        except queue.Empty:
            pass
        if any(number < 0 for number, _ in found):
            raise EOFError
        return found

    def reply(self, number: int, reply: Reply) -> None:
        self._engine.answer(number, reply)

    def event(self, event: Event) -> None:
        self._engine.report(event)

    def wake_host_thread(self) -> None:
        self._engine.rung.set()

    def notify(self) -> None:
        self._engine.notices.set()


class InlineEngine:
    """Runs `backend_factory`'s backend. `kill` drops it and every unanswered command."""

    def __init__(self, backend_factory: Callable[[], Backend] = KinematicBackend) -> None:
        self._factory = backend_factory
        self._memory = Memory(None)
        self._ring = RingReader(memory=self._memory)
        self.rung, self.notices = threading.Event(), threading.Event()
        self._lock, self._send_lock = threading.Lock(), threading.Lock()
        self._waiting: Dict[int, Tuple[Command, Future[Reply]]] = {}
        self._posts = PostedCommands(self._ring)
        self._held: "Deque[Tuple[int, Command]]" = deque()   # posted, for the next message
        self._numbers = 0
        self._on_event: Callable[[Event], None] = lambda event: None
        self._on_death: Callable[[str, List[Command]], bool] = lambda reason, commands: False
        self._alive = False
        self.restart()

    @property
    def ring(self) -> RingReader:
        return self._ring

    @property
    def pid(self) -> int:
        return 0

    def on_event(self, listener: Callable[[Event], None]) -> None:
        self._on_event = listener

    def on_death(self, listener: Callable[[str, List[Command]], bool]) -> None:
        self._on_death = listener

    def restart(self) -> None:
        self.backend = self._factory()
        self._channel = _Queues(self)
        runner = Runner(self.backend, RingWriter(memory=self._memory), self._channel)
        self._thread = threading.Thread(target=runner.run, name="engine", daemon=True)
        self._alive = True
        self._thread.start()

    def submit(self, command: Command) -> "Future[Reply]":
        future: "Future[Reply]" = Future()
        with self._send_lock, self._lock:
            if not self._alive:
                future.set_exception(EngineNotRunningError("the engine is not running"))
                return future
            self._numbers += 1
            self._waiting[self._numbers] = (command, future)
            self._put_held()
            self._channel.commands.put((self._numbers, command))
        return future

    def post(self, command: Command, at_once: bool = True) -> bool:
        with self._lock:
            if not self._alive or self._posts.full():
                return False
            self._numbers += 1
            post = Post(command)
            self._posts.add(self._numbers, post)
            self._held.append((self._numbers, post))
            if at_once:
                self._put_held()
        return True

    @property
    def posted(self) -> int:
        return self._posts.last

    def send_posted(self) -> None:
        with self._lock:
            self._put_held()

    def _put_held(self) -> None:
        while self._held:
            self._channel.commands.put(self._held.popleft())

    def notify(self, budget: Optional[int] = None) -> None:
        self.send_posted()
        self._channel.commands.put((0, Ping() if budget is None else SetStepBudget(budget)))

    def notify_host(self) -> None:
        self.notices.set()

    def wait_for_notice(self, timeout: float) -> bool:
        noticed = self.notices.wait(timeout)
        self.notices.clear()
        return noticed

    def answer(self, number: int, reply: Reply) -> None:
        """Called by the engine: a command is done."""
        with self._lock:
            waiting = self._waiting.pop(number, None)
        if waiting is not None:
            waiting[1].set_result(reply)

    def report(self, event: Event) -> None:
        """Called by the engine: an event occurred."""
        self._on_event(event)

    def wait_for_wake(self, timeout: float) -> bool:
        rung = self.rung.wait(timeout)
        self.rung.clear()
        return rung

    def kill(self, reason: str = "") -> None:
        """Drop the backend and all unanswered commands, as a crash would."""
        reason = reason or "the engine was killed"
        with self._send_lock:   # a sender that finds no engine comes after the listener
            self._stop()
            with self._lock:
                waiting, self._waiting = self._waiting, {}
                lost: Dict[int, Command] = dict(self._posts.take_unapplied())
            lost.update((number, command) for number, (command, _) in waiting.items())
            is_suspect = self._on_death(reason, [lost[number] for number in sorted(lost)])
        for number, (_, future) in waiting.items():
            future.set_exception(EngineDiedError(reason, is_suspect and number == min(lost)))

    def close(self) -> None:
        self._stop()
        self.backend.close()

    def _stop(self) -> None:
        with self._lock:
            self._alive = False
        self._channel.commands.put((-1, Command()))
        self._thread.join()
