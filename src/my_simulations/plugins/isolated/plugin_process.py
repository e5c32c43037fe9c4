"""The process of one plugin, seen from the node: start, messages with a deadline, end."""
from __future__ import annotations

import contextlib
import os
import re
import select
import signal
import socket
import subprocess
import tempfile
import threading
import time
import traceback
from collections import deque
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any, Callable, Deque, List, Optional

from ...child_process import child_command, child_environment, signal_name
from ...engine.message_pipe import Wire
from ..call_watch import CallLimits
from ..context import PluginError
from ..plugin_faults import innermost_of_plugin, shorten
from .messages import TRACE_SIGNAL

_LOOK_S = 0.25      # between two checks of a process that does not answer
_TRACE_S = 1.0      # for the trace to be written
_END_S = 3.0        # for the process to end by itself
_SEND_S = 30.0      # for the process to receive a message
_LONGEST = 1 << 28  # of a message of a plugin, bytes
_SCHEDULED_CLOCK = 2
_FRAME = re.compile(r'^  File "(.*)", line (\d+) in (.*)$', re.MULTILINE)


class ProcessEndedError(PluginError):
    """The process of a plugin has ended, or had to be ended."""


class PluginProcesses:
    """Starts processes, from one thread that lives as long as they do.

    The kernel ends a child with the thread that started it (`die_with_parent`). After the first
    start, one more process than there are plugins is kept ready: the next plugin need not wait for
    its start.
    """

    def __init__(self) -> None:
        self._starter = ThreadPoolExecutor(1, "plugin-processes")
        self._ready: "Optional[Future[PluginProcess]]" = None
        self._started: List[PluginProcess] = []

    def start(self) -> "PluginProcess":
        """A process without a plugin. Raises ProcessEndedError if the system refuses it."""
        ready, self._ready = self._ready or self._starter.submit(PluginProcess), None
        try:
            process = ready.result()
            if not process.is_running:   # it was ended from outside meanwhile
                process.end()
                process = self._starter.submit(PluginProcess).result()
        except OSError as fault:
            raise ProcessEndedError(f"its process cannot be started: {fault}") from fault
        self._ready = self._starter.submit(PluginProcess)
        self._started = [one for one in self._started if one.is_running] + [process]
        return process

    def stop(self) -> None:
        if self._ready is not None and self._ready.exception() is None:
            self._started.append(self._ready.result())
        for process in self._started:
            process.end()
        for process in self._started:
            process.join()
        self._starter.shutdown()


class PluginProcess:
    """One process, and the socket to it; for one thread at a time."""

    def __init__(self) -> None:
        ours, theirs = socket.socketpair()
        self._trace = tempfile.TemporaryFile()
        self._ended = False
        self._received: Deque[Any] = deque()
        self._reaper = threading.Thread(target=self._reap, name="plugin-end", daemon=True)
        handed = (theirs.fileno(), self._trace.fileno())
        with theirs:
            self._child = subprocess.Popen(
                child_command("plugins.isolated", *map(str, handed)), pass_fds=handed,
                stdin=subprocess.DEVNULL, env=child_environment(), start_new_session=True)
        self._wire = Wire(ours, _LONGEST)
        ours.settimeout(_SEND_S)
        self._poll = select.poll()
        self._poll.register(ours, select.POLLIN)

    @property
    def pid(self) -> int:
        """The id of the process and of its group."""
        return self._child.pid

    def send(self, message: object) -> None:
        """Send a message. Raises ProcessEndedError."""
        try:
            self._wire.send(message)
        except socket.timeout:
            self._kill()
            raise ProcessEndedError(
                f"its process received no messages for {_SEND_S:g} s") from None
        except OSError:
            raise self._make_ended_error() from None

    def receive(self, limits: CallLimits, while_waiting: Callable[[float], bool]) -> Any:
        """The next message; waits for it.

        Args:
            limits: how long the process may take.
            while_waiting: called at each look with the time waited, s; returns whether it has
                waited.

        Raises ProcessEndedError if the process has ended, or takes too long and so was ended.
        """
        first_look = time.monotonic() + _LOOK_S
        begun: Optional[float] = None
        look_s = _LOOK_S
        while not self._received:
            if self._poll.poll(1000.0 * look_s):
                self._read()
                if self._received or time.monotonic() < first_look:
                    continue   # else it sends a part of a message now and then
            if begun is None:   # from the first look on, as all calls that are watched
                begun, used_before = time.monotonic(), self._read_processor_time()
            waited = time.monotonic() - begun
            self._check(limits, waited, self._read_processor_time() - used_before)
            look_s = 0.0 if while_waiting(waited) else _LOOK_S
        return self._received.popleft()

    def _read(self) -> None:
        try:
            self._received += self._wire.receive(0.0, rest=0.0)
        except EOFError as fault:
            raise self._make_ended_error(str(fault)) from None

    def end(self) -> None:
        """Have the process end; it is killed with all that it has started if it does not."""
        if not self._ended:
            self._ended = True
            self._wire.shut_down()
            self._reaper.start()

    def join(self) -> None:
        """Wait for the end that `end` began."""
        self._reaper.join()

    @property
    def is_running(self) -> bool:
        """Whether the process runs, or has ended and `end` was not called."""
        return not self._ended and not self._has_ended()

    def _read_processor_time(self) -> float:
        """Processor time of the process, s."""
        try:
            return time.clock_gettime((~self.pid << 3) | _SCHEDULED_CLOCK)
        except OSError:   # it has ended: the socket says so
            return 0.0

    def _check(self, limits: CallLimits, waited: float, used: float) -> None:
        """Raise ProcessEndedError for a call that takes too long."""
        why = ""
        if used > limits.computing:
            why = f"it did not return within {limits.computing:g} s of processor time"
        elif waited > limits.waiting and used < 0.1 * waited:
            why = f"it waited for more than {limits.waiting:g} s"
        if why:
            where = self._where()
            self._kill()
            raise ProcessEndedError(f"{why}{where}")

    def _where(self) -> str:
        """` (in f, file:line)` of the plugin's innermost function; "" if that cannot be read."""
        before = os.fstat(self._trace.fileno()).st_size
        os.kill(self.pid, TRACE_SIGNAL)
        deadline = time.monotonic() + _TRACE_S
        found = previous = ""   # the process writes line by line: wait until its place stays
        while time.monotonic() < deadline and not (found and found == previous):
            time.sleep(0.01)
            previous, found = found, self._read_at(before)
        return found

    def _read_at(self, since: int) -> str:
        """As `_where`, of the trace that begins at `since`, bytes."""
        descriptor = self._trace.fileno()   # its offset is the process's, too: it is not moved
        size = os.fstat(descriptor).st_size
        text = os.pread(descriptor, max(size - since, 0), since).decode("utf-8", "replace")
        frames = [traceback.FrameSummary(file, int(line), function)
                  for file, line, function in reversed(_FRAME.findall(text))]
        if not frames or not text.endswith("\n"):
            return ""
        frame = innermost_of_plugin(frames)
        return f" (in {frame.name}, {frame.filename}:{frame.lineno})"

    def _make_ended_error(self, damage: str = "") -> ProcessEndedError:
        """Why the socket has ended."""
        ended = self._await_end(_TRACE_S)
        self._kill()
        if not ended:
            return ProcessEndedError("its process closed the connection to the simulator"
                                     + (f" ({shorten(damage)})" if damage else ""))
        status = self._child.wait()
        if status < 0:
            hint = "; the memory of the machine may be exhausted" * (status == -signal.SIGKILL)
            return ProcessEndedError(f"its process was ended by {signal_name(-status)}{hint}"
                                     f"{self._read_at(0)}")
        return ProcessEndedError(f"its process ended with exit status {status}{self._read_at(0)}")

    def _kill(self) -> None:
        """Kill the process and all that it has started, unless it was waited for."""
        if self._child.returncode is not None:
            return
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.pid, signal.SIGKILL)

    def _reap(self) -> None:
        self._await_end(_END_S)
        self._kill()
        self._child.wait()
        self._wire.sock.close()
        self._trace.close()

    def _has_ended(self) -> bool:
        """Whether the process has ended; its id is not freed, so that its group can be killed."""
        return self._child.returncode is not None or os.waitid(
            os.P_PID, self.pid, os.WEXITED | os.WNOWAIT | os.WNOHANG) is not None

    def _await_end(self, seconds: float) -> bool:
        """Wait for the end of the process; return whether it has ended."""
        deadline = time.monotonic() + seconds
        while not self._has_ended():
            if time.monotonic() > deadline:
                return False
            time.sleep(0.01)
        return True
