"""The batteries of PR2: charge, power, time that remains."""
from __future__ import annotations

import pytest

from my_simulations.plugins.state.power_monitor import PowerMonitor
from my_simulations.plugins.testing import FakeContext


def monitor(inside=""):
    context = FakeContext("<plugin><fullChargeCapacity>0.01</fullChargeCapacity>"
                          f"<dischargeRate>-36</dischargeRate>{inside}</plugin>")
    PowerMonitor(context).load()
    return context


def states(context):
    return context.published["power_state"]


def test_the_charge_falls_by_the_current():
    context = monitor("<dischargeVoltage>36</dischargeVoltage>")   # 1 A, of 36 A s
    context.advance(9.0)
    state = states(context)[-1]
    assert len(states(context)) == 9
    assert (state.relative_capacity, state.power_consumption, state.AC_present) == (75, -36.0, 0)
    remaining = state.time_remaining.secs + state.time_remaining.nsecs * 1e-9
    assert remaining == pytest.approx(0.0075 / 1.0 * 60.0)
    context.advance(60.0)
    assert states(context)[-1].relative_capacity == 0


def test_a_charger_charges():
    context = monitor("<dischargeVoltage>36</dischargeVoltage>")
    context.deliver("plugged_in", ac_present=True, charge_rate=72.0, discharge_rate=0.0,
                    charge=0.005)
    context.advance(9.0)
    state = states(context)[-1]
    assert (state.relative_capacity, state.power_consumption, state.AC_present) == (75, 36.0, 4)
    context.advance(20.0)
    assert states(context)[-1].relative_capacity == 100
    assert states(context)[-1].time_remaining.secs == 0


def test_the_period_and_the_topic_come_from_the_file():
    context = monitor("<powerStateRate>5</powerStateRate><powerStateTopic>power</powerStateTopic>")
    context.advance(20.0)
    assert len(context.published["power"]) == 4
