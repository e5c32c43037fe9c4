"""The interface of an engine: commands in, replies out, states in a ring.

`Engine` is implemented by PyBullet in a child process and by backends in a thread (PyBullet or
kinematic). A command is answered when a snapshot with its effect is in the ring.
"""
from __future__ import annotations

from concurrent.futures import Future
from dataclasses import dataclass
from typing import Callable, List, Optional, Protocol, Tuple

from ..errors import SimulationError
from .commands import Command, PhysicsSettings
from .ring import RingReader

MOST_POSTED = 64
"""How many posted commands may wait for a heavy step; the sender of more waits, too."""


@dataclass(frozen=True)
class Reply:
    """The result of a command.

    Attributes:
        step: step count at which it was applied.
        sequence: ring sequence of the first snapshot that shows its effect.
        value: result value of the command.
        error: one sentence if it was rejected; "" otherwise.
        is_partial: whether a rejected command has changed the world already. The engine then waits
            to be replaced; the newest snapshot shows the world before the command.
        is_outdated: whether it was rejected because a model, link or joint had been removed.
    """

    step: int
    sequence: int
    value: object = None
    error: str = ""
    is_partial: bool = False
    is_outdated: bool = False


@dataclass(frozen=True)
class Event:
    """Something the engine reports by itself.

    `kind`: `diverged` (a model's state became non-finite; it was restored to its last finite pose,
    at rest), `refused` (a posted command was rejected) or `log` (a setting is simulated
    approximately).
    """

    kind: str
    message: str
    model_id: int = -1


class Engine(Protocol):
    """Interface of engines for the simulator."""

    @property
    def ring(self) -> RingReader:
        """The ring with the snapshots."""

    def submit(self, command: Command) -> "Future[Reply]":
        """Queue a command. The future fails with `EngineDiedError` if the engine dies before."""

    def post(self, command: Command, at_once: bool = True) -> bool:
        """Queue `SetModelState` or `SetMotors` without a reply, in order with those of `submit`.

        Without `at_once` it is sent with whatever is sent next: one message wakes the engine once.
        False if it was not queued: the engine died, or `MOST_POSTED` posted commands wait already.
        """

    @property
    def posted(self) -> int:
        """Number of the last posted command; snapshots show it if `ring.applied` is not less."""

    def send_posted(self) -> None:
        """Send what was posted and not sent at once."""

    def notify(self, budget: Optional[int] = None) -> None:
        """Wake an engine that waits for the host; `budget` replaces the step budget of the ring.

        The engine has what was posted before it has the budget.
        """

    def notify_host(self) -> None:
        """End a `wait_for_notice`, from any thread."""

    def wait_for_notice(self, timeout: float) -> bool:
        """Wait until the engine waits for the host, records are there, or `notify_host` is called.

        False after `timeout` s. For the host's thread.
        """

    def on_event(self, listener: Callable[[Event], None]) -> None:
        """Set the listener of events, called from the engine's reader thread."""

    def on_death(self, listener: Callable[[str, List[Command]], bool]) -> None:
        """Set the listener of the engine's death; it returns whether the first command is suspect.

        It gets a reason and the commands without a reply in their order, among them each `Post`
        whose effect no snapshot shows. It must not submit commands: `submit` waits for it.
        """

    def wait_for_wake(self, timeout: float) -> bool:
        """Wait for a notification of the engine (if requested, about steps and changes).

        False after `timeout` s.
        """

    def restart(self) -> None:
        """After a death: start an empty engine on the same ring; call from a long-lived thread."""

    def kill(self, reason: str = "") -> None:
        """Kill the engine, as a crash would; `reason` is passed to the listener of `on_death`."""

    @property
    def pid(self) -> int:
        """Process id; 0 if it has no process."""

    def close(self) -> None:
        """Stop the engine and wait until it has ended."""


class EngineDiedError(SimulationError):
    """The engine died before it replied.

    Attributes:
        is_suspect: whether this command may have killed it; see `Engine.on_death`.
    """

    def __init__(self, reason: str, is_suspect: bool = False) -> None:
        super().__init__(reason)
        self.is_suspect = is_suspect


class EngineNotRunningError(EngineDiedError):
    """The command was not sent, because there was no engine."""


class CommandRefusedError(SimulationError):
    """A rejected command; the message is one sentence for the user."""


class RemovedError(CommandRefusedError):
    """A rejected command about a model, link or joint that was removed in the meantime."""


class PartiallyAppliedError(SimulationError):
    """A command failed after it had changed the world; the message is one sentence for the user."""


class EngineBrokenError(SimulationError):
    """The world was lost during a change: this engine ends and is replaced by another one."""


class CommandChannel(Protocol):
    """How commands arrive and replies leave."""

    def receive(self, timeout: float) -> List[Tuple[int, Command]]:
        """Commands with their numbers; waits up to `timeout` s for the first. Raises EOFError."""

    def reply(self, number: int, reply: Reply) -> None:
        """Answer a command."""

    def event(self, event: Event) -> None:
        """Send an event."""

    def wake_host_thread(self) -> None:
        """Wake the thread that waits for the next step."""

    def notify(self) -> None:
        """Wake the host of plugins."""


class Backend(Protocol):
    """Moves the bodies step by step; driven by `engine.runner`."""

    def apply(self, command: Command) -> object:
        """Apply a command that changes the world.

        Raises `CommandRefusedError`, if nothing has changed, or `EngineBrokenError`.
        """

    def configure(self, settings: PhysicsSettings) -> None:
        """Set the settings from the next step on."""

    def step(self, first: int, count: int) -> None:
        """Execute `count` steps; the first one begins at step count `first`."""

    def read(self) -> bool:
        """Update the tables; False if nothing can have changed since the last call."""

    def read_poses(self) -> bool:
        """Update the poses in the link table; twists and joints may be old."""

    def read_rows(self, link_rows: Tuple[int, ...]) -> bytes:
        """The current states of some links as raw doubles, `LINK_WIDTH` each."""

    def read_world(self) -> memoryview:
        """The current states of all links as raw doubles; the next `read` reports changes again."""

    def read_axes(self, joint_rows: Tuple[int, ...]) -> List[float]:
        """Position and rate of some joint axes, one after the other."""

    def tables(self) -> Tuple[memoryview, memoryview]:
        """The used link and joint rows as raw doubles, for the ring."""

    def events(self) -> List[Event]:
        """Events since the last call."""

    def close(self) -> None:
        """Free all resources."""
