"""pal_ros_controllers/CurrentLimitController: limits of the currents of motors.

Parameters and topic are those of PAL's controller. Motors have no current here, so the limits have
no effect; a message that does not name all actuators is reported, as there.
"""
from __future__ import annotations

from typing import Any

from ..context import PluginError
from .controller import Controller

_MESSAGE = "pal_control_msgs/ActuatorCurrentLimit"


class CurrentLimitController(Controller):
    """Checks the names in messages on `command`; the current limits have no effect."""

    def load(self) -> None:
        self._names = set(self.settings.texts("actuators"))
        try:
            self.subscribe("command", _MESSAGE, self._receive, checks=True)
        except PluginError as missing:
            self.context.info(f"controller '{self.name}' has no topic: {missing}")

    def _receive(self, message: Any) -> None:
        if set(message.actuator_names) != self._names:
            self.context.warn(f"controller '{self.name}' ignores limits that are not of the"
                              f" actuators {', '.join(sorted(self._names))}")
