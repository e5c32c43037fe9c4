"""Observations: which steps are recorded for them, and what their records contain."""
from __future__ import annotations

from types import SimpleNamespace

from my_simulations.engine.drive_commands import ReadEfforts
from my_simulations.engine.step_records import Rate
from my_simulations.plugins.observations import Observations, Reads, StepView


def test_a_record_that_arrives_after_the_last_subscriber_left_is_still_read():
    topic = SimpleNamespace(wanted=True)
    query = ReadEfforts((4, 5))
    observations = Observations()
    owner = SimpleNamespace(list_observed=lambda reads: ((), (4, 5), (query,)),
                            observations=observations)
    one = observations.add(owner, Rate(1000.0), lambda: None, None, [topic], False, False,
                           Reads(efforts=("a", "b")))
    assert observations.new_rules(False, False)
    topic.wanted = False
    assert observations.new_rules(False, False) == ()
    part = SimpleNamespace(answers=lambda links, axes: [(1.0, 2.0)] if axes == 2 else None)
    view = StepView(None, bytes)
    view.show(None, part, one)
    assert view.answer(ReadEfforts) == (query, (1.0, 2.0))
