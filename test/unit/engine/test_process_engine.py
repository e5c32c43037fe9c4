"""The parent's side of the engine's connection, without a child."""
from __future__ import annotations

import os
import pickle
import socket
import threading

import pytest
from waiting import until

from my_simulations.engine.api import Reply
from my_simulations.engine.commands import Ping, Post, SetStepBudget
from my_simulations.engine.drive_commands import JointMotor, SetMotors
from my_simulations.engine.message_pipe import Wire
from my_simulations.engine.process_engine import ProcessEngine
from my_simulations.engine.timed_forces import ClearTimedForces

WAIT = 60.0


class Child:
    """Stands for the child process, which the test plays itself."""

    pid = 0
    returncode = 0

    def poll(self):
        return None

    def wait(self, _=None):
        return 0


class Engine(ProcessEngine):
    """With the child's end of the connection in `theirs`."""

    def restart(self):
        ours, theirs = socket.socketpair()
        self.theirs = Wire(theirs)
        self._child, self._wire = Child(), Wire(ours)
        self._reader = threading.Thread(target=self._read, args=(self._child, self._wire),
                                        daemon=True)
        self._reader.start()


@pytest.fixture
def engine():
    made = Engine()
    yield made
    made.theirs.shut_down()
    made.close()


def test_replies_are_taken_while_a_large_command_is_being_sent(engine):
    """The child may read on only after its replies were taken."""
    ping = engine.submit(Ping())
    sending = threading.Thread(
        target=engine.submit, args=(ClearTimedForces(tuple(range(10**9, 10**9 + 10**6))),),
        daemon=True)
    sending.start()
    (number, _), = engine.theirs.receive(WAIT)
    assert engine.theirs.sock.recv(1)  # the second is on its way, and does not fit
    engine.theirs.send((number, Reply(0, 0)))
    assert ping.result(WAIT) == Reply(0, 0)
    assert sending.is_alive()


def test_a_closed_engine_leaves_no_descriptors_and_wakes_the_waiting_thread(engine):
    descriptors = (engine._ring_fd, engine._wake_pipe.input, engine._wake_pipe.output,
                   engine._notices.input)
    waiting = threading.Thread(target=engine.wait_for_wake, args=(WAIT,))
    waiting.start()
    engine.close()
    waiting.join(WAIT / 2)
    assert not waiting.is_alive()
    for descriptor in descriptors:
        with pytest.raises(OSError):
            os.fstat(descriptor)
    assert not engine.wait_for_wake(0.0) and engine.ring.step == 0
    engine.close()


def test_a_command_that_cannot_be_sent_leaves_nothing_behind(engine):
    with pytest.raises((TypeError, AttributeError, pickle.PicklingError)):
        engine.submit(ClearTimedForces((threading.Lock(),)))
    assert not engine._waiting
    future = engine.submit(Ping())
    (number, _), = engine.theirs.receive(WAIT)
    engine.theirs.send((number, Reply(3, 1)))
    assert future.result(WAIT).step == 3


def test_of_several_commands_only_the_first_is_suspected_of_a_death(engine):
    told = []
    engine.on_death(lambda reason, commands: told.append(commands) or True)
    first, second = engine.submit(Ping()), engine.submit(Ping())
    engine.theirs.shut_down()
    assert first.exception(WAIT).is_suspect and not second.exception(WAIT).is_suspect
    assert len(told) == 1 and len(told[0]) == 2
    # A sender that finds no engine comes after the listener.
    assert not engine.submit(Ping()).exception(WAIT).is_suspect


def test_posted_commands_arrive_with_the_budget_that_follows(engine):
    motors = SetMotors((JointMotor(0, 1.0, 5.0),))
    assert engine.post(motors, at_once=False)
    assert engine.theirs.receive(0.0) == []
    engine.notify(7)
    assert engine.theirs.receive(WAIT) == [(1, Post(motors)), (0, SetStepBudget(7))]
    assert engine.post(motors, at_once=False)
    engine.send_posted()
    assert engine.theirs.receive(WAIT) == [(2, Post(motors))]


def test_posted_commands_that_were_not_sent_are_reported_at_a_death(engine):
    told = []
    engine.on_death(lambda reason, commands: told.append(commands) or True)
    motors = SetMotors((JointMotor(0, 1.0, 5.0),))
    assert engine.post(motors, at_once=False)
    engine.theirs.shut_down()
    until(lambda: told)
    assert told == [[Post(motors)]]
