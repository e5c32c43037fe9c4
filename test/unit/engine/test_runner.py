"""Pacing, horizon and commands between steps, on a backend without physics."""
from __future__ import annotations

import threading
import time
from types import SimpleNamespace

import pytest
from inline_engine import InlineEngine
from kinematic_backend import KinematicBackend
from waiting import until

from my_simulations.description.model import Inertial, Link, Model
from my_simulations.engine import runner
from my_simulations.engine.commands import (
    FOREVER,
    Advance,
    Batch,
    Clear,
    EndAdvance,
    LoadModel,
    Pause,
    PhysicsSettings,
    Ping,
    RemoveModel,
    Run,
    SetClock,
    SetModelState,
    SetPhysics,
)
from my_simulations.engine.drive_commands import JointMotor, SetMotors
from my_simulations.engine.ring import (
    DEMAND_NS,
    HEARTBEAT,
    LATEST_POSES,
    POSE_DEMAND_NS,
    SETTINGS,
    STEP_BUDGET,
    budget_word,
)
from my_simulations.geometry import Pose, Twist
from my_simulations.simulator.watchdog import _STALL_S

WAIT = 60.0


class Slow(KinematicBackend):
    """A world whose states take long to read, and its poses do not."""

    def read(self):
        until = time.perf_counter() + 0.004
        while time.perf_counter() < until:
            pass
        return super().read()


class Timed(KinematicBackend):
    """A world whose steps take 0.1 ms of a clock that does not run otherwise."""

    def __init__(self):
        super().__init__()
        self.now = 1000.0
        self.bursts = []

    def step(self, first, count):
        super().step(first, count)
        self.now += 1e-4 * count
        self.bursts.append(count)


@pytest.fixture
def engine():
    made = InlineEngine()
    yield made
    made.close()


def ask(engine, command):
    return engine.submit(command).result(WAIT)


def probe(name="m"):
    return Model(name, links=[Link("link", inertial=Inertial())])


def load(engine, number=1, row=0, twist=None):
    assert not ask(engine, LoadModel(number, probe(f"m{number}"), Pose(), row, 0)).error
    if twist is not None:
        ask(engine, SetModelState(number, Pose(), twist))


def test_a_world_stands_still_until_it_is_run(engine):
    assert engine.ring.step == 0 and not engine.ring.running
    ask(engine, Run())
    until(lambda: engine.ring.step > 5)
    assert engine.ring.running


def test_it_stops_exactly_at_the_horizon_and_shows_it_in_a_snapshot(engine):
    ask(engine, SetPhysics(PhysicsSettings(rate=0.0)))
    for horizon in (1234, 2000):
        ask(engine, Run(horizon))
        until(lambda horizon=horizon: engine.ring.read().step >= horizon)
        assert engine.ring.read().step == engine.ring.step == horizon
        assert ask(engine, Ping()).step == horizon


@pytest.mark.parametrize("rate", [1e-3, 5e-324])
def test_between_the_steps_of_a_slow_rate_it_gives_signs_of_life(engine, rate):
    waits = []
    receive = engine._channel.receive

    def noting(timeout):
        waits.append(timeout)
        return receive(min(timeout, 0.01))

    engine._channel.receive = noting
    ask(engine, SetPhysics(PhysicsSettings(rate=rate)))
    ask(engine, Run())
    until(lambda: engine.ring.step == 1)
    beat = engine.ring.words[HEARTBEAT]
    until(lambda: engine.ring.words[HEARTBEAT] > beat + 1)
    assert 0.0 < max(waits) < _STALL_S / 2
    assert engine.ring.step == 1


def test_a_pause_stops_after_the_running_step_and_is_shown_in_the_ring(engine):
    ask(engine, Run())
    until(lambda: engine.ring.step > 3)
    reply = ask(engine, Pause())
    assert engine.ring.step == reply.step and not engine.ring.running
    assert ask(engine, Ping()).step == reply.step


def test_an_advance_makes_exactly_its_steps_also_while_paused(engine):
    load(engine, twist=Twist((1.0, 0, 0)))
    assert ask(engine, Advance(1000)).step == 1000
    assert engine.ring.step == 1000
    assert engine.ring.link(0)[0].position[0] == pytest.approx(1.0)


class Stopping(KinematicBackend):
    """A world that stops in a step until it is let go, for the test to act meanwhile."""

    def __init__(self):
        super().__init__()
        self.at, self.stopped, self.go = -1, threading.Event(), threading.Event()

    def step(self, first, count):
        if first <= self.at < first + count:
            self.stopped.set()
            assert self.go.wait(WAIT)
        super().step(first, count)


@pytest.fixture
def stopped():
    """An engine in the midst of an advance from step 100 to 2100, and the advance."""
    made = InlineEngine(Stopping)
    ask(made, Advance(100))
    made.backend.at = 100
    advance = made.submit(Advance(2000))
    assert made.backend.stopped.wait(WAIT)
    yield made, advance
    made.backend.go.set()
    made.close()


def test_a_clock_that_is_set_during_an_advance_leaves_as_many_steps_to_make(stopped):
    engine, advance = stopped
    reset = engine.submit(SetClock(0, 0))
    engine.backend.go.set()
    made = ask_later(reset).step
    assert made == 0
    # The steps before the reset were one burst.
    assert 1 <= 2000 - ask_later(advance).step <= 1000


@pytest.mark.parametrize("command", [EndAdvance(), Batch((Pause(), EndAdvance())), Clear()])
def test_an_advance_can_be_ended(stopped, command):
    engine, advance = stopped
    ending = engine.submit(command)
    engine.backend.go.set()
    ended = ask_later(advance)
    assert ended.value == ended.step == ask_later(ending).step < 2100
    assert ask(engine, Advance(1)).step == ended.step + 1


def ask_later(answer):
    return answer.result(WAIT)


def test_commands_work_while_paused_and_the_reply_names_a_snapshot_that_shows_them(engine):
    load(engine)
    reply = ask(engine, SetModelState(1, Pose((5, 0, 0)), Twist()))
    assert engine.ring.latest >= reply.sequence
    assert engine.ring.read(reply.sequence).link(0)[0].position == (5, 0, 0)


def test_a_batch_that_is_refused_halfway_is_reported_as_partial_and_never_shown(engine):
    load(engine)
    reply = ask(engine, Batch((SetModelState(1, Pose((1, 0, 0)), Twist()), RemoveModel(77),
                               SetModelState(1, Pose((2, 0, 0)), Twist()))))
    assert "no longer exists" in reply.error and reply.is_partial
    assert engine.ring.link(0)[0].position == (0, 0, 0)


def test_a_batch_that_is_refused_at_its_first_command_has_changed_nothing(engine):
    load(engine)
    reply = ask(engine, Batch((RemoveModel(77), SetModelState(1, Pose((1, 0, 0)), Twist()))))
    assert "no longer exists" in reply.error and not reply.is_partial
    assert ask(engine, Advance(1)).step == 1
    assert engine.ring.link(0)[0].position == (0, 0, 0)


def test_the_snapshot_before_a_batch_is_of_the_step_at_which_it_is_applied(engine):
    load(engine)
    ask(engine, SetModelState(1, Pose(), Twist((1.0, 0, 0))))
    ask(engine, SetPhysics(PhysicsSettings(rate=0.0)))
    ask(engine, Run())
    until(lambda: engine.ring.step > 1000)
    reply = ask(engine, Batch((SetModelState(1, Pose((9, 0, 0)), Twist()), RemoveModel(77))))
    shown = engine.ring.read()
    assert reply.is_partial and shown.step == reply.step == engine.ring.step
    assert shown.link(0)[0].position[0] == pytest.approx(reply.step * 0.001)


def test_real_time_is_kept_and_late_steps_are_made_up(engine):
    ask(engine, Run())
    until(lambda: engine.ring.step > 10)

    def paced():
        """Whether 200 steps take about their time: a busy machine may need several tries."""
        first, started = engine.ring.step, time.perf_counter()
        until(lambda: engine.ring.step > first + 200)
        rate = (engine.ring.step - first) / (time.perf_counter() - started)
        return 300 < rate < 1300  # an order of magnitude: that it is paced at all

    until(paced)


def test_without_a_rate_it_runs_faster_than_real_time(engine):
    ask(engine, SetPhysics(PhysicsSettings(rate=0.0)))
    ask(engine, Run())
    until(lambda: engine.ring.step > 20000)


def test_a_changed_step_size_keeps_the_time_it_had(engine):
    ask(engine, Advance(100))
    ask(engine, SetPhysics(PhysicsSettings(step_size=0.01)))
    ask(engine, Advance(10))
    step, clock = engine.ring.clock()
    assert (step, clock.sim_ns(step)) == (110, 200_000_000)


@pytest.mark.parametrize("size", [0.0, -1.0, float("nan"), 11.0])
def test_a_useless_step_size_is_refused(engine, size):
    assert "step size" in ask(engine, SetPhysics(PhysicsSettings(step_size=size))).error
    assert ask(engine, Advance(1)).step == 1


def test_the_clock_can_be_set(engine):
    ask(engine, SetClock(0, 0))
    ask(engine, SetClock(5000, 5_000_000_000))
    step, clock = engine.ring.clock()
    assert (step, clock.sim_ns(step)) == (5000, 5_000_000_000)


def test_states_are_published_while_bodies_move(engine):
    load(engine, twist=Twist((1.0, 0, 0)))
    ask(engine, Run())
    until(lambda: engine.ring.link(0)[0].position[0] > 0.05)


def test_steps_wake_the_waiting_thread_only_on_request(engine):
    from my_simulations.engine.ring import WAKE_REQUESTED
    ask(engine, Run(FOREVER))
    assert not engine.wait_for_wake(0.05)
    engine.ring.words[WAKE_REQUESTED] = 1
    assert engine.wait_for_wake(WAIT)


def test_a_killed_engine_fails_what_it_has_not_answered(engine):
    deaths = []
    engine.on_death(lambda reason, commands: deaths.append((reason, commands)))
    engine.kill()
    assert deaths == [("the engine was killed", [])]
    with pytest.raises(Exception, match="not running"):
        ask(engine, Ping())
    engine.restart()
    assert ask(engine, Ping()).step == 0


@pytest.fixture
def slow():
    made = InlineEngine(Slow)
    ask(made, SetPhysics(PhysicsSettings(rate=0.0)))
    load(made, twist=Twist((1.0, 0.0, 0.0)))
    yield made
    made.close()


def test_states_nobody_waits_for_go_on_after_many_that_were_asked_for(slow):
    words = slow.ring.words
    words[DEMAND_NS] = 1
    first = slow.ring.latest
    ask(slow, Run())
    until(lambda: slow.ring.latest > first + 100)   # 0.4 s that need not be caught up
    words[DEMAND_NS] = 0
    last = slow.ring.latest + 1
    until(lambda: slow.ring.latest > last + 3)


def test_poses_can_be_had_more_often_than_states(slow):
    words = slow.ring.words
    words[POSE_DEMAND_NS] = 1_000_000
    first = slow.ring.latest
    ask(slow, Run())
    until(lambda: words[LATEST_POSES] > 50)
    assert slow.ring.latest - first < 25


def test_motors_and_the_advance_that_follows_write_one_snapshot(engine):
    load(engine)
    first = engine.ring.latest
    assert engine.post(SetMotors((JointMotor(0, 1.0, 5.0),)))
    assert ask(engine, Advance(0)).sequence == first + 1 == engine.ring.latest
    assert engine.ring.applied == engine.posted


@pytest.mark.parametrize("request_of_steps", [Run(), Advance(1000)])
def test_commands_sent_before_the_limit_was_raised_precede_the_steps(engine, request_of_steps):
    """Also if another command arrives alone just before them."""
    words, channel, backend = engine.ring.words, engine._channel, engine.backend
    receive, step = channel.receive, backend.step
    last_without = []

    def receive_and_raise(timeout):
        if not engine.posted and engine.ring.step >= 15:   # after bursts of 1, 2, 4 and 8
            engine.submit(Ping())
            found = receive(timeout)
            engine.post(SetMotors((JointMotor(0, 1.0, 5.0),)))
            words[STEP_BUDGET] = budget_word(settings, 1000)
            return found
        return receive(timeout)

    def note_step(first, count):
        if not backend.motors:
            last_without.append(first + count)
        step(first, count)

    channel.receive, backend.step = receive_and_raise, note_step
    ask(engine, SetPhysics(PhysicsSettings(rate=0.0)))
    settings = words[SETTINGS] + 1   # those of a new engine
    words[STEP_BUDGET] = budget_word(settings, 21)
    engine.submit(request_of_steps)
    until(lambda: engine.ring.step >= 500)
    assert max(last_without) <= 21


def test_an_advance_is_made_in_few_bursts(monkeypatch):
    """Each one costs a look at the commands; but one must follow soon."""
    backend = Timed()
    monkeypatch.setattr(runner, "time", SimpleNamespace(perf_counter=lambda: backend.now))
    engine = InlineEngine(lambda: backend)
    try:
        ask(engine, Advance(1000))
    finally:
        monkeypatch.undo()
        engine.close()
    assert sum(backend.bursts) == 1000
    assert max(backend.bursts) <= 50      # 5 ms
    assert len(backend.bursts) < 40
