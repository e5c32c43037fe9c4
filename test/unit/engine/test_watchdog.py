"""When an engine is taken to hang, and when it only gets no processor time."""
from __future__ import annotations

import os

import pytest

from my_simulations.simulator.watchdog import Watchdog, process_time


class Case:
    """An engine whose processor time and state are told."""

    def __init__(self):
        self.now, self.cpu, self.state, self.sign = 0.0, 0.0, "S", 1
        self.dog = Watchdog(lambda pid: (self.cpu, self.state), lambda: self.now)
        self.dog.check(7, 0)
        self.dog.check(7, self.sign)  # the start is over

    def passes(self, seconds, cpu=0.0, step=2.0):
        """Time goes by in looks; the first verdict and when it came."""
        until = self.now + seconds
        while self.now < until:
            self.now += step
            self.cpu += cpu * step
            said = self.dog.check(7, self.sign)
            if said:
                return said
        return ""


def test_an_engine_that_computes_without_a_sign_of_life_hangs():
    case = Case()
    case.state = "R"
    assert case.passes(28, cpu=1.0) == ""
    assert "processor time" in case.passes(6, cpu=1.0)


def test_one_that_gets_no_processor_time_does_not_hang():
    case = Case()
    case.state = "R"
    assert case.passes(280, cpu=0.1) == ""
    assert "processor time" in case.passes(60, cpu=0.1)


def test_one_that_sleeps_without_a_sign_of_life_hangs():
    for state in "ST":
        case = Case()
        case.state = state
        assert case.passes(28) == ""
        assert "while idle" in case.passes(8)


def test_a_sign_of_life_begins_the_time_anew():
    case = Case()
    for n in range(10):
        assert case.passes(28, cpu=1.0) == ""
        case.sign = 10 + n


def test_a_node_that_was_stopped_itself_does_not_count_that_time():
    case = Case()
    case.state = "T"
    assert case.passes(600, step=600.0) == ""
    case.state = "S"
    assert case.passes(10) == ""


def test_the_start_has_a_limit_of_its_own():
    case = Case()
    case.state = "R"
    case.dog.begin()
    assert case.passes(88, cpu=1.0) == ""
    assert "90 s of processor time" in case.passes(8, cpu=1.0)
    case.dog.begin()
    case.sign = 99
    case.passes(2)
    assert "30 s of processor time" in case.passes(40, cpu=1.0)


def test_nothing_lasts_for_ever():
    case = Case()
    case.state = "D"
    assert case.passes(898) == ""
    assert case.passes(8) == "900 s"


def test_without_a_process_wall_time_counts():
    now = [0.0]
    dog = Watchdog(lambda pid: None, lambda: now[0])
    verdicts = []
    for _ in range(60):
        now[0] += 2.0
        verdicts.append(dog.check(0, "same"))
    assert verdicts[10] == "" and "while idle" in verdicts[-1]


def test_processor_time_of_a_process_is_read():
    before = process_time(os.getpid())
    while process_time(os.getpid())[0] < before[0] + 0.05:
        pass
    assert before[1] == "R"
    with pytest.raises(TypeError):
        _ = process_time(2 ** 22 + 1)[0]
