"""Values for plots, and the moment that they are of."""
from __future__ import annotations

import pytest
from pytest import approx

from my_simulations.editor.transport.watch_requests import WatchedValues
from my_simulations.engine.ring import Clock, Snapshot


class Running:
    """A world that makes 41 steps whenever it was looked at, as on a busy machine."""

    def __init__(self) -> None:
        self.clock = self.states = self
        self.step = 820
        self.written = 0

    def _go_on(self) -> int:
        self.step += 41
        return self.step - 41

    def now(self):
        return self._go_on(), Clock(0, 0, 10 ** 9)

    def latest(self):
        self.written = self._go_on()
        return [], Snapshot(1, self.written, Clock(0, 0, 10 ** 9), [], [])


class Busy(Running):
    """The same, with a snapshot of an earlier step."""

    def latest(self):
        return [], Snapshot(1, 800, Clock(0, 0, 10 ** 9), [], [])


def test_a_value_has_the_time_of_the_state_that_it_is_read_from():
    world = Running()
    found = WatchedValues(world, None,
                          lambda _: None).pushes(["plot:iterations"])["plot:iterations"]
    assert found["value"] == world.written and found["time"] == approx(world.written * 1e-3)


@pytest.mark.parametrize("topic, step", [
    ("plot:box.vz", 800), ("joints:arm", 800), ("plot:sim_time", 820), ("plot:/odom.x", 820)])
def test_states_have_the_time_of_their_snapshot_and_all_else_that_of_the_clock(topic, step):
    found = WatchedValues(Busy(), None, lambda _: 1.0).pushes([topic])[topic]
    assert found["time"] == approx(step * 1e-3)


def test_time_goes_on_while_nothing_moves():
    world = Running()
    world.latest = lambda: ([], Snapshot(1, 5, Clock(0, 0, 10 ** 9), [], []))
    found = WatchedValues(world, None,
                          lambda _: None).pushes(["plot:iterations"])["plot:iterations"]
    assert found["value"] == 820 and found["time"] == approx(0.82)
