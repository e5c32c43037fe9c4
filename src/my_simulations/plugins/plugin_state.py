"""Whether the plugins of a world run, for front ends."""
from __future__ import annotations

from dataclasses import dataclass

WAITING, RUNNING, FAILED, OFF = "waiting", "running", "failed", "off"


@dataclass(frozen=True)
class PluginState:
    """The state of one plugin.

    Attributes:
        model: name of its model; "" for a plugin of the world.
        name: name of the plugin.
        filename: library of the plugin, as the file says.
        state: `WAITING` until it is loaded, `RUNNING`, `FAILED`, or `OFF` for one without effect.
        reason: why it failed or has no effect; "" otherwise.
    """

    model: str
    name: str
    filename: str
    state: str
    reason: str = ""
