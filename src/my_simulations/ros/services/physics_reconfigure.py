"""The dynamic_reconfigure server of the physics settings.

Debian's `dynamic_reconfigure` provides the messages; its own server class calls the parameter
server thirty times at the start and closes the connection on invalid requests.
"""
from __future__ import annotations

import threading
from typing import Any, Dict, Optional

import dynamic_reconfigure.msg
import rospy

from ...errors import CommandError
from ...plugins.reconfigure_options import OptionError, OptionMessages, Value
from ...simulator.simulator import Simulator
from ..registration import advertise_topic
from .physics_parameters import PARAMETERS, change_parameters, current_parameters


class ReconfigureServer:
    """Publishes and changes the physics parameters as dynamic_reconfigure does."""

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator
        self._messages = OptionMessages(PARAMETERS, _message)
        self._lock = threading.Lock()
        self._told: Dict[str, Value] = {}
        self._stored: Optional[Dict[str, Value]] = None
        self._descriptions = advertise_topic("parameter_descriptions", queue_size=10, latch=True)
        self._updates = advertise_topic("parameter_updates", queue_size=10, latch=True)
        self._descriptions.publish(self._messages.description())
        self._publish_changes()

    def set(self, request: Any, response: Any) -> str:
        """Set the parameters of the request, clamped to their ranges.

        Raises CommandError: an unknown parameter, or a value that is not finite.
        """
        try:
            wanted = self._messages.read(request.config)
        except OptionError as fault:
            raise CommandError(str(fault)) from fault
        change_parameters(self._simulator, wanted)
        self._publish_changes()
        response.config = self._messages.config(current_parameters(self._simulator))
        return ""

    def refresh(self) -> None:
        """Publish changes made by other means, and update the parameter server.

        Raises OSError: the master does not respond; the next call tries again.
        """
        self._publish_changes()
        with self._lock:
            values, before = self._told, self._stored or {}
            for name, value in values.items():
                if before.get(name) != value:
                    rospy.set_param(f"~{name}", value)
            self._stored = values

    def forget_stored(self) -> None:
        """Make the next `refresh` store all values again, on a new parameter server."""
        with self._lock:
            self._stored = None

    def _publish_changes(self) -> None:
        with self._lock:
            values = current_parameters(self._simulator)
            if values != self._told:
                self._told = values
                self._updates.publish(self._messages.config(values))


def _message(kind: str) -> Any:
    """A message of a type such as `dynamic_reconfigure/Config`."""
    return getattr(dynamic_reconfigure.msg, kind.rpartition("/")[2])()
