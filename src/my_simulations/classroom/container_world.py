"""The world of a student in a container, as the tutor's page sees it."""
from __future__ import annotations

import contextlib
import socket
import subprocess
import time
from typing import Optional

from ..errors import CommandError
from .class_plan import ClassPlan, Student
from .containers import Containers
from .world_states import ENDED, STARTING, STOPPED

_MEASURE_S = 5.0
_END_S = 60.0


class ContainerWorld:
    """A container; it exists before this object, and stops with the class.

    Args:
        plan: the class.
        student: whose world it is.
        token: of the editor.

    Attributes:
        state, reason, active, memory_mb, processor_s: as of `LocalWorld`; the processor time is not
            measured.
        listening: None: the container itself listens at the student's port.
        monitor: port of this machine that leads to the editor.
    """

    listening: Optional[socket.socket] = None

    def __init__(self, plan: ClassPlan, student: Student, token: str) -> None:
        self.student = student
        self.token = token
        self.state, self.reason = STOPPED, ""
        self.active = time.monotonic()
        self.monitor = student.port
        self.memory_mb = self.processor_s = 0.0
        self._containers = Containers(plan)
        self._starting: "subprocess.Popen[bytes] | None" = None
        self._measuring: "subprocess.Popen[bytes] | None" = None
        self._measured = float("-inf")

    def start(self) -> None:
        """Start the container; errors become the reason of its end."""
        try:
            self._starting = self._containers.run_program(self.student, "start")
        except CommandError as fault:
            self.state, self.reason = ENDED, str(fault)
            return
        self.state, self.reason, self.active = STARTING, "", time.monotonic()

    @property
    def is_alive(self) -> bool:
        """Whether the container was started and runs."""
        return self.state not in (STOPPED, ENDED)

    def poll(self) -> None:
        """Check whether the container runs; measure its memory every few seconds."""
        if not self.is_alive:
            return
        if self._starting is not None:
            if self._starting.poll() is None:
                return
            starting, self._starting = self._starting, None
            _, said = starting.communicate()
            if starting.returncode:
                lines = said.decode("utf-8", "replace").strip().splitlines()
                self._set_ended(ENDED, lines[-1][:300] if lines else "the container does not start")
                return
        self._measure()

    def _measure(self) -> None:
        if self._measuring is None:
            if time.monotonic() > self._measured + _MEASURE_S:
                self._measured = time.monotonic()
                self._measuring = self._containers.measure(self.student)
            return
        if self._measuring.poll() is None:
            return
        measuring, self._measuring = self._measuring, None
        output, _ = measuring.communicate()
        if measuring.returncode:
            self._set_ended(ENDED, "the container has ended")
            return
        with contextlib.suppress(ValueError):
            self.memory_mb = int(output) / 1e6

    def stop(self, reason: str) -> None:
        """Stop the container; waits for it."""
        if not self.is_alive:
            return
        stopping = self._containers.run_program(self.student, "stop")
        try:
            stopping.communicate(timeout=_END_S)
        except subprocess.TimeoutExpired:
            stopping.kill()
            stopping.communicate()
        self._set_ended(STOPPED, reason)

    def _set_ended(self, state: str, reason: str) -> None:
        """End the programs that watch the container, and store its state."""
        for process in filter(None, (self._starting, self._measuring)):
            process.kill()
            process.communicate()
        self._starting = self._measuring = None
        self.state, self.reason, self.memory_mb = state, reason, 0.0
        self._measured = float("-inf")
