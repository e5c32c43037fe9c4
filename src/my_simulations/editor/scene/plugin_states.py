"""The states of plugins as pages get them: running, waiting, failed with the reason."""
from __future__ import annotations

import time
from typing import Any, Callable, Dict, Optional, Sequence

from ...plugins.plugin_state import PluginState
from .plain_json import to_json

_PERIOD_S = 0.5


class PluginStates:
    """Compares the states with those that were last sent. For one thread.

    Args:
        read: returns the states of all plugins.
    """

    def __init__(self, read: Callable[[], Sequence[PluginState]]) -> None:
        self._read = read
        self._sent: Sequence[PluginState] = ()
        self._due = 0.0

    def changes(self) -> Optional[Dict[str, Any]]:
        """Return the push if a state has changed, at most twice a second; else None."""
        if time.monotonic() < self._due:
            return None
        self._due = time.monotonic() + _PERIOD_S
        states = self._read()
        if states == self._sent:
            return None
        self._sent = states
        return self.last_push()

    def last_push(self) -> Dict[str, Any]:
        """Return the push with the states that were last read."""
        return {"type": "plugins", "states": [to_json(state) for state in self._sent]}
