"""Finds the fault of a launch file in the output of roslaunch."""
from __future__ import annotations

import os
import re
from typing import NamedTuple, Optional

_LONGEST = 500
_COLOUR = re.compile(r"\x1b\[[0-9;]*m|\x1b\][^\x07]*\x07")
_INVALID = re.compile(r"RLException: ((?:while processing .+:\n)*)(.*)")
_PROCESSED = re.compile(r"while processing (.+):\n")
_DIED = re.compile(r"^.*(?:has died|cannot launch|Resource not found|Invalid <|error loading).*$",
                   re.MULTILINE | re.IGNORECASE)
_LINE = re.compile(r"\bline (\d+)")
_UNWANTED = ("The traceback for the exception was written",)


class LaunchFault(NamedTuple):
    """A fault of a launch file.

    Attributes:
        message: the fault.
        file: path in the submission; "" for the launch file that was started.
        line: in that file, from 1; 0 if it is unknown.
    """

    message: str
    file: str = ""
    line: int = 0


def launch_fault(output: bytes, folder: str) -> Optional[LaunchFault]:
    """Return the first fault that an output of roslaunch names; None for none.

    Args:
        output: what roslaunch has printed.
        folder: of the submission.
    """
    text = _plain(output)
    found = _INVALID.search(text)
    if found is None:
        died = _DIED.search(text)
        return LaunchFault(died[0].strip()[:_LONGEST]) if died else None
    files = _PROCESSED.findall(found[1])
    file = os.path.relpath(files[-1], folder) if files else ""
    if "maximum recursion depth" in found[2] and files:
        return LaunchFault(f"{file} includes itself, directly or by another file", file)
    line = _LINE.search(found[2]) if "XML syntax" in found[2] else None
    return LaunchFault(found[2].strip()[:_LONGEST], file, int(line[1]) if line else 0)


def last_line(output: bytes) -> str:
    """The last line of an output that says something."""
    lines = [line.strip() for line in _plain(output).splitlines()]
    wanted = [line for line in lines if line and not line.startswith(_UNWANTED)]
    return wanted[-1][:_LONGEST] if wanted else "no output"


def _plain(output: bytes) -> str:
    return _COLOUR.sub("", output.decode("utf-8", "replace"))
