"""Detects a plugin that does not return from a call, and interrupts its thread.

A call is overdue when its thread has used too much processor time, or has waited even longer
without using any (for example for a lock). Time in which the thread gets no processor does not
count.

First an exception is raised in the thread: it ends a loop in Python, and the thread continues with
its next call. It is not raised while the thread runs code of the simulator, whose locks and tables
it would leave inconsistent. A thread that does not react (in a library or in the kernel) is
abandoned: the host starts another one. An abandoned thread holds no lock of the simulator: plugins
are called without any, and calls from a plugin into the simulator end by themselves, because the
supervisor ends an engine that hangs.
"""
from __future__ import annotations

import contextlib
import ctypes
import os
import sys
import threading
import time
from typing import Any, Callable, NamedTuple, Optional, Tuple

_LOOK_S = 0.25          # between two checks
_GRACE_S = 1.0          # until the exception takes effect
_OWN_PARTS = ("my_simulations.simulator", "my_simulations.engine",
              "my_simulations.plugins.isolated")


class CallOverdue(BaseException):
    """Raised in a thread whose call is overdue; no `except Exception` of a plugin stops it."""


class ThreadAbandoned(BaseException):
    """Raised in a thread that returns from a call after it was abandoned: it must end."""


class CallLimits(NamedTuple):
    """How long a call may take.

    Attributes:
        computing: s of processor time.
        waiting: s of wall time, for a call that does not compute.
    """

    computing: float = 5.0
    waiting: float = 30.0

    def doubled(self) -> "CallLimits":
        """Return the limits of a call that may compute twice as long."""
        return CallLimits(2.0 * self.computing, self.waiting)


CALL_LIMITS = CallLimits()
"""Limits for the plugins of users."""


class _Call:
    """A call that is under way.

    Attributes:
        is_checked: its times count from the first check on, so that the many calls that return
            before it cost nothing.
        interrupted: monotonic time; 0 before.
        abandoned: another thread has taken over.
    """

    def __init__(self, subject: Any, limits: CallLimits) -> None:
        self.subject, self.limits = subject, limits
        self.thread = threading.get_ident()
        self.is_checked = False
        self.interrupted = 0.0
        self.abandoned = False
        self.where = ""
        self.why = ""

    def _read_processor_time(self) -> float:
        return time.clock_gettime(self._clock)

    def overdue(self) -> str:
        """Why the call has taken too long; "" when it has not. For calls that are under way."""
        if not self.is_checked:
            self.is_checked = True
            self._clock = time.pthread_getcpuclockid(self.thread)
            self._computed, self._begun = self._read_processor_time(), time.monotonic()
        used = self._read_processor_time() - self._computed
        if used > self.limits.computing:
            return f"it did not return within {self.limits.computing:g} s of processor time"
        waited = time.monotonic() - self._begun
        if waited > self.limits.waiting and used < 0.1 * waited:
            return f"it waited for more than {self.limits.waiting:g} s"
        return ""


class CallWatch:
    """Watches the calls of one thread at a time.

    Args:
        abandon: called with the subject of a call that cannot be ended, and the reason. Its thread
            will end with `CallOverdue` if it ever returns.
    """

    def __init__(self, abandon: Callable[[Any, str], None]) -> None:
        self._abandon = abandon
        self._lock = threading.Lock()
        self._call: Optional[_Call] = None
        self._stop = threading.Event()
        self._watcher: Optional[threading.Thread] = None

    def stop(self) -> None:
        self._stop.set()

    def run(self, subject: Any, limits: CallLimits, call: Callable[..., Any],
            *arguments: Any) -> None:
        """Make a call. A process that it has forked ends where the call returns or raises.

        Raises:
            CallOverdue: the call had to be ended; its text is the reason.
            ThreadAbandoned: the call has returned, or raised an exception, after its thread
                was abandoned.
        """
        if self._watcher is None:
            self._watcher = threading.Thread(target=self._watch, name="plugin-watch", daemon=True)
            self._watcher.start()
        mine = _Call(subject, limits)
        self._call, process = mine, os.getpid()
        try:
            try:
                call(*arguments)
            finally:
                if os.getpid() != process:   # else a second host would go on beside this one
                    os._exit(1)
                self._finish(mine)
        except CallOverdue:
            with self._lock:
                if self._call is mine:
                    self._call = None
            if mine.abandoned:
                raise ThreadAbandoned(mine.why) from None
            raise CallOverdue(f"{mine.why}{mine.where}") from None

    def run_inside(self, call: Callable[[], None]) -> None:
        """Call a function that may use `run`, inside a call that waits for another process.

        Raises ThreadAbandoned if `call` does.
        """
        with self._lock:
            waiting, self._call = self._call, None
        call()
        with self._lock:
            if waiting is not None:
                waiting.is_checked = False   # the time that `call` has taken does not count
            self._call = waiting

    def _finish(self, mine: _Call) -> None:
        """End the watch of a call that has returned. Raises ThreadAbandoned."""
        if not mine.is_checked:  # a check precedes any interruption: most calls need no lock
            if self._call is mine:
                self._call = None
            return
        with self._lock:
            if self._call is mine:
                self._call = None
            if mine.interrupted:
                _forget_interruptions()  # it has just returned by itself
        if mine.abandoned:
            raise ThreadAbandoned(mine.why)

    def _watch(self) -> None:
        while not self._stop.wait(_LOOK_S):
            with self._lock:
                call = self._call
                if call is None:
                    continue
                if not call.interrupted:
                    self._interrupt(call)
                    continue
                if time.monotonic() - call.interrupted < _GRACE_S:
                    continue
                self._call = None
                call.abandoned = True
            self._abandon(call.subject, call.why + call.where)
            _forget_interruptions()

    def _interrupt(self, call: _Call) -> None:
        why = call.overdue()
        if not why:
            return
        module, where = _innermost(call.thread)
        if module.startswith(_OWN_PARTS):
            return  # it returns from there by itself
        call.why, call.where = why, where
        call.interrupted = time.monotonic()
        _raise_in(call.thread, CallOverdue)


def _innermost(thread: int) -> Tuple[str, str]:
    """The module in which a thread is, and ` (in f, file:line)` of the plugin it came from."""
    frame = sys._current_frames().get(thread)
    if frame is None:
        return "", ""
    modules, at = [], ""
    while frame is not None and frame.f_globals.get("__name__") != __name__:
        name = str(frame.f_globals.get("__name__", ""))
        modules.append(name)
        if not at and not name.startswith(("threading", "my_simulations.plugins.simulated_")):
            at = f" (in {frame.f_code.co_name}, {frame.f_code.co_filename}:{frame.f_lineno})"
        frame = frame.f_back
    return next((name for name in modules if name.startswith(_OWN_PARTS)), ""), at


def _raise_in(thread: int, kind: type) -> None:
    """Raise an exception in another thread, or in this one, once it runs Python again."""
    ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), ctypes.py_object(kind))


class _ForgottenError(BaseException):
    """Raised and caught at once, see `_forget_interruptions`."""


def _forget_interruptions() -> None:
    """Have no exception pending in this thread; one of a thread that waits, it finds later.

    As long as one is pending anywhere, CPython looks for it at each call and jump, and to take one
    back does not end that: calls take up to twice as long, and until 3.11 a function that is traced
    (debuggers, coverage) never begins. Only an exception that arrives ends it.
    """
    with contextlib.suppress(_ForgottenError):
        _raise_in(threading.get_ident(), _ForgottenError)
        while True:
            pass
