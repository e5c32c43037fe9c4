"""Names of what ends a child process."""
from __future__ import annotations

import signal

import pytest

from my_simulations.child_process import signal_name


@pytest.mark.parametrize("number, name", [(signal.SIGKILL, "SIGKILL"), (40, "signal 40")])
def test_a_signal_without_a_name_is_told_by_its_number(number, name):
    assert signal_name(number) == name
