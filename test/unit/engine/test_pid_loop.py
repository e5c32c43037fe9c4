"""A PID loop, by itself."""
from __future__ import annotations

import pytest

from my_simulations.engine.bullet.joint_pid import PidController
from my_simulations.engine.timed_forces import JointPid

DT = 0.01


def test_the_effort_is_against_error_integral_and_slope():
    loop = PidController(JointPid(1.0, p=10.0, i=2.0, d=0.5))
    assert loop.effort(0.0, 0.0, DT, 1e9) == pytest.approx(10.0 + 2.0 * DT)   # no slope yet
    assert loop.effort(0.5, 0.0, DT, 1e9) == pytest.approx(5.0 + 3.0 * DT - 0.5 * 0.5 / DT)


def test_a_rate_is_followed_by_the_rate():
    loop = PidController(JointPid(-2.0, rate=True, p=3.0, i=0.0, d=0.0))
    assert loop.effort(99.0, 1.0, DT, 1e9) == pytest.approx(-9.0)


def test_the_integral_waits_while_the_effort_is_at_its_limit():
    loop = PidController(JointPid(1.0, p=0.0, i=1.0, d=0.0))
    for _ in range(1000):   # ten seconds at a stop
        assert abs(loop.effort(0.0, 0.0, DT, 0.5)) <= 0.5
    later = [loop.effort(2.0, 0.0, DT, 0.5) for _ in range(2)]
    assert later[0] > later[1] and later[0] < 0.5   # at once less, not in ten seconds
