"""Exceptions of plugins as text for the user."""
from __future__ import annotations

import os
import sysconfig
import traceback
from typing import Sequence

from .context import PluginError

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
        return f"{name}: {shortened(str(fault.msg))} (in {fault.filename}:{fault.lineno})"
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


def shortened(text: str) -> str:
    """The first `LONGEST_TEXT` characters, and how many more there are."""
    more = len(text) - LONGEST_TEXT
    return text if more <= 0 else f"{text[:LONGEST_TEXT]}... ({more} more characters)"


def _message_of(fault: BaseException) -> str:
    try:
        return shortened(str(fault))
    except BaseException as second:  # an exception of a plugin may have any __str__
        return f"its message cannot be read ({type(second).__name__})"
