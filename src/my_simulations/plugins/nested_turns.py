"""Lets the world continue while one plugin computes for long in its own process.

The host waits for the process of a plugin in each call. After `_HOLD_S` the host takes further
turns inside that wait: the engine makes steps, and the other plugins are called. The plugin is not
called again before its call has ended, or was ended because it took too long.
"""
from __future__ import annotations

from typing import Callable, List

from .context import PluginError
from .running import RunningPlugin

_HOLD_S = 0.75      # how long the world waits for one plugin, after the first check of the call
_WAIT_S = 0.02      # between two checks of the process, if the engine does not notify the host
_MOST = 8           # calls that are under way at the same time, one inside the wait of the other


class PluginRemovedError(PluginError):
    """The model of a plugin was deleted during a call of the plugin."""


class NestedTurns:
    """Turns inside the wait for a plugin. For the thread of the host.

    Attributes:
        busy: plugins whose calls are under way; each was called in a turn inside the one before.

    Args:
        turn: takes a turn.
        wait: waits for the engine, or for a time in s.
        stands: whether the world advances on request only; it then waits for its plugins.
        is_present: whether a plugin still belongs to a model of the world.
        resume: called with a plugin after each turn, before its call continues.
    """

    def __init__(self, turn: Callable[[], None], wait: Callable[[float], bool],
                 stands: Callable[[], bool], is_present: Callable[[RunningPlugin], bool],
                 resume: Callable[[RunningPlugin], None]) -> None:
        self._turn, self._wait, self._stands = turn, wait, stands
        self._is_present, self._resume = is_present, resume
        self.busy: List[RunningPlugin] = []

    def take_turn(self, running: RunningPlugin, waited: float) -> bool:
        """Take a turn if `running` has taken `waited` s; returns whether it did.

        Raises PluginRemovedError.
        """
        if self._stands() or len(self.busy) >= _MOST or (
                waited < _HOLD_S and not self.busy):
            return False
        running.is_busy = True
        self.busy.append(running)
        try:
            self._wait(_WAIT_S)
            self._turn()
        finally:
            self.busy.pop()
            running.is_busy = False
        if not self._is_present(running):
            raise PluginRemovedError("its model was deleted")
        self._resume(running)
        return True
