"""Steps at which somebody acts: the engine stops there, and nowhere else."""
from __future__ import annotations

import threading
from fractions import Fraction

import pytest

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.world import World
from my_simulations.engine.inline_engine import InlineEngine
from my_simulations.engine.kinematic_backend import KinematicBackend
from my_simulations.engine.ring import Clock
from my_simulations.simulator.appointments import Rate
from my_simulations.simulator.simulator import Simulator

WAIT = 60.0


def arm():
    return Model("arm", links=[Link("base", inertial=Inertial()), Link("tip", inertial=Inertial())],
                 joints=[Joint("hinge", "revolute", "base", "tip", axis=JointAxis())])


@pytest.fixture
def simulator():
    engine = InlineEngine(KinematicBackend)
    made = Simulator(World(models=[arm()]), engine_factory=lambda: engine, paused=True,
                     log=lambda issue: None)
    made.start()
    yield made
    made.close()


class Diary:
    """A consumer that writes down where the engine stood."""

    def __init__(self, simulator, hertz, act=lambda moment: None):
        self.moments = []
        self._rate, self._act = Rate(hertz), act
        self._consumer = simulator.appointments.join()
        moment = self._consumer.now()
        self._next = self._rate.after(moment.step, moment.clock)
        self._clock_sets = moment.clock_sets
        self._consumer.allow(moment, self._next)
        self._stop = False
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self):
        while not self._stop:
            if not self._consumer.wait(0.05):
                continue
            moment = self._consumer.now()
            if moment.clock_sets != self._clock_sets:
                self.moments.append("clock set")
                self._clock_sets = moment.clock_sets
                self._next = self._rate.after(moment.step, moment.clock)
            elif moment.step >= self._next:
                self.moments.append(moment.step)
                self._act(moment)
                self._next = self._rate.after(moment.step, moment.clock)
            self._consumer.allow(moment, self._next)

    def end(self):
        self._stop = True
        self._thread.join(WAIT)
        self._consumer.leave()


@pytest.mark.parametrize("hertz", [30.0, 100.0, 7.3, 999.0, 1000.0])
@pytest.mark.parametrize("step_ps", [10 ** 9, 10 ** 12 // 240])
def test_appointments_of_a_rate_are_the_first_steps_at_or_after_their_times(hertz, step_ps):
    clock, rate, step = Clock(0, 0, step_ps), Rate(hertz), 0
    period = Fraction(10 ** 12) / Fraction(hertz).limit_denominator(10 ** 6)
    for number in range(1, 200):
        step = rate.after(step, clock)
        wanted = -(-number * period // step_ps)
        assert step == (wanted if period > step_ps else number)


def test_a_clock_that_was_set_has_other_appointments():
    assert Rate(100.0).after(70, Clock(70, 0, 10 ** 9)) == 80
    assert Rate(100.0).after(70, Clock(70, 5_000_000, 10 ** 9)) == 75
    assert Rate(0.0).after(70, Clock(70, 5_000_000, 10 ** 9)) == 71


def test_the_engine_stops_at_each_appointment_and_nowhere_else(simulator):
    diary = Diary(simulator, 100.0)
    assert simulator.clock.advance(55) == 55
    diary.end()
    assert diary.moments == [10, 20, 30, 40, 50]


def test_who_acts_at_the_last_step_does_so_before_the_advance_is_answered(simulator):
    diary = Diary(simulator, 100.0)
    simulator.clock.advance(30)
    assert diary.moments == [10, 20, 30]
    diary.end()


def test_the_smallest_credit_counts(simulator):
    one, other = Diary(simulator, 100.0), Diary(simulator, 40.0)
    simulator.clock.advance(100)
    one.end()
    other.end()
    assert one.moments == list(range(10, 101, 10)) and other.moments == [25, 50, 75, 100]


def test_what_is_ordered_at_an_appointment_acts_from_that_step_on(simulator):
    wheel = simulator.models.inventory()[1][0].axis_row("hinge", 0)

    def act(moment):
        from my_simulations.engine.drive_commands import JointMotor
        simulator.drives.set([JointMotor(wheel, float(moment.step), 1.0)])

    diary = Diary(simulator, 100.0, act)
    simulator.clock.advance(30)
    diary.end()
    assert simulator.joints.states("arm::hinge")[0][0] == pytest.approx(0.01 * (10 + 20))


def test_a_reset_ends_the_credits_and_is_a_meeting_of_its_own(simulator):
    diary = Diary(simulator, 100.0)
    simulator.clock.advance(15)
    simulator.resets.reset_time()
    simulator.clock.advance(15)
    diary.end()
    assert diary.moments == [10, "clock set", 10]


def test_a_new_engine_has_the_motors_and_makes_the_appointments_anew(simulator):
    from my_simulations.engine.drive_commands import JointMotor

    row = simulator.models.inventory()[1][0].axis_row("hinge", 0)
    simulator.drives.set([JointMotor(row, 2.0, 1.0)])
    diary = Diary(simulator, 100.0)
    simulator.clock.advance(10)
    simulator._session.supervisor.engine.kill()
    assert simulator.clock.advance(5) == 15
    simulator.clock.advance(10)
    diary.end()
    assert diary.moments == [10, "clock set", 20]
    assert simulator.joints.states("arm::hinge")[0] == pytest.approx((2.0 * 0.025, 2.0))


def test_one_who_leaves_holds_nobody_up(simulator):
    consumer = simulator.appointments.join()
    consumer.leave()
    assert simulator.clock.advance(5) == 5


def test_one_that_leaves_does_not_take_the_credit_of_one_that_joins(simulator):
    first = simulator.appointments.join()
    first.leave()
    second = simulator.appointments.join()
    first.leave()   # a plugin that is ended twice
    before = simulator.clock.step
    advance = threading.Thread(target=simulator.clock.advance, args=(10,))
    advance.start()
    assert second.wait(WAIT)
    assert simulator.clock.step == before
    second.allow(second.now(), None)
    advance.join(WAIT)
    assert simulator.clock.step == before + 10
    second.leave()
