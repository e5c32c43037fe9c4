"""How far a tool is: a bar on a terminal when there is much to do, plain lines otherwise."""
from __future__ import annotations

import shutil
import sys
from typing import Optional, TextIO

MANY = 10
"""Up to this many pieces of work, the lines themselves show the progress."""


def bar(done: int, total: int, label: str, columns: int) -> str:
    """One line such as `[####....] 12/40 name`, no longer than `columns`."""
    count = f" {done}/{total} "
    width = max(4, min(40, columns - len(count) - 20))
    filled = width * done // total if total else width
    return ("[" + "#" * filled + "." * (width - filled) + "]" + count + label)[:max(1, columns - 1)]


class Progress:
    """Writes lines to `out`, and a bar to `err` where that is a terminal."""

    def __init__(self, total: int, out: Optional[TextIO] = None,
                 err: Optional[TextIO] = None) -> None:
        self._total = total
        self._done = 0
        self._out = out or sys.stdout
        self._err = err or sys.stderr
        self._bar = total > MANY and self._err.isatty()

    def start(self, label: str) -> None:
        """Shows what is being worked on."""
        if self._bar:
            columns = shutil.get_terminal_size().columns
            self._err.write("\r\033[K" + bar(self._done, self._total, label, columns))
            self._err.flush()

    def done(self, line: str) -> None:
        """Counts one piece; its line is left out where the bar shows it."""
        self._done += 1
        if not self._bar:
            print(line, file=self._out, flush=True)

    def failed(self, line: str) -> None:
        """Counts one piece that went wrong; its line always shows."""
        self._done += 1
        self._clear()
        print(line, file=self._err, flush=True)

    def end(self, line: str) -> None:
        """Replaces the bar by a last line; without a bar nothing is written."""
        if self._bar:
            self._clear()
            print(line, file=self._out, flush=True)

    def _clear(self) -> None:
        if self._bar:
            self._err.write("\r\033[K")
            self._err.flush()
