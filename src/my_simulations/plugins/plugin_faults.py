"""Calls plugins; one that raises an exception or does not return is reported and switched off."""
from __future__ import annotations

import os
import sysconfig
import traceback
from typing import Any, Callable, Optional, Sequence

from ..errors import CommandError, Issue, Severity, warning
from .call_watch import CallLimits, CallOverdue, CallWatch, ThreadAbandoned
from .context import PluginError
from .found_plugins import owner_text
from .nested_turns import PluginRemovedError
from .registry import library_name
from .running import RunningPlugin

LONGEST_TEXT = 500
"""Characters of an exception's message that are reported."""

_OWN_FILES = ("<frozen importlib", __file__.rpartition("plugins")[0])
_LIBRARIES = ("<frozen", os.path.join(sysconfig.get_path("stdlib"), ""))
_INSTALLED = ("/site-packages/", "/dist-packages/")


class DescribedFaultError(PluginError):
    """An exception of another process; the message is that of `describe_fault` there."""


def describe_fault(fault: BaseException) -> str:
    """Type, message, and the innermost function, file and line of the plugin.

    The message of a `PluginError` that a plugin raises is one sentence for the user, and stands
    alone.
    """
    if isinstance(fault, DescribedFaultError):
        return str(fault)
    text = _message_of(fault)
    if isinstance(fault, PluginError):
        return text + _call_of_plugin(traceback.extract_tb(fault.__traceback__))
    name = type(fault).__name__
    said = f"{name}: {text}" if text else name
    if isinstance(fault, SyntaxError) and fault.filename:
        return f"{name}: {shorten(str(fault.msg))} (in {fault.filename}:{fault.lineno})"
    frames = traceback.extract_tb(fault.__traceback__)
    if not frames:
        return said
    frame = innermost_of_plugin(frames)
    return f"{said} (in {frame.name}, {frame.filename}:{frame.lineno})"


def innermost_of_plugin(frames: Sequence[traceback.FrameSummary]) -> traceback.FrameSummary:
    """The innermost frame that is not in a library; else the innermost one outside this package."""
    outside = [one for one in frames if not one.filename.startswith(_OWN_FILES)]
    own = [one for one in outside if not one.filename.startswith(_LIBRARIES)
           and not any(folder in one.filename for folder in _INSTALLED)]
    return (own or outside or frames)[-1]


def _call_of_plugin(frames: Sequence[traceback.FrameSummary]) -> str:
    """` (in f, file:line)` of the plugin whose call of the simulator failed; "" for none."""
    if not frames or not frames[-1].filename.startswith(_OWN_FILES):
        return ""
    frame = innermost_of_plugin(frames)
    return "" if frame.filename.startswith(_OWN_FILES) else (
        f" (in {frame.name}, {frame.filename}:{frame.lineno})")


def shorten(text: str) -> str:
    """Return the first `LONGEST_TEXT` characters of a text and the number of the others."""
    more = len(text) - LONGEST_TEXT
    return text if more <= 0 else f"{text[:LONGEST_TEXT]}... ({more} more characters)"


def _message_of(fault: BaseException) -> str:
    try:
        return shorten(str(fault))
    except BaseException as second:  # an exception of a plugin may have any __str__
        return f"its message cannot be read ({type(second).__name__})"


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
            f" of {owner_text(context.model)} is switched off: {why}", spec.file, spec.line)
        self._log(running.fault)
        running.plugin = None
        running.end()
        context.close()
        self._mark_output(running)
        try:
            context.stop()
        except CommandError as fault:
            self._log(warning("plugin-order", f"its motors could not be switched off: {fault}"))
