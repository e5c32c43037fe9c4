"""Drives a backend: paces it against the wall clock, up to a horizon, commands between steps.

The loop runs where the backend lives. With a rate it steps in real time, and late steps are made
up; without one it steps in bursts. States are written to the ring after each step as long as that
costs little, else for a bounded share of the time, and always before a reply.
"""
from __future__ import annotations

import time
import traceback
from typing import List, NamedTuple, Optional, Sequence, Set, Tuple

from .api import (
    Backend,
    CommandChannel,
    CommandRefusedError,
    EngineBrokenError,
    Event,
    PartiallyAppliedError,
    RemovedError,
    Reply,
)
from .commands import (
    Advance,
    Batch,
    Clear,
    Command,
    EndAdvance,
    Pause,
    PhysicsSettings,
    Ping,
    Post,
    Run,
    SetClock,
    SetPhysics,
)
from .drive_commands import SetMotors
from .host_sync import HostSync
from .motor_ramps import MotorRamps
from .readout_schedule import NOTHING, POSES, STATES, CommandRows, ReadoutSchedule
from .ring import (
    CLOCK_SETS,
    HEARTBEAT,
    LATEST,
    NO_LIMIT,
    PROGRESS,
    STATUS,
    STATUS_PAUSED,
    STATUS_RUNNING,
    WAKE_REQUESTED,
    Clock,
    RingWriter,
    picoseconds,
)
from .timed_forces import AddTimedForces

_BURST_S = 0.0008        # bursts between two looks at the commands
_ADVANCE_BURST_S = 0.004 # the same while the host waits for the end of an advance
_MAX_LAG_S = 0.2        # a world that is later than this has given up the rest
_IDLE_S = 2.0            # heartbeat while paused, or while the next step is far off
_SYNC_S = 0.02           # between two looks at the budget while the host works; it notifies earlier
_SHARE_ON_TIME = 0.25    # of the wall time for read-outs that no reader waits for, if on schedule
_SHARE_LATE = 0.02       # the same while late or unthrottled


class _Answer(NamedTuple):
    """The result of a command, as in `Reply`."""

    number: int
    value: object = None
    error: str = ""
    is_outdated: bool = False


class Runner:
    """The engine's loop."""

    def __init__(self, backend: Backend, writer: RingWriter, channel: CommandChannel) -> None:
        self._backend = backend
        self._writer = writer
        self._words = writer.words
        self._channel = channel
        self._settings = PhysicsSettings()
        self._clock = Clock(0, 0, picoseconds(self._settings.step_size))
        self._step = 0
        self._applied = 0
        self._running = False
        self._horizon = 0
        self._horizon_written = -1
        self._clock_sets = self._words[CLOCK_SETS] + 1  # in a new engine it is another clock
        self._sync = HostSync(writer, backend, channel.notify)
        self._ramps = MotorRamps(backend.read_axes, backend.apply)
        self._limit = NO_LIMIT
        # What the host was notified of: nothing before the clock is set, since the last states must
        # stay readable for a restart.
        self._synchronized = (self._sync.settings, self._step)
        self._shown = (self._clock_sets, self._step)
        self._advance: Optional[Tuple[int, int]] = None  # (command number, last step)
        self._posted: Set[int] = set()  # numbers of commands at hand that have no reply
        self._ended: List[int] = []  # numbers of advances that were ended early, to be answered
        self._due = 0.0
        self._burst = 1
        self._step_cost, self._least_cost = 0.0, 1.0   # s; the latter without other processes' time
        self._readouts, self._rows = ReadoutSchedule(self._words), CommandRows()
        self._backend.configure(self._settings)
        if not self._words[LATEST]:  # a second engine on the ring leaves the last states readable
            self._write(force=True)

    def run(self) -> None:
        """Work until the other side hangs up."""
        try:
            while True:
                self._words[HEARTBEAT] += 1
                if (self._sync.records.next_step <= self._step and not self._sync.record(
                        self._step, self._clock_sets, self._clock)):
                    self._serve(_SYNC_S)   # for the host to make room
                    continue
                self._sync.notify_of_records(at_once=False)
                self._limit = self._sync.step_limit()
                if self._step >= self._limit and self._synchronize():
                    continue
                if self._advance is not None:
                    self._serve(0.0)
                    self._advance_burst()
                elif not self._running or self._step >= self._horizon:
                    self._write_at_horizon()
                    self._sync.notify_of_records()
                    self._serve(_IDLE_S)
                elif self._settings.rate > 0.0:
                    self._paced_step()
                else:
                    self._serve(0.0)
                    if self._running:
                        self._free_burst()
        except EOFError:
            return

    def _synchronize(self) -> bool:
        """Notify the host, once, that the engine waits for it; wait if steps are wanted.

        False while paused: then there is nothing to wait for.
        """
        here = (self._sync.settings, self._step)
        if self._synchronized != here:
            self._synchronized = here
            self._write(force=True)
            self._sync.wait_at(self._step)
        if self._advance is None and not (self._running and self._step < self._horizon):
            return False
        self._serve(_SYNC_S)
        return True

    # -- commands --------------------------------------------------------------------------------

    def _serve(self, timeout: float) -> bool:
        """Apply what has arrived; a snapshot that shows it precedes the replies."""
        received = self._channel.receive(timeout)
        if not received:
            return False
        commands = self._numbered(received)
        if not commands:   # only a notification
            return True
        answers: List[_Answer] = []
        for number, command in commands:
            if isinstance(command, Batch):
                self._show_before(answers)
            try:
                value = self._apply(number, command)
                if not isinstance(command, Advance):
                    answers.append(_Answer(number, value))
            except CommandRefusedError as refusal:
                answers.append(_Answer(number, None, str(refusal),
                                       isinstance(refusal, RemovedError)))
            except PartiallyAppliedError as fault:
                self._await_replacement(number, str(fault))
            except EngineBrokenError:
                raise
            except Exception as fault:  # of the engine's own; how much it has done is unknown
                traceback.print_exc()
                self._await_replacement(number, f"the physics engine failed: {fault!r}")
        if answers or self._ended:   # an advance is answered at its end
            # The tables do not show motors; `applied` can wait for the next snapshot.
            self._answer(answers, not all(
                isinstance(command, Advance)
                or isinstance(command, SetMotors) and number in self._posted
                for number, command in commands))
        return True

    def _show_before(self, answers: List[_Answer]) -> None:
        """Have the newest snapshot show the world as it is now, and answer what led to it.

        A batch that fails halfway is undone by a new engine with the world of that snapshot.
        """
        if answers or self._ended:
            self._answer(answers)
            answers.clear()
        elif self._shown != (self._clock_sets, self._step):
            self._write(force=True)

    def _answer(self, answers: List[_Answer], show: bool = True) -> None:
        """Write, with `show`, a snapshot that shows the effect of commands; then reply to them."""
        # Only what precedes the first refusal counts as applied: one number says it all.
        for answer in answers:
            if answer.error:
                break
            self._applied = answer.number
        # Some commands lower it. A higher one holds after the next reading of commands only: the
        # host may have sent some before it raised the limit.
        self._limit = min(self._limit, self._sync.step_limit())
        sequence = self._write(force=True) if show else self._words[LATEST]
        answers[:0] = [_Answer(number, self._step) for number in self._ended]
        self._ended.clear()
        for number, value, error, is_outdated in answers:
            if number not in self._posted:
                self._channel.reply(number, Reply(self._step, sequence, value, error,
                                                  is_outdated=is_outdated))
            elif error:
                self._channel.event(Event("refused", error))
        self._posted.clear()
        self._report_events()

    def _numbered(self, received: Sequence[Tuple[int, Command]]) -> List[Tuple[int, Command]]:
        """Commands with their numbers; remembers those to which there is no reply.

        Those of number 0, with which the host wakes the engine, are applied at once.
        """
        commands = []
        for number, command in received:
            if number == 0:
                self._sync.apply_own_command(command, self._step, self._clock)
            elif isinstance(command, Post):
                self._posted.add(number)
                commands.append((number, command.command))
            else:
                commands.append((number, command))
        return commands

    def _await_replacement(self, number: int, error: str) -> None:
        """Report a command that changed only a part of the world, and do nothing more.

        No snapshot shows that part. Raises EOFError when the other side hangs up, and
        EngineBrokenError for a command to which there is no reply: it is sent to the next engine.
        """
        if number in self._posted:
            raise EngineBrokenError(error)
        self._channel.reply(number, Reply(self._step, self._words[LATEST], None, error, True))
        while True:
            self._channel.receive(_IDLE_S)

    def _apply(self, number: int, command: Command) -> object:
        self._words[PROGRESS] += 1
        if isinstance(command, Batch):
            return self._apply_batch(number, command)
        if isinstance(command, Run):
            if not self._running:
                self._due = time.perf_counter()
            self._running, self._horizon = True, command.horizon
            return self._step
        if isinstance(command, Pause):
            self._running = False
            return self._step
        if isinstance(command, Advance):
            if self._advance is not None:
                raise CommandRefusedError("another advance is under way")
            self._advance = (number, self._step + max(0, command.steps))
            return None
        if isinstance(command, (EndAdvance, Clear)):
            self._end_advance()
        if (isinstance(command, (EndAdvance, Ping))
                or self._sync.apply_own_command(command, self._step, self._clock)):
            return None
        if isinstance(command, SetPhysics):
            self._configure(command.settings)
            return None
        if isinstance(command, SetClock):
            self._set_clock(command)
            return None
        return self._apply_to_world(command)

    def _apply_to_world(self, command: Command) -> object:
        if isinstance(command, SetMotors):
            self._ramps.set(command, self._step, self._clock)
            return None
        if isinstance(command, AddTimedForces) and command.whole:
            command = AddTimedForces(tuple(force.begun(self._step) for force in command.forces))
        value = self._backend.apply(command)
        self._ramps.note_applied(command)
        self._sync.note_applied(command, self._step)
        return value

    def _apply_batch(self, number: int, batch: Batch) -> List[object]:
        values: List[object] = []
        for command in batch.commands:
            try:
                values.append(self._apply(number, command))
            except CommandRefusedError as refusal:
                if not values:
                    raise
                raise PartiallyAppliedError(str(refusal)) from refusal
        return values

    def _end_advance(self) -> None:
        if self._advance is not None:
            self._ended.append(self._advance[0])
            self._advance = None

    def _set_clock(self, command: SetClock) -> None:
        if self._advance is not None:  # as many steps are left as before, as in Gazebo
            number, last = self._advance
            self._advance = (number, command.step + last - self._step)
        self._step = command.step
        self._clock = Clock(command.step, command.sim_ns, picoseconds(self._settings.step_size))
        self._change_clock()

    def _configure(self, settings: PhysicsSettings) -> None:
        if not 0.0 < settings.step_size <= 10.0:
            raise CommandRefusedError(f"the step size {settings.step_size} s is not in 0 to 10 s")
        if settings.step_size != self._settings.step_size:
            now = self._clock.sim_ns(self._step)
            self._clock = Clock(self._step, now, picoseconds(settings.step_size))
            self._change_clock()
        if settings.rate != self._settings.rate:
            self._due = time.perf_counter()
        self._settings = settings
        self._backend.configure(settings)

    def _change_clock(self) -> None:
        """The clock is another: the host must give a new budget before the next step."""
        self._clock_sets += 1
        self._sync.change_settings(self._step)
        self._sync.records.set_clock(self._step, self._clock)
        self._ramps.set_clock(self._step, self._clock)

    # -- stepping --------------------------------------------------------------------------------

    def _paced_step(self) -> None:
        now = time.perf_counter()
        wait = self._due - now
        if wait > 0.0:
            if self._serve(min(wait, _IDLE_S)):
                return
            now = time.perf_counter()
            if self._due > now:
                return
        elif self._serve(0.0):
            self._rows.serve(self._step_cost, self._serve, lambda: self._running)
            if not self._running:
                return
            now = time.perf_counter()
        if self._step >= self._limit:
            return
        made = self._make_steps(self._count_due_steps(now))
        if not made:   # a record waits for room
            return
        cost = (time.perf_counter() - now) / made
        self._step_cost += 0.1 * (cost - self._step_cost)
        self._least_cost = min(cost, 1.02 * self._least_cost)
        self._due = max(self._due + made / self._settings.rate, now - _MAX_LAG_S)
        self._after_steps(_SHARE_LATE if self._due < time.perf_counter() else _SHARE_ON_TIME)

    def _count_due_steps(self, now: float) -> int:
        """Return how many steps are due, at least 1: several in one call cost much less."""
        late = int((now - self._due) * self._settings.rate)
        return max(1, min(1 + late, int(_BURST_S / self._least_cost),
                          self._horizon - self._step, self._limit - self._step))

    def _make_steps(self, count: int) -> int:
        """Make steps and write the records that are due; returns how many there was room for."""
        self._sync.end_wait()
        self._words[STATUS] = STATUS_RUNNING
        left, records, ramps = count, self._sync.records, self._ramps
        while left > 0 and self._step < records.next_step:
            row = min(left, records.next_step - self._step, ramps.next_step - self._step)
            self._backend.step(self._step, row)
            self._step += row
            left -= row
            if ramps.next_step <= self._step:
                ramps.act(self._step, self._clock)
            if records.next_step <= self._step:
                self._sync.record(self._step, self._clock_sets, self._clock)
        return count - left

    def _free_burst(self) -> None:
        count = min(self._burst, min(self._horizon, self._limit) - self._step)
        if count > 0:
            self._burst_of(count, _BURST_S)
            self._after_steps(_SHARE_LATE)

    def _advance_burst(self) -> None:
        if self._advance is None:
            return
        number, last = self._advance
        count = min(self._burst, min(last, self._limit) - self._step)
        if count > 0:
            self._burst_of(count, _ADVANCE_BURST_S)
        # The host acts at the last step, and that step is recorded, before the answer.
        if (self._step < last or self._step >= self._limit
                or self._sync.records.next_step <= self._step):
            self._after_steps(_SHARE_LATE)
            return
        self._advance = None
        self._sync.notify_of_records()
        sequence = self._write(force=True)
        self._channel.reply(number, Reply(self._step, sequence, self._step))
        self._report_events()

    def _burst_of(self, count: int, duration: float) -> None:
        """Make steps, and choose how many the next burst has, so that it takes `duration` s."""
        started = time.perf_counter()
        made = self._make_steps(count)
        took = time.perf_counter() - started
        if made == self._burst:
            fit = int(count * duration / max(took, 1e-9))
            self._burst = max(1, min(fit, self._burst * 2, 1000))

    # -- snapshots -------------------------------------------------------------------------------

    def _after_steps(self, share: float) -> None:
        """Publish the step; read states out when demanded or when the share of time allows it."""
        self._writer.set_step(self._step)
        now = time.perf_counter()
        wanted = self._readouts.next(now, share)
        if wanted == STATES:
            self._write()
            self._readouts.spend(time.perf_counter() - now)
        elif wanted == POSES:
            if self._backend.read_poses():
                self._writer.write_poses(self._step, self._clock, self._backend.tables()[0])
            else:
                self._writer.mark_unchanged(self._step)
        if wanted != NOTHING:
            self._report_events()
        if self._readouts.is_wake_due(now):
            self._channel.wake_host_thread()

    def _write(self, force: bool = False) -> int:
        """Write a snapshot if anything may have changed; returns the newest one's sequence."""
        moving = self._advance is not None or self._running
        self._words[STATUS] = STATUS_RUNNING if moving else STATUS_PAUSED
        changed = self._backend.read()
        if not (changed or force):
            self._writer.mark_unchanged(self._step)
            return self._words[LATEST]
        links, joints = self._backend.tables()
        sequence = self._writer.write(self._step, self._clock, links, joints, self._applied)
        self._shown = (self._clock_sets, self._step)
        self._words[CLOCK_SETS] = self._clock_sets
        if force and self._words[WAKE_REQUESTED]:
            self._channel.wake_host_thread()
        return sequence

    def _write_at_horizon(self) -> None:
        """Write one snapshot when the horizon is reached."""
        if self._running and self._horizon_written != self._step:
            self._horizon_written = self._step
            self._write(force=True)

    def _report_events(self) -> None:
        for event in self._backend.events():
            self._channel.event(event)
