"""Steps that belong to a rate."""
from __future__ import annotations

from fractions import Fraction

import pytest

from my_simulations.engine.rates import Rate
from my_simulations.engine.ring import Clock


@pytest.mark.parametrize("hertz", [30.0, 100.0, 7.3, 999.0, 1000.0])
@pytest.mark.parametrize("step_ps", [10 ** 9, 10 ** 12 // 240])
def test_steps_of_a_rate_are_the_first_ones_at_or_after_their_times(hertz, step_ps):
    clock, rate, step = Clock(0, 0, step_ps), Rate(hertz), 0
    period = Fraction(10 ** 12) / Fraction(hertz).limit_denominator(10 ** 6)
    for number in range(1, 200):
        step = rate.after(step, clock)
        wanted = -(-number * period // step_ps)
        assert step == (wanted if period > step_ps else number)


def test_a_clock_that_was_set_has_other_steps():
    assert Rate(100.0).after(70, Clock(70, 0, 10 ** 9)) == 80
    assert Rate(100.0).after(70, Clock(70, 5_000_000, 10 ** 9)) == 75
    assert Rate(0.0).after(70, Clock(70, 5_000_000, 10 ** 9)) == 71


def test_a_lead_makes_every_step_earlier():
    clock = Clock(0, 0, 10 ** 9)
    steps, step = [], 0
    for _ in range(4):
        step = Rate(100.0, lead=0.0025).after(step, clock)
        steps.append(step)
    assert steps == [8, 18, 28, 38]
