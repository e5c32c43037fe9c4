"""A tool that pauses the world leaves it running, whatever ends the tool."""
from __future__ import annotations

import os
import signal
from types import SimpleNamespace

import pytest

from my_simulations.cli.object_client import SimulatorClient


class Client(SimulatorClient):
    """A client without a server; a signal arrives while the world is being unpaused."""

    def __init__(self, late=None):
        self.replaces = True
        self.called = []
        self._late = late

    def _call(self, service, kind, **fields):
        self.called.append(service)
        if service == "unpause_physics" and self._late is not None:
            os.kill(os.getpid(), self._late)
        return SimpleNamespace(pause=False)


@pytest.mark.parametrize("late", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
@pytest.mark.parametrize("first", [None, signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_signals_leave_the_world_running(first, late):
    client, handlers = Client(late), {one: signal.getsignal(one) for one in signal.Signals}
    if first is None:
        with client.paused():
            pass
    else:
        with pytest.raises(KeyboardInterrupt), client.paused():
            os.kill(os.getpid(), first)
    assert client.called[-2:] == ["pause_physics", "unpause_physics"]
    assert {one: signal.getsignal(one) for one in signal.Signals} == handlers


def test_a_tool_that_nohup_protects_is_not_ended():
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with Client().paused():
            os.kill(os.getpid(), signal.SIGHUP)
    finally:
        signal.signal(signal.SIGHUP, before)
