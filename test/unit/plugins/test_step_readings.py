"""Efforts and contacts are read from the engine once a step for all readers."""
from __future__ import annotations

from types import SimpleNamespace

import pytest

from my_simulations.engine.ring import Clock
from my_simulations.plugins.observations import StepView
from my_simulations.plugins.schedule import Schedule
from my_simulations.plugins.step_readings import StepReadings
from my_simulations.simulator.sync_points import SimTimeStep


class Engine:
    """Efforts are 10 times the step count plus the row; notes what was asked."""

    def __init__(self, schedule):
        self.asked, self.looks, self._schedule = [], 0, schedule
        self.drives = SimpleNamespace(efforts=self._efforts)
        self.states = SimpleNamespace(contacts=self._contacts)

    def _efforts(self, rows):
        self.asked.append(list(rows))
        return [10.0 * self._schedule.time_step.step + row for row in rows]

    def _contacts(self):
        self.looks += 1
        return [self._schedule.time_step.step]


@pytest.fixture
def schedule():
    found = Schedule()
    stand_at(found, 1)
    return found


def stand_at(schedule, step, clock_sets=0):
    schedule.set_time_step(SimTimeStep(clock_sets, step, Clock(0, 0, 10 ** 9)))


def test_rows_that_two_robots_ask_for_are_read_together_from_the_second_step_on(schedule):
    engine = Engine(schedule)
    readings = StepReadings(engine, schedule, StepView(None, bytes))
    for step in (1, 2, 3):
        stand_at(schedule, step)
        assert readings.efforts([4, 5]) == [10.0 * step + 4, 10.0 * step + 5]
        assert readings.efforts([7]) == [10.0 * step + 7]
    assert engine.asked == [[4, 5], [4, 5, 7], [4, 5, 7], [4, 5, 7]]


def test_rows_that_nobody_asks_for_any_more_are_not_read(schedule):
    engine = Engine(schedule)
    readings = StepReadings(engine, schedule, StepView(None, bytes))
    readings.efforts([4])
    readings.efforts([7])
    for step in (2, 3, 4):
        stand_at(schedule, step)
        readings.efforts([4])
    assert engine.asked[-1] == [4]


def test_a_clock_that_is_set_to_the_same_step_has_other_readings(schedule):
    engine = Engine(schedule)
    readings = StepReadings(engine, schedule, StepView(None, bytes))
    readings.efforts([4])
    readings.contacts()
    stand_at(schedule, 1, clock_sets=1)
    readings.efforts([4])
    readings.contacts()
    assert len(engine.asked) == 2 and engine.looks == 2


def test_contacts_are_read_once_a_step(schedule):
    engine = Engine(schedule)
    readings = StepReadings(engine, schedule, StepView(None, bytes))
    assert [readings.contacts(), readings.contacts()] == [[1], [1]]
    stand_at(schedule, 2)
    assert readings.contacts() == [2]
    assert engine.looks == 2
