"""Whether the plugins of a world run, for front ends."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Tuple

WAITING, RUNNING, FAILED, OFF = "waiting", "running", "failed", "off"


@dataclass(frozen=True)
class PluginParameter:
    """A parameter that a plugin reads from its element.

    Attributes:
        name: name of the child element.
        type: "number", "integer", "flag", "text" or "choice".
        default: value without the element, as an SDF file writes it.
        choices: the allowed words of a "choice".
    """

    name: str
    type: str
    default: str
    choices: Tuple[str, ...] = ()


@dataclass(frozen=True)
class PluginState:
    """The state of one plugin.

    Attributes:
        model: name of its model; "" for a plugin of the world.
        name: name of the plugin.
        filename: library of the plugin, as the file says.
        state: `WAITING` until it is loaded, `RUNNING`, `FAILED`, or `OFF` for one without effect.
        reason: why it failed or has no effect; "" otherwise.
        parameters: what it has read until now, in this order; none before it is loaded.
    """

    model: str
    name: str
    filename: str
    state: str
    reason: str = ""
    parameters: Tuple[PluginParameter, ...] = ()
