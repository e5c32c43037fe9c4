"""The figures of the time bar belong together."""
import pytest

from my_simulations.editor.transport.clock_statistics import ClockStatistics
from my_simulations.engine.ring import Clock

STEP_NS = 1000000


class Sim:
    """A world that makes a step between any two looks at it, until it is paused."""

    def __init__(self, looks):
        self._looks, self._step = looks, 0
        self.clock = self

    def _look(self):
        if self._looks > 0:
            self._looks -= 1
            self._step += 1

    @property
    def paused(self):
        self._look()
        return self._looks == 0

    @property
    def sim_ns(self):
        return self.now()[0] * STEP_NS

    def now(self):
        self._look()
        return self._step, Clock(0, 0, 1000 * STEP_NS)


@pytest.mark.parametrize("looks", range(1, 12))
def test_a_pause_is_told_with_its_last_step_and_time(looks):
    sim = Sim(looks)
    figures = ClockStatistics(sim)
    while True:
        told = figures.read()
        assert told["sim_ns"] == told["iterations"] * STEP_NS
        if told["paused"]:
            break
    assert told["iterations"] == looks
