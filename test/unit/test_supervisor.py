"""What the supervisor makes of an engine that does not answer."""
from __future__ import annotations

import threading
import time

import pytest

from my_simulations.engine.commands import Advance, Command, Ping
from my_simulations.engine.inline import InlineEngine
from my_simulations.engine.kinematic import KinematicBackend
from my_simulations.errors import CommandError, NoAnswer
from my_simulations.simulator.supervisor import Supervisor


class _Silent(InlineEngine):
    """Loses the answers to some commands; everything else goes on."""

    lost = Ping

    def submit(self, command: Command):
        answered = super().submit(command)
        return type(answered)() if isinstance(command, self.lost) else answered


class _SlowBackend(KinematicBackend):
    def step(self, first: int, count: int) -> None:
        time.sleep(0.01 * count)
        super().step(first, count)


@pytest.fixture
def watch():
    made = []

    def begin(engine, patience):
        made.append(Supervisor(engine, lambda submit, paused: None, lambda issue: None, patience))
        return made[-1]

    yield begin
    for supervisor in made:
        supervisor.close()


def test_a_command_without_an_answer_is_a_named_error(watch):
    supervisor = watch(lambda: _Silent(KinematicBackend), 0.1)
    with pytest.raises(NoAnswer, match=r"not answered for 0\.1 s; Ping may still"):
        supervisor.call(Ping())
    assert issubclass(NoAnswer, CommandError)
    assert supervisor.call(Advance(3)).step == 3   # the engine is still there


def test_advancing_may_take_longer_than_other_commands(watch):
    supervisor = watch(lambda: InlineEngine(_SlowBackend), 0.05)
    assert supervisor.call(Advance(20)).step == 20


def test_a_restore_without_an_answer_is_told_and_ends_no_thread(watch):
    told, finished = [], threading.Event()

    def restore(submit, paused):
        submit(Ping())

    def log(issue):
        told.append(issue.message)
        if "could not be restored" in issue.message:
            finished.set()

    supervisor = Supervisor(lambda: _Silent(KinematicBackend), restore, log, 0.1)
    try:
        supervisor.engine.kill()
        assert finished.wait(10), told
        with pytest.raises(CommandError, match="could not be restored"):
            supervisor.call(Advance(1))
    finally:
        supervisor.close()
