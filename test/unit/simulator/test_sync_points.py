"""Exact steps for a host: the engine waits at the end of a budget, and records on its way."""
from __future__ import annotations

import struct
import threading
from types import SimpleNamespace

import pytest
from inline_engine import InlineEngine
from running_simulator import running
from waiting import until

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.world import World
from my_simulations.engine.drive_commands import JointMotor
from my_simulations.engine.rates import Rate
from my_simulations.engine.ring import RECORDS, STEP_BUDGET, WAITS_AT, budget_word
from my_simulations.engine.step_records import RecordRule
from my_simulations.errors import CommandError
from my_simulations.geometry import Pose
from my_simulations.simulator.sync_points import SimTimeStep, SyncPoints

WAIT = 60.0


def arm():
    return Model("arm", links=[Link("base", inertial=Inertial()), Link("tip", inertial=Inertial())],
                 joints=[Joint("hinge", "revolute", "base", "tip", axis=JointAxis())])


@pytest.fixture
def simulator():
    engine = InlineEngine()
    with running(World(models=[arm()]), engine=lambda: engine) as made:
        yield made


class Host:
    """Acts at the steps of a rate; notes the steps and what is recorded by `rules`."""

    def __init__(self, simulator, hertz, act=lambda moment: None, rules=()):
        self.moments, self.records, self.reads = [], [], True
        self._sync, self._act, self._rules = simulator.sync_points, act, rules
        self._rate, self._clock_sets, self._settings = Rate(hertz), None, None
        self._stop = False
        self._sync.attach(lambda: None)
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self):
        while not self._stop:
            self._sync.wait(0.05)
            settings, moment = self._sync.settings, self._sync.now()
            self.take()
            if not self._sync.waits_at(moment):
                if self._settings is not None:
                    self._sync.allow(self._settings, self._next)
                continue
            if moment.clock_sets != self._clock_sets:
                if self._clock_sets is not None:
                    self.moments.append("clock set")
                self._clock_sets = moment.clock_sets
                self._next = self._rate.after(moment.step, moment.clock)
            elif moment.step >= self._next:
                self.moments.append(moment.step)
                self._act(moment)
                self._next = self._rate.after(moment.step, moment.clock)
            if settings != self._settings:
                self._sync.set_rules(self._rules)
            self._settings = settings
            self._sync.allow(settings, self._next)

    def take(self):
        reader = self._sync.records
        while self.reads and reader.first() is not None:
            record = reader.first()
            moment = SimTimeStep(record.clock_sets, record.step, record.clock)
            for part in record.parts():
                self.records.append((moment.sim_ns, part.number, bytes(part.raw)))
            reader.release()
        self._sync.make_room()

    def end(self):
        self._stop = True
        self._sync.notify()
        self._thread.join(WAIT)
        self._sync.detach()


def test_the_engine_waits_at_each_step_of_a_host_and_nowhere_else(simulator):
    host = Host(simulator, 100.0)
    assert simulator.clock.advance(55) == 55
    host.end()
    assert host.moments == [10, 20, 30, 40, 50]


def test_a_host_acts_at_the_last_step_before_the_advance_is_answered(simulator):
    host = Host(simulator, 100.0)
    simulator.clock.advance(30)
    assert host.moments == [10, 20, 30]
    host.end()


def test_orders_at_a_step_act_from_that_step_on(simulator):
    wheel = simulator.models.inventory()[1][0].axis_row("hinge", 0)

    def act(moment):
        simulator.drives.set([JointMotor(wheel, float(moment.step), 1.0)])

    host = Host(simulator, 100.0, act)
    simulator.clock.advance(30)
    host.end()
    assert simulator.joints.states("arm::hinge")[0][0] == pytest.approx(0.01 * (10 + 20))


def test_the_engine_waits_for_the_host_after_a_reset_of_time(simulator):
    host = Host(simulator, 100.0)
    simulator.clock.advance(15)
    simulator.resets.reset_time()
    simulator.clock.advance(15)
    host.end()
    assert host.moments == [10, "clock set", 10]


@pytest.mark.parametrize("change", [
    lambda simulator: simulator.resets.reset_world(),
    lambda simulator: simulator.models.set_link_inertial("arm::tip", Inertial(mass=2.0)),
    lambda simulator: simulator.models.delete("arm")])
def test_the_engine_waits_for_the_host_after_a_change_of_the_world(simulator, change):
    host = Host(simulator, 1.0)
    simulator.clock.advance(15)
    before = simulator.sync_points.settings
    change(simulator)
    simulator.clock.advance(1)
    assert simulator.sync_points.settings > before
    host.end()


def test_a_new_engine_has_the_motors_and_waits_for_the_host(simulator):
    row = simulator.models.inventory()[1][0].axis_row("hinge", 0)
    simulator.drives.set([JointMotor(row, 2.0, 1.0)])
    host = Host(simulator, 100.0)
    simulator.clock.advance(10)
    simulator._session.supervisor.engine.kill()
    assert simulator.clock.advance(5) == 15
    simulator.clock.advance(10)
    host.end()
    assert host.moments == [10, "clock set", 20]
    assert simulator.joints.states("arm::hinge")[0] == pytest.approx((2.0 * 0.025, 2.0))


def test_a_host_that_leaves_does_not_hold_the_engine(simulator):
    simulator.sync_points.attach(lambda: None)
    with pytest.raises(CommandError, match="another"):
        simulator.sync_points.attach(lambda: None)
    simulator.sync_points.detach()
    assert simulator.clock.advance(5) == 5


def turning(simulator, rules, hertz=1.0):
    """A host that records by `rules`, while the hinge turns at 1 rad/s."""
    row = simulator.models.inventory()[1][0].axis_row("hinge", 0)
    simulator.drives.set([JointMotor(row, 1.0, 1.0)])
    return Host(simulator, hertz, rules=rules)


def axis_of(raw):
    return struct.unpack("=3d", raw)


def test_records_are_of_the_exact_steps_of_their_rules(simulator):
    row = simulator.models.inventory()[1][0].axis_row("hinge", 0)
    host = turning(simulator, [RecordRule(1, Rate(100.0), joint_rows=(row,)),
                               RecordRule(2, Rate(40.0), joint_rows=(row,))])
    simulator.clock.advance(100)
    until(lambda: len(host.records) == 14)
    host.end()
    assert [ns // 10 ** 6 for ns, number, _ in host.records if number == 1] == list(
        range(10, 101, 10))
    assert [ns // 10 ** 6 for ns, number, _ in host.records if number == 2] == [25, 50, 75, 100]
    for ns, _, raw in host.records:
        assert axis_of(raw)[:2] == pytest.approx((ns * 1e-9, 1.0))
    assert host.moments == []


def test_a_rate_with_a_lead_comes_earlier_by_it(simulator):
    row = simulator.models.inventory()[1][0].axis_row("hinge", 0)
    host = turning(simulator, [RecordRule(1, Rate(100.0, lead=0.002), joint_rows=(row,))])
    simulator.clock.advance(40)
    until(lambda: len(host.records) == 4)
    host.end()
    assert [ns // 10 ** 6 for ns, _, _ in host.records] == [8, 18, 28, 38]


def test_a_full_ring_of_records_holds_the_engine_and_loses_nothing(simulator):
    row = simulator.models.inventory()[1][0].axis_row("hinge", 0)
    host = turning(simulator, [RecordRule(1, Rate(0.0), joint_rows=(row,))])
    simulator.clock.advance(1)
    until(lambda: len(host.records) == 1)
    host.reads = False
    count = 2 * RECORDS
    advance = threading.Thread(target=simulator.clock.advance, args=(count,))
    advance.start()
    until(lambda: simulator.clock.step == RECORDS + 2)
    host.reads = True
    simulator.sync_points.notify()
    advance.join(WAIT)
    until(lambda: len(host.records) == count + 1)
    host.end()
    assert [ns // 10 ** 6 for ns, _, _ in host.records] == list(range(1, count + 2))


def test_records_before_a_reset_belong_to_the_old_time(simulator):
    row = simulator.models.inventory()[1][0].axis_row("hinge", 0)
    host = turning(simulator, [RecordRule(1, Rate(100.0), joint_rows=(row,))])
    simulator.clock.advance(25)
    simulator.resets.reset_time()
    simulator.clock.advance(15)
    until(lambda: len(host.records) == 3)
    host.end()
    assert [ns // 10 ** 6 for ns, _, _ in host.records] == [10, 20, 10]


def test_joints_that_are_put_somewhere_are_counted(simulator):
    row = simulator.models.inventory()[1][0].axis_row("hinge", 0)
    host = turning(simulator, [RecordRule(1, Rate(100.0), joint_rows=(row,))])
    simulator.clock.advance(15)
    simulator.joints.set_positions({"arm::hinge": 1.0})
    simulator.clock.advance(10)
    until(lambda: len(host.records) == 2)
    host.end()
    assert [axis_of(raw)[2] for _, _, raw in host.records] == [0.0, 1.0]


def test_the_rows_of_all_links_are_recorded_once_for_all_rules(simulator):
    simulator.states.set_model_state("arm", Pose((1.0, 2.0, 3.0)),
                                     simulator.states.model_state("arm")[1])
    host = Host(simulator, 1.0, rules=[RecordRule(n, Rate(100.0), all_links=True)
                                       for n in (1, 2)])
    host.reads = False
    simulator.clock.advance(10)
    record = simulator.sync_points.records.first()
    assert [part.number for part in record.parts()] == [1, 2]
    seen = struct.unpack("=3d", record.world()[:24])
    host.end()
    assert seen == (1.0, 2.0, 3.0) and len(record.world()) == 2 * 13 * 8


class Engine:
    """Notes what it is sent; takes a budget from `sent` only when a test says so."""

    def __init__(self, words):
        self.words, self.sent = words, []

    def send_posted(self):
        self.sent.append("posted")

    def notify(self, budget=None):
        self.sent.append(budget)


@pytest.fixture
def host():
    words = [0] * (STEP_BUDGET + 1)
    engine = Engine(words)
    session = SimpleNamespace(ring=SimpleNamespace(words=words),
                              supervisor=SimpleNamespace(engine=engine))
    return SyncPoints(session), words, engine.sent


def test_an_engine_that_waits_gets_posted_commands_and_budget_in_one_message(host):
    sync, words, sent = host
    words[WAITS_AT] = 21
    sync.allow(1, 40)
    assert sent == [budget_word(1, 40)] and words[STEP_BUDGET] == 0


def test_a_running_engine_has_posted_commands_before_the_budget(host):
    sync, words, sent = host
    sync.allow(1, 40)
    assert sent == ["posted"] and words[STEP_BUDGET] == budget_word(1, 40)


def test_a_budget_that_the_engine_has_not_taken_yet_does_not_replace_a_later_one(host):
    sync, words, sent = host
    words[WAITS_AT] = 21
    sync.allow(1, 40)
    words[WAITS_AT] = 0            # it goes on for another reason
    sync.allow(1, 60)
    assert sent == [budget_word(1, 40), budget_word(1, 60)] and words[STEP_BUDGET] == 0
    words[STEP_BUDGET] = budget_word(1, 60)    # both taken
    sync.allow(1, 80)
    assert sent[2:] == ["posted"] and words[STEP_BUDGET] == budget_word(1, 80)
