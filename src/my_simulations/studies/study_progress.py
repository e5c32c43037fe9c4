"""Reports the progress of a study: one line that is overwritten, or JSON lines."""
from __future__ import annotations

import json
import time
from typing import TextIO

from .row import OK, Row
from .study_runner import Rate

_EVERY_S = 0.2       # on a terminal
_EVERY_LOG_S = 10.0  # elsewhere


class Progress:
    """Writes progress.

    Args:
        rate: counts the cases.
        stream: where to.
        as_json: one JSON object per line instead of a bar.
    """

    def __init__(self, rate: Rate, stream: TextIO, as_json: bool) -> None:
        self._rate = rate
        self._stream = stream
        self._json = as_json
        self._live = stream.isatty() and not as_json
        self._told = time.monotonic()

    def count_case(self, row: Row) -> None:
        """Count the row of a case that has run; write the progress if it is due."""
        self._rate.add(row)
        now = time.monotonic()
        if now - self._told >= (_EVERY_S if self._live else _EVERY_LOG_S):
            self._told = now
            self._write("\r\033[K" if self._live else "", "" if self._live else "\n")

    def close(self) -> None:
        """Write the last line."""
        if self._rate.done:
            self._write("\r\033[K" if self._live else "", "\n")

    def _write(self, before: str, after: str) -> None:
        rate = self._rate
        if self._json:
            text = json.dumps({"done": rate.done, "cases": rate.total, **rate.counts,
                               "per_second": round(rate.per_second, 2)})
            self._stream.write(text + "\n")
        else:
            others = ", ".join(f"{count} {status}" for status, count in sorted(rate.counts.items())
                               if status != OK)
            shown = progress_bar(rate.done, rate.total)
            self._stream.write(f"{before}{shown} {rate.done}/{rate.total}"
                               f"  {rate.per_second:.1f}/s  {duration_text(rate.seconds_left)} left"
                               + (f"  {others}" if others else "") + after)
        self._stream.flush()


def progress_bar(done: int, total: int, width: int = 24) -> str:
    full = width * done // total if total else width
    return "[" + "#" * full + "." * (width - full) + "]"


def duration_text(seconds: float) -> str:
    """A time as h:mm:ss."""
    if seconds == float("inf"):
        return "?"
    whole = int(seconds + 0.5)
    return f"{whole // 3600}:{whole // 60 % 60:02d}:{whole % 60:02d}"
