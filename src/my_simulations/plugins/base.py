"""The base class of plugins.

A plugin is made once for each `<plugin>` element of a model or sensor. In `load` it reads its
parameters, schedules calls, and makes topics and handles. Later the functions run that it handed to
the context.
"""
from __future__ import annotations

from .context import Context


class Plugin:
    """A plugin of a model or of a sensor.

    An exception from any of its functions is reported with file and line of the `<plugin>` element
    and of the Python code, and switches this one plugin off; the world goes on. Raise `PluginError`
    for what is the user's fault: its message is shown without a traceback.
    """

    def __init__(self, context: Context) -> None:
        self.context = context

    def load(self) -> None:
        """Read parameters, find joints, offer topics, schedule calls."""
        raise NotImplementedError

    def reset(self) -> None:
        """The world was reset: models are where they began, at rest, and motors are off."""

    def clock_set(self) -> None:
        """Sim time was set, to an earlier one perhaps; calls are scheduled again."""

    def close(self) -> None:
        """The model is being deleted, or the program ends. Topics are closed afterwards."""
