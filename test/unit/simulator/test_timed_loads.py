"""Wrenches and efforts asked for in sim time, on an engine without physics."""
from __future__ import annotations

import math

import pytest
from inline_engine import InlineEngine
from kinematic_backend import KinematicBackend
from running_simulator import started

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.world import World
from my_simulations.engine.commands import FOREVER, Batch
from my_simulations.engine.drive_commands import SetMotors, SetServos
from my_simulations.engine.ring import Clock
from my_simulations.engine.timed_forces import JointPid, TimedWrench
from my_simulations.errors import CommandError
from my_simulations.geometry import Pose, Twist, quat_from_rpy
from my_simulations.simulator.registry import UnknownEntityError, UnknownFrameError
from my_simulations.simulator.wrenches import first_step, steps_of

MS = 1000000
QUARTER = quat_from_rpy(0, 0, math.pi / 2)


def arm(name, com=(0.0, 0.0, 0.0)):
    links = [Link("base", inertial=Inertial(pose=Pose(com))), Link("tip", Pose((1.0, 0, 0)))]
    joints = [Joint("hinge", "revolute", "base", "tip", axis=JointAxis()),
              Joint("weld", "fixed", "base", "tip")]
    return Model(name, links=links, joints=joints)


class Case:
    def __init__(self, *models):
        self.backends = []
        self.sim = started(World(models=list(models)), engine=self.engine, log=print)

    def engine(self):
        def make():
            self.backends.append(KinematicBackend())
            return self.backends[-1]

        return InlineEngine(make)

    @property
    def loads(self):
        return list(self.backends[-1].timed_forces.values())


@pytest.fixture
def case():
    made = []

    def make(*models):
        made.append(Case(*models))
        return made[-1]

    yield make
    for one in made:
        one.sim.close()


def test_a_load_of_now_begins_with_the_next_step_and_lasts_its_steps(case):
    made = case(arm("a"))
    made.sim.clock.advance(5)
    made.sim.wrenches.apply_wrench("a::base", (1, 0, 0), (0, 0, 2), duration_ns=10 * MS)
    [load] = made.loads
    assert (load.start, load.stop) == (5, 15)
    assert (load.force, load.torque, load.in_link_axes) == ((1, 0, 0), (0, 0, 2), False)


def test_a_load_of_the_future_begins_at_its_time(case):
    made = case(arm("a"))
    made.sim.wrenches.apply_effort("a::hinge", 3.0, start_ns=20 * MS, duration_ns=MS)
    [load] = made.loads
    assert (load.start, load.stop, load.effort) == (20, 21, 3.0)


@pytest.mark.parametrize("duration, steps", [(1, 1), (400000, 1), (MS, 1), (1400000, 1),
                                             (1600000, 2), (10 * MS, 10)])
def test_durations_are_rounded_to_steps_and_are_one_at_least(case, duration, steps):
    made = case(arm("a"))
    made.sim.wrenches.apply_wrench("base", (1, 0, 0), (0, 0, 0), duration_ns=duration)
    assert made.loads[0].stop - made.loads[0].start == steps


def test_no_duration_does_nothing_and_a_negative_one_has_no_end(case):
    made = case(arm("a"))
    made.sim.wrenches.apply_wrench("base", (1, 0, 0), (0, 0, 0), duration_ns=0)
    assert made.loads == []
    made.sim.wrenches.apply_wrench("base", (1, 0, 0), (0, 0, 0), duration_ns=-1)
    assert made.loads[0].stop == FOREVER


def test_a_wrench_in_a_links_own_frame_attacks_at_its_origin_and_turns_along(case):
    made = case(arm("a", com=(0.5, 0, 0)))
    made.sim.states.set_model_state("a", Pose((3, 0, 0), QUARTER), Twist())
    made.sim.wrenches.apply_wrench("a::base", (1, 0, 0), (0, 0, 0), frame="a::base", point=(0, 2,
                                                                                            0))
    [load] = made.loads
    assert load.in_link_axes
    assert load.force == pytest.approx((1, 0, 0))
    assert load.point == pytest.approx((-0.5, 2, 0))


def test_a_wrench_in_another_frame_is_turned_into_the_link(case):
    made = case(arm("a"), arm("b"))
    made.sim.states.set_model_state("b", Pose((3, 0, 0), QUARTER), Twist())
    made.sim.wrenches.apply_wrench("a::base", (1, 0, 0), (0, 1, 0), frame="b", point=(1, 0, 0))
    [load] = made.loads
    assert load.force == pytest.approx((0, 1, 0))
    assert load.torque == pytest.approx((-1, 0, 0))
    assert load.point == pytest.approx((3, 1, 0))


def test_loads_are_cleared_by_either_form_of_the_name(case):
    made = case(arm("a"), arm("b"))
    for name in ("a::base", "b::base"):
        made.sim.wrenches.apply_wrench(name, (1, 0, 0), (0, 0, 0))
    made.sim.wrenches.apply_effort("b::hinge", 1.0)
    made.sim.wrenches.clear_wrenches("b::base")
    assert len(made.loads) == 2
    made.sim.wrenches.clear_wrenches("base")
    assert [load.effort for load in made.loads] == [1.0]
    made.sim.wrenches.clear_efforts("hinge")   # the first one in the world
    assert len(made.loads) == 1
    made.sim.wrenches.clear_efforts("b::hinge")
    assert made.loads == []


def test_unknown_names_and_joints_without_axis_are_refused(case):
    made = case(arm("a"))
    with pytest.raises(UnknownEntityError):
        made.sim.wrenches.apply_wrench("none", (1, 0, 0), (0, 0, 0))
    with pytest.raises(UnknownFrameError):
        made.sim.wrenches.apply_wrench("base", (1, 0, 0), (0, 0, 0), frame="none")
    with pytest.raises(UnknownEntityError):
        made.sim.wrenches.apply_effort("none", 1.0)
    with pytest.raises(CommandError, match="no axis"):
        made.sim.wrenches.apply_effort("weld", 1.0)
    assert made.loads == []


def test_a_restarted_engine_gets_no_load_of_a_deleted_model(case):
    made = case(arm("a"), arm("b"))
    made.sim.wrenches.apply_wrench("a::base", (1, 0, 0), (0, 0, 0))
    made.sim.wrenches.apply_wrench("b::base", (2, 0, 0), (0, 0, 0))
    made.sim.models.delete("a")
    assert [load.force for load in made.sim.wrenches.pending(0)] == [(2, 0, 0)]


def test_in_lockstep_time_goes_on_by_request_only(case):
    made = case(arm("a"))
    made.sim.clock.set_manual_stepping(True)
    made.sim.clock.unpause()
    assert not made.sim.clock.paused and not made.sim.clock.running
    assert made.sim.clock.advance(7) == 7
    made.sim.resets.reset_time()
    assert made.sim.clock.step == 0 and not made.sim.clock.running
    made.sim.clock.set_manual_stepping(False)
    assert made.sim.clock.running


def test_times_that_are_rounded_to_nanoseconds_find_their_step():
    clock = Clock(0, 0, 4166666667)   # 1/240 s
    for step in (1, 2, 3, 1000, 123457):
        assert first_step(clock, clock.sim_ns(step)) == step
        assert first_step(clock, clock.sim_ns(step) + 2000) == step + 1
    assert steps_of(clock, 1000000000) == 240


def test_a_load_that_is_late_keeps_its_length():
    load = TimedWrench(0, 0, 3, 10)
    assert load.begun(5) == TimedWrench(0, 0, 5, 12)
    assert load.begun(2) is load
    assert TimedWrench(0, 0, 3, FOREVER).begun(5).stop == FOREVER


@pytest.mark.parametrize("effort", [math.nan, math.inf, JointPid(math.nan),
                                    JointPid(1.0, d=math.inf)])
def test_an_effort_that_is_not_finite_is_refused(case, effort):
    made = case(arm("a"))
    with pytest.raises(CommandError, match="NaN or infinity"):
        made.sim.wrenches.apply_effort("a::hinge", effort)
    assert made.loads == []


def test_a_drive_with_a_rate_of_nan_is_refused(case):
    made = case(arm("a"))
    with pytest.raises(CommandError, match="NaN"):
        made.sim.drives.hold_axes({"a::hinge": (1.0, 5.0, math.nan)})
    assert made.backends[-1].servos == {}
    made.sim.drives.hold_axes({"a::hinge": (1.0, 5.0, math.inf)})


def test_several_axes_are_driven_or_held_by_one_command(case):
    made = case(arm("a"), arm("b"))
    sent = []
    call, post = made.sim._session.call, made.sim._session.supervisor.post
    made.sim._session.call = lambda command: sent.append(command) or call(command)
    made.sim._session.supervisor.post = lambda command, at_once: (
        sent.append(command) or post(command, at_once))
    made.sim.drives.drive_axes({"a::hinge": (1.0, 5.0), "b::hinge": (2.0, 5.0)})
    assert [type(command) for command in sent] == [SetMotors]
    made.sim.drives.hold_axes({"a::hinge": (1.0, 5.0, 2.0), "b::hinge": (2.0, 5.0, 2.0)})
    assert sum(isinstance(command, (SetServos, Batch)) for command in sent) == 1


def test_a_drive_does_not_wait_for_the_engine_and_outlives_its_crash(case):
    made = case(arm("a"))
    call, waited = made.sim._session.call, []
    made.sim._session.call = lambda command: waited.append(command) or call(command)
    made.sim.drives.drive_axes({"a::hinge": (1.0, 5.0)})
    assert waited == []
    made.sim.clock.advance(1)
    assert made.sim.joints.states("a::hinge")[0][1] == 1.0
    made.sim.drives.drive_axes({"a::hinge": (2.0, 5.0)})
    made.sim._session.supervisor.engine.kill()
    made.sim.clock.advance(1)
    assert len(made.backends) == 2
    assert made.sim.joints.states("a::hinge")[0][1] == 2.0


def test_no_axis_is_driven_or_held_if_one_cannot_be(case):
    made = case(arm("a"))
    for refused in ("a::nobody", "b::hinge"):
        with pytest.raises(CommandError):
            made.sim.drives.drive_axes({"a::hinge": (1.0, 5.0), refused: (1.0, 5.0)})
        with pytest.raises(CommandError):
            made.sim.drives.hold_axes({"a::hinge": (1.0, 5.0, 2.0), refused: (1.0, 5.0, 2.0)})
    assert made.backends[-1].motors == {} and made.backends[-1].servos == {}
