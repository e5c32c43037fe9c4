"""Sim time: pausing, stepping, and the step limit of the engine."""
from __future__ import annotations

import contextlib
import threading
from typing import Iterator, List, Tuple

from ..engine.commands import (
    FOREVER,
    Advance,
    Command,
    EndAdvance,
    Pause,
    Run,
    SetClock,
)
from ..engine.ring import Clock
from .session import Session


class SimClock:
    """Owns pausing and stepping. Changes take the session's structure lock; reads take none.

    Args:
        session: the running world.
        paused: start paused.
        steps: pause after this many steps from the start; FOREVER for never.
    """

    def __init__(self, session: Session, paused: bool = False, steps: int = FOREVER) -> None:
        self._session = session
        self._paused = paused
        self._manual_stepping = False
        self._loading = False
        self._start_lock = threading.Lock()  # for `_loading`, and `_paused` during a load
        self._steps = steps
        self._step_limit = FOREVER

    @property
    def step(self) -> int:
        """Steps since the start or the last reset of the clock."""
        return self._session.ring.step

    @property
    def sim_ns(self) -> int:
        """Sim time, ns."""
        step, clock = self.now()
        return clock.sim_ns(step)

    def now(self) -> Tuple[int, Clock]:
        """The step count, and the clock that converts it to sim time."""
        return self._session.ring.clock()

    @property
    def running(self) -> bool:
        """Whether the engine makes steps now."""
        return self._session.ring.running

    @property
    def paused(self) -> bool:
        """Whether time was paused on request. Manual stepping does not count as paused."""
        return self._paused

    @property
    def is_stepped_manually(self) -> bool:
        """Whether only `advance` makes steps: the world is paused or stepped manually."""
        return self._paused or self._manual_stepping

    def pause(self) -> int:
        """Pause after the running step; returns the step count.

        An `advance` goes on, as in Gazebo.
        """
        with self._session.structure_lock:
            self._paused = True
            return self._session.call(Pause()).step

    def unpause(self) -> None:
        """Resume, unless the world is stepped manually."""
        self._paused = False
        self._session.before_advance()   # not with the lock, which the host may need
        with self._session.structure_lock:
            for command in self.resume_commands():
                self._session.call(command)

    def choose_while_loading(self, paused: bool) -> bool:
        """Set whether the world that is being loaded starts paused; the engine gets no command.

        Returns False, and changes nothing, if no world is being loaded.
        """
        with self._start_lock:
            if self._loading:
                self._paused = paused
            return self._loading

    def set_manual_stepping(self, manual: bool) -> None:
        """Enable or disable manual stepping, in which only `advance` makes steps."""
        self._manual_stepping = manual
        self._session.before_advance()
        with self._session.structure_lock:
            self._session.call((self.resume_commands() or [Pause()])[0])

    def advance(self, steps: int) -> int:
        """Execute `steps` steps as fast as possible; returns the step count after them.

        It returns early when `end_advance` or another world ends it.
        """
        self._session.before_advance()
        return self._session.call(Advance(steps)).step

    def end_advance(self) -> int:
        """End an `advance` that is under way; returns the step count."""
        return self._session.call(EndAdvance()).step

    def wait_step(self, after_step: int, timeout: float) -> bool:
        """Wait until the step count is not `after_step`, or something else has changed.

        Args:
            after_step: the step count already known.
            timeout: wall seconds.

        Returns:
            False after the timeout.
        """
        if self._session.ring.step != after_step:
            return True
        return self._session.supervisor.engine.wait_for_wake(timeout)

    # -- for the other parts -----------------------------------------------------------------------

    def resume_commands(self) -> List[Command]:
        """Commands that resume stepping; none if paused, stepped manually or loading."""
        is_stopped = self._paused or self._manual_stepping or self._loading
        return [] if is_stopped else [Run(self._step_limit)]

    @contextlib.contextmanager
    def stopped_while_loading(self) -> Iterator[None]:
        """Keep the world, also after a restart of the engine, paused until it is loaded."""
        self._loading = True
        try:
            yield
        finally:
            with self._start_lock:
                self._loading = False

    def pause_after_recovery(self) -> None:
        """Stay paused after a restart of the engine, because stepping crashes it repeatedly."""
        self._paused = True

    def begin(self, start_ns: int, step_size: float) -> None:
        """Set the step at which a limited run pauses, for a world that begins at a sim time."""
        if self._steps != FOREVER:
            self._step_limit = self.start_command(start_ns, step_size).step + self._steps

    @staticmethod
    def start_command(start_ns: int, step_size: float) -> SetClock:
        """The command that sets the clock to a sim time (ns)."""
        return SetClock(round(start_ns * 1e-9 / step_size), start_ns)
