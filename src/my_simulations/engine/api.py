"""The interface of an engine: commands in, replies out, states in a ring.

Whoever moves the world (PyBullet in a child process, PyBullet in this process, a kinematic fake)
satisfies `Engine`. A command is answered once a snapshot that shows its effect is in the ring.
"""
from __future__ import annotations

from concurrent.futures import Future
from dataclasses import dataclass
from typing import Callable, List, Protocol, Tuple

from ..errors import SimulationError
from .commands import Command, PhysicsSettings
from .ring import RingReader


@dataclass(frozen=True)
class Reply:
    """What came of a command.

    Attributes:
        step: step count at which it was applied.
        sequence: ring sequence of the first snapshot that shows its effect.
        value: the command's own result.
        error: one sentence when it was refused; then nothing has changed.
    """

    step: int
    sequence: int
    value: object = None
    error: str = ""


@dataclass(frozen=True)
class Event:
    """Something the engine reports by itself.

    `kind`: `meeting` (the engine stands at a consumer's credit), `diverged` (a model's state became
    non-finite; it was restored to its last finite pose, at rest) or `log` (a setting is simulated
    approximately).
    """

    kind: str
    message: str
    model_id: int = -1
    step: int = 0


class Engine(Protocol):
    """What the simulator needs of whoever moves the world."""

    @property
    def ring(self) -> RingReader:
        """Where the states are read."""

    def submit(self, command: Command) -> "Future[Reply]":
        """Queue a command. The future fails with `EngineDiedError` when the engine died first."""

    def nudge(self) -> None:
        """Tell an engine that stands at a credit to look whether the credit was raised."""

    def on_event(self, listener: Callable[[Event], None]) -> None:
        """Set who hears of events (called from the engine's reader thread)."""

    def on_death(self, listener: Callable[[str, List[Command]], None]) -> None:
        """Set who hears of the engine's death: a reason, and the commands without an answer."""

    def wait_bell(self, timeout: float) -> bool:
        """Wait until the engine rings (when asked to, for steps and changes).

        False when `timeout` s pass first.
        """

    def restart(self) -> None:
        """After a death: start anew on the same ring, empty; call from a long-lived thread."""

    def kill(self, reason: str = "") -> None:
        """End it at once, as a crash would; `reason` is what `on_death` is told then."""

    @property
    def pid(self) -> int:
        """The process number; 0 where there is none."""

    def close(self) -> None:
        """End it and wait for the end."""


class EngineDiedError(SimulationError):
    """The engine died before it answered."""


class CommandRefusedError(SimulationError):
    """A command that cannot be carried out; the message is one sentence for the user."""


class EngineBrokenError(SimulationError):
    """The world is lost half way through a change: this engine ends, and another takes over."""


class Backend(Protocol):
    """Who moves the bodies, one step at a time; `engine.runner` drives it."""

    def apply(self, command: Command) -> object:
        """Carry out a command that changes the world.

        Raises `CommandRefusedError`, then nothing changed, or `EngineBrokenError`.
        """

    def configure(self, settings: PhysicsSettings) -> None:
        """Use other settings from the next step on."""

    def step(self, first: int, count: int) -> None:
        """Make `count` steps, the first of which begins at step count `first`."""

    def read(self) -> bool:
        """Bring the tables up to date; False when nothing can have changed since the last time."""

    def read_poses(self) -> bool:
        """Bring the poses in the link table up to date; the rest may stay as it was."""

    def tables(self) -> Tuple[memoryview, memoryview]:
        """The used link and joint rows as raw doubles, for the ring."""

    def events(self) -> List[Event]:
        """What has happened since the last call."""

    def close(self) -> None:
        """Give everything back."""
