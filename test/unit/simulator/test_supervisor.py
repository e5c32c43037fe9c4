"""What the supervisor makes of an engine that does not answer."""
from __future__ import annotations

import gc
import threading
import time
import weakref

import pytest
from inline_engine import InlineEngine
from kinematic_backend import KinematicBackend

from my_simulations.engine.commands import Advance, Batch, Command, Ping, SetJoints
from my_simulations.errors import CommandError, EngineTimeoutError
from my_simulations.simulator.supervisor import Supervisor
from my_simulations.simulator.watchdog import Watchdog


class _Silent(InlineEngine):
    """Loses the answers to some commands; everything else goes on."""

    lost = Ping

    def submit(self, command: Command):
        answered = super().submit(command)
        return type(answered)() if isinstance(command, self.lost) else answered


class Big(Command):
    """Stands for a command with a large mesh."""


class Stuck(KinematicBackend):
    """Does not finish the command."""

    goes_on = threading.Event()

    def apply(self, command):
        if isinstance(command, Big):
            self.goes_on.wait(60)
            raise SystemExit   # which ends the thread, as a kill ends a process
        return super().apply(command)


class _SlowBackend(KinematicBackend):
    def step(self, first: int, count: int) -> None:
        time.sleep(0.01 * count)
        super().step(first, count)


@pytest.fixture
def watch():
    made = []

    def begin(engine, timeout):
        made.append(Supervisor(engine, lambda submit, paused: None, lambda issue: None, timeout))
        return made[-1]

    yield begin
    for supervisor in made:
        supervisor.close()


def test_a_command_without_an_answer_is_a_named_error(watch):
    supervisor = watch(_Silent, 0.1)
    with pytest.raises(EngineTimeoutError, match=r"did not respond for 0\.1 s; Ping may still"):
        supervisor.call(Ping())
    assert issubclass(EngineTimeoutError, CommandError)
    assert supervisor.call(Advance(3)).step == 3   # the engine is still there


def test_a_command_that_timed_out_before_a_death_is_not_kept(watch, monkeypatch):
    monkeypatch.setattr(threading, "excepthook", lambda _: None)   # pytest's keeps the frames
    supervisor = watch(lambda: InlineEngine(Stuck), 0.1)
    command = Big()
    kept = weakref.ref(command)
    with pytest.raises(EngineTimeoutError):
        supervisor.call(command)
    killing = threading.Thread(target=supervisor.engine.kill)   # of which the command is suspected
    killing.start()
    Stuck.goes_on.set()
    killing.join(60)
    assert supervisor.call(Ping()).step == 0
    del command
    gc.collect()
    assert kept() is None


def test_advancing_may_take_longer_than_other_commands(watch):
    supervisor = watch(lambda: InlineEngine(_SlowBackend), 0.05)
    assert supervisor.call(Advance(20)).step == 20


def test_a_restore_without_an_answer_is_told_and_ends_no_thread(watch):
    told, finished = [], threading.Event()

    def restore(submit, paused):
        submit(Ping())

    def log(issue):
        told.append(issue.message)
        if "cannot restore" in issue.message:
            finished.set()

    supervisor = Supervisor(_Silent, restore, log, 0.1)
    try:
        supervisor.engine.kill()
        assert finished.wait(60), told
        with pytest.raises(CommandError, match="cannot restore"):
            supervisor.call(Advance(1))
    finally:
        supervisor.close()


class _SlowPings(KinematicBackend):
    """Loads a model in 0.05 s."""

    def apply(self, command):
        time.sleep(0.05)
        return super().apply(command)


def test_a_long_row_of_commands_may_take_longer_than_one_of_them(watch):
    supervisor = watch(lambda: InlineEngine(_SlowPings), 0.2)
    supervisor.call(Batch(tuple(SetJoints(()) for _ in range(20))))


class _Hanging(InlineEngine):
    """Keeps what it was killed for."""

    reasons = ()

    def kill(self, reason=""):
        self.reasons = (*self.reasons, reason)
        super().kill(reason)


class _Impatient(Watchdog):
    """Takes the first engine to hang."""

    def check(self, pid, sign):
        return "a test's time" if self.fresh else ""

    def begin(self):
        self.fresh = not hasattr(self, "fresh")


def test_an_engine_that_hangs_is_replaced_and_the_reason_is_told_not_the_signal():
    told, engines, watchdog = [], [], _Impatient()
    watchdog.begin()

    def made():
        engines.append(_Hanging())
        return engines[-1]

    supervisor = Supervisor(made, lambda submit, paused: None, told.append, watchdog=watchdog)
    try:
        deadline = time.monotonic() + 60
        while len(told) < 2:
            assert time.monotonic() < deadline
            time.sleep(0.01)
        assert [issue.code for issue in told] == ["engine-stalled", "engine-died"]
        assert all("for a test's time" in issue.message for issue in told)
        assert "hung" in told[1].message and "SIGKILL" not in told[1].message
        assert supervisor.call(Advance(1)).step >= 0
    finally:
        supervisor.close()
