"""Calls plugins; one that raises an exception or does not return is reported and switched off."""
from __future__ import annotations

from typing import Any, Callable, Optional

from ..errors import CommandError, Issue, Severity, warning
from .call_watch import CallLimits, CallOverdue, CallWatch, ThreadAbandoned
from .nested_turns import PluginRemovedError
from .plugin_faults import describe_fault
from .registry import library_name
from .running import RunningPlugin


class PluginGuard:
    """Makes the calls of the host's thread into plugins.

    Args:
        log: receives the faults.
        limits: how long a call may take.
        mark_output: called before each call into a plugin, and after it was switched off.
        abandon: called, in another thread, with a plugin that does not return, and the reason. The
            thread that called it will raise `ThreadAbandoned` if it returns.
    """

    def __init__(self, log: Callable[[Issue], None], limits: CallLimits,
                 mark_output: Callable[[RunningPlugin], None],
                 abandon: Callable[[RunningPlugin, str], None]) -> None:
        self._log, self._limits, self._mark_output = log, limits, mark_output
        self._watch = CallWatch(abandon)

    def stop(self) -> None:
        self._watch.stop()

    def run_inside(self, turn: Callable[[], None]) -> None:
        """Make a turn with further calls inside the wait for the process of a plugin."""
        self._watch.run_inside(turn)

    def call(self, running: RunningPlugin, call: Callable[..., None], *arguments: Any,
             limits: Optional[CallLimits] = None) -> bool:
        """Call a function of a plugin; returns whether the plugin still works.

        Raises ThreadAbandoned in a thread that must end.
        """
        self._mark_output(running)
        return self._run(running, limits or self._limits, call, *arguments)

    def send(self, running: RunningPlugin, call: Callable[..., None], *arguments: Any) -> bool:
        """As `call`, for a function that only sends messages, after which nothing is collected."""
        return self._run(running, self._limits, call, *arguments)

    def _run(self, running: RunningPlugin, limits: CallLimits, call: Callable[..., None],
             *arguments: Any) -> bool:
        try:
            self._watch.run(running, limits, call, *arguments)
            return True
        except ThreadAbandoned:
            raise
        except PluginRemovedError:   # it was ended with its model
            pass
        except CallOverdue as overdue:
            self.switch_off(running, str(overdue))
        except BaseException as fault:  # sys.exit() of a plugin, too: the others continue
            self.switch_off(running, describe_fault(fault))
        return False

    def switch_off(self, running: RunningPlugin, why: str) -> None:
        """Report a plugin, and end what it does; the world continues."""
        spec, context = running.found.spec, running.context
        running.fault = Issue(
            Severity.ERROR, "plugin-failed", f"plugin '{spec.name}' ({library_name(spec.filename)})"
            f" of model '{context.model}' is switched off: {why}", spec.file, spec.line)
        self._log(running.fault)
        running.plugin = None
        running.end()
        context.close()
        self._mark_output(running)
        try:
            context.stop()
        except CommandError as fault:
            self._log(warning("plugin-order", f"its motors could not be switched off: {fault}"))
