"""Progress of a tool: a bar on a terminal for many items, else one line per item."""
from __future__ import annotations

import shutil
import sys
from typing import Optional, TextIO

MANY = 10
"""Up to this many items, there is no progress bar, and the world is not paused meanwhile."""


def bar(done: int, total: int, label: str, columns: int) -> str:
    """One line such as `[####....] 12/40 name`, no longer than `columns`."""
    count = f" {done}/{total} "
    width = max(4, min(40, columns - len(count) - 20))
    filled = width * done // total if total else width
    return ("[" + "#" * filled + "." * (width - filled) + "]" + count + label)[:max(1, columns - 1)]


class Progress:
    """Writes lines to `out`, and a bar to `err` if that is a terminal."""

    def __init__(self, total: int, out: Optional[TextIO] = None,
                 err: Optional[TextIO] = None) -> None:
        self._total = total
        self._done = 0
        self._out = out or sys.stdout
        self._err = err or sys.stderr
        self._bar = total > MANY and self._err.isatty()

    def start(self, label: str) -> None:
        """Show the current item."""
        if self._bar:
            columns = shutil.get_terminal_size().columns
            self._err.write("\r\033[K" + bar(self._done, self._total, label, columns))
            self._err.flush()

    def done(self, line: str) -> None:
        """Count an item; prints its line unless there is a bar."""
        self._done += 1
        if not self._bar:
            print(line, file=self._out, flush=True)

    def failed(self, line: str) -> None:
        """Count a failed item; always prints its line."""
        self._done += 1
        self._clear()
        print(line, file=self._err, flush=True)

    def end(self, line: str) -> None:
        """Replace the bar by a final line; prints nothing without a bar."""
        if self._bar:
            self._clear()
            print(line, file=self._out, flush=True)

    def _clear(self) -> None:
        if self._bar:
            self._err.write("\r\033[K")
            self._err.flush()
