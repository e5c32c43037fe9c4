import threading

import pytest

from my_simulations.ros.call_deadline import CallTimeoutError, call_with_deadline


def test_a_call_in_time_gives_its_answer():
    assert call_with_deadline(10.0, "the call", lambda: 7) == 7


def test_a_call_in_time_raises_its_fault():
    with pytest.raises(KeyError):
        call_with_deadline(10.0, "the call", lambda: {}["x"])


def test_a_call_that_never_answers_ends_at_its_deadline_which_is_named():
    never = threading.Event()
    with pytest.raises(CallTimeoutError, match="the call did not respond within 0.05 s"):
        call_with_deadline(0.05, "the call", never.wait)
    never.set()
