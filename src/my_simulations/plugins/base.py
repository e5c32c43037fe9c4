"""The base class of plugins.

One plugin object is made for each `<plugin>` element of a model or sensor. In `load` it reads its
parameters, schedules calls, and makes topics and handles. Later the context calls the functions
that the plugin registered.
"""
from __future__ import annotations

import inspect
from typing import Tuple

from ..description.sensor import Sensor
from .context import Context, PluginError
from .parameters import Parameters


class Plugin:
    """A plugin of a model or of a sensor.

    An exception from any of its functions is reported with file and line of the `<plugin>` element
    and of the Python code, and switches this one plugin off; the world continues. Raise
    `PluginError` for an error of the user: its message is shown without a traceback.
    """

    def __init__(self, context: Context) -> None:
        self.context = context

    def load(self) -> None:
        """Read parameters, find joints, advertise topics, schedule calls."""
        own = type(self)
        raise PluginError(f"the class '{own.__name__}' in {inspect.getfile(own)} has no method"
                          " 'load'")

    def enter_namespace(self, default: str = "",
                        empty_means_model: bool = False) -> Tuple[Context, Parameters]:
        """Make names relative to `<robotNamespace>`; return the context and its parameters.

        Args:
            default: the namespace if the element is missing or empty; "" for that of the node.
            empty_means_model: an empty element means the model's name instead.
        """
        context, p = self.context, self.context.parameters
        if empty_means_model and "robotNamespace" in p:
            default = context.model
        context.use_namespace(p.text("robotNamespace") or default)
        return context, p

    def required_text(self, name: str) -> str:
        """Return the text of a child element. Raises PluginError if it is missing or empty."""
        found = self.context.parameters.text(name)
        if not found:
            raise PluginError(f"it has no <{name}>")
        return found

    def required_sensor(self, kind: str) -> Sensor:
        """Return the sensor with the plugin. Raises PluginError, which names a kind."""
        sensor = self.context.sensor
        if sensor is None:
            raise PluginError(f"it must be in a <sensor> of type {kind}")
        return sensor

    def reset(self) -> None:
        """React to a reset: models are at their initial poses, at rest, and motors are off."""

    def clock_set(self) -> None:
        """React after sim time was set back; calls are scheduled again."""

    def close(self) -> None:
        """Release resources before the model is deleted or the program ends. Topics close later."""
