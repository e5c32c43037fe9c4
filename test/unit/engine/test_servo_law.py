"""Servos and splines as arithmetic."""
from __future__ import annotations

import math
from dataclasses import replace

import pytest

from my_simulations.description.model import SoftLimits
from my_simulations.engine.drive_commands import JointServo, PidGains
from my_simulations.engine.servo_law import Pid, ServoLaw
from my_simulations.engine.spline import Spline, constant_segment, sample, segment_between

DT = 0.001


@pytest.mark.parametrize("before, after", [
    ((1.0,), (3.0,)), ((1.0, 0.5), (3.0, -2.0)), ((1.0, 0.5, 0.2), (3.0, -2.0, 4.0))])
def test_a_segment_has_the_states_of_its_ends(before, after):
    segment = segment_between(2.0, before, 4.5, after)
    assert sample(segment, 2.0)[:len(before)] == pytest.approx(before)
    assert sample(segment, 4.5)[:len(after)] == pytest.approx(after)


def test_the_lesser_known_end_says_what_kind_of_spline_it_is():
    segment = segment_between(0.0, (0.0, 5.0, 1.0), 2.0, (1.0,))
    assert [sample(segment, t)[0] for t in (0.5, 1.0, 1.5)] == pytest.approx([0.25, 0.5, 0.75])


def test_outside_of_a_spline_it_stands():
    spline = Spline((segment_between(1.0, (1.0, 1.0), 2.0, (3.0, 1.0)),))
    assert spline.at(0.0) == (1.0, 0.0, 0.0)
    assert spline.at(5.0) == (pytest.approx(3.0), 0.0, 0.0)


def test_a_later_segment_takes_over_where_it_starts():
    spline = Spline((constant_segment(7.0), segment_between(0.0, (0.0,), 4.0, (4.0,)),
                     segment_between(1.0, (1.0,), 2.0, (0.0,))), origin=100)
    assert spline.at_step(600, DT)[0] == pytest.approx(0.5)
    assert spline.at_step(1600, DT)[0] == pytest.approx(0.5)
    law = ServoLaw(JointServo(0, "effort", spline=spline, gains=PidGains(1.0)), DT)
    found = [law.advance(0.0, 0.0, step) for step in range(100, 2300, 7)]
    assert found == pytest.approx([spline.at_step(step, DT)[0] for step in range(100, 2300, 7)])


def test_a_segment_may_not_end_before_it_starts():
    with pytest.raises(ValueError, match="ends before"):
        segment_between(1.0, (0.0,), 0.5, (1.0,))


def test_the_integral_term_is_limited():
    winding, antiwindup = (Pid(PidGains(0.0, 10.0, 0.0, -2.0, 2.0, still))
                           for still in (False, True))
    for _ in range(1000):
        assert winding.command(1.0, DT) <= 2.0
        assert antiwindup.command(1.0, DT) <= 2.0
    assert winding.integral == pytest.approx(1.0)
    assert antiwindup.integral == pytest.approx(0.2)   # it stopped at the limit


def test_the_first_difference_of_a_loop_is_no_rate():
    loop = Pid(PidGains(0.0, 0.0, 1.0))
    assert loop.command(5.0, DT) == 0.0
    assert loop.command(5.001, DT) == pytest.approx(1.0)
    loop.reset_after_jump()
    assert loop.command(9.0, DT) == 0.0


def test_an_effort_does_not_push_beyond_limits_of_position_and_rate():
    law = ServoLaw(JointServo(0, "effort", 5.0, lower=-1.0, upper=1.0, most_rate=2.0,
                              most_effort=3.0), DT)
    assert law.advance(0.0, 0.0, 0) == 3.0
    assert law.advance(1.1, 0.0, 1) == 0.0
    assert law.advance(0.0, 2.5, 2) == 0.0
    law.change(replace(law.servo, target=-5.0))
    assert law.advance(1.1, 0.0, 3) == -3.0
    assert law.advance(0.0, -2.5, 4) == 0.0


def test_soft_limits_slow_down_towards_a_limit():
    soft = SoftLimits(-1.0, 1.0, 10.0, 5.0)
    law = ServoLaw(JointServo(0, "velocity", 2.0, most_rate=2.0, soft=soft), DT)
    assert law.advance(0.0, 0.0, 0) == 2.0
    assert law.advance(0.95, 0.0, 1) == pytest.approx(0.5)
    assert law.advance(1.1, 0.0, 2) == pytest.approx(-1.0)
    effort = ServoLaw(JointServo(0, "effort", 50.0, most_rate=2.0, most_effort=8.0, soft=soft), DT)
    assert effort.advance(0.0, 0.0, 0) == 8.0
    assert effort.advance(0.95, 0.4, 1) == pytest.approx(5.0 * (0.5 - 0.4))


def test_an_angle_goes_the_shorter_way():
    law = ServoLaw(JointServo(0, "effort", 3.0, gains=PidGains(1.0), wraps=True), DT)
    assert law.advance(-3.0, 0.0, 0) == pytest.approx(6.0 - 2.0 * math.pi)


def test_a_drive_with_gains_follows_a_position_no_faster_than_the_joint_may():
    law = ServoLaw(JointServo(0, "position", 1.0, drive_gains=PidGains(100.0), most_rate=2.0), DT)
    assert law.advance(0.0, 0.0, 0) == pytest.approx(100.0 * 2.0 * DT)
    assert law.advance(0.0, 0.0, 1) == pytest.approx(100.0 * 4.0 * DT)


def test_a_position_or_rate_without_loops_needs_no_computing():
    assert ServoLaw(JointServo(0, "position", 1.0), DT).steady
    assert ServoLaw(JointServo(0, "velocity", 1.0), DT).steady
    assert not ServoLaw(JointServo(0, "effort", 1.0), DT).steady
    assert not ServoLaw(JointServo(0, "position", 1.0, drive_gains=PidGains(1.0)), DT).steady


def test_a_rate_follows_its_target_with_the_lag_of_its_direction():
    servo = JointServo(0, "velocity", target=50.0, lags=(0.1, 0.2), most_rate=40.0)
    law = ServoLaw(servo, DT)
    risen = [law.advance(0.0, 10.0, step) for step in range(100)][-1]
    assert risen == pytest.approx(40.0 - 30.0 * math.exp(-1.0))   # it began with the joint's rate
    resumed = ServoLaw(servo, DT)
    resumed.resume(law.memory)
    for each in (law, resumed):
        each.change(replace(servo, target=0.0))
    fallen = [(law.advance(0.0, 0.0, step), resumed.advance(0.0, 0.0, step))
              for step in range(100, 200)][-1]
    assert fallen[0] == pytest.approx(risen * math.exp(-0.5))
    assert fallen[0] == fallen[1]


def test_the_effort_of_a_servo_ends_with_a_command_of_0():
    law = ServoLaw(JointServo(0, "effort", target=3.0), DT)
    law.advance(0.0, 0.0, 0)
    assert law.last == 3.0
    law.change(JointServo(0, "effort", target=0.0))
    assert law.steady and law.last == 0.0
