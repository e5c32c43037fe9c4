"""The results of a submission as a stream of bytes from the box: JSON lines and files.

{"result": {...}}          a result of a check
{"note": "..."}            a remark
{"isolation": "..."}       how the box is isolated
{"file": NAME, "size": N}  followed by N bytes
{"library": [[PATH, DIGEST], ...]}  other files on which the mark depends
{"end": true}              nothing follows; false if the time was not enough for all checks
"""
from __future__ import annotations

import json
import os
import re
from dataclasses import asdict
from typing import Any, Dict, List, Sequence, Tuple

from .assignment import Check
from .mark import CheckResult

_MOST_BYTES = 200 << 20
_LONGEST_LINE = 1 << 16
_MOST_PER_LINE = 10    # paths, each of 4096 bytes at most
_ROUNDING = 0.005      # of points
_NAME = re.compile(r"[\w][\w.-]{0,60}\Z")


class ResultWriter:
    """Writes the stream to a file descriptor."""

    def __init__(self, descriptor: int) -> None:
        self._stream = os.fdopen(descriptor, "wb")

    def result(self, found: CheckResult) -> None:
        self._line({"result": asdict(found)})

    def note(self, text: str) -> None:
        self._line({"note": text[:1000]})

    def isolation(self, text: str) -> None:
        """Send how the box is isolated."""
        self._line({"isolation": text})

    def library(self, files: Sequence[Tuple[str, str]]) -> None:
        """Send paths and digests of files outside of the submission."""
        for at in range(0, len(files), _MOST_PER_LINE):
            self._line({"library": files[at:at + _MOST_PER_LINE]})

    def file(self, name: str, content: bytes) -> None:
        self._line({"file": name, "size": len(content)})
        self._stream.write(content)
        self._stream.flush()

    def end(self, in_time: bool) -> None:
        """Send that nothing follows, and whether the time was enough for all checks."""
        self._line({"end": in_time})
        self._stream.close()

    def _line(self, value: Dict[str, Any]) -> None:
        self._stream.write(json.dumps(value).encode() + b"\n")
        self._stream.flush()


class ResultReader:
    """Collects the stream.

    Args:
        folder: gets the files.
        checks: the checks that can have results.

    Attributes:
        results, notes, isolation, library: as received.
        files: names of files, which are in the folder.
        ended: whether the end was received.
        timed_out: whether the time was not enough for all checks.
    """

    def __init__(self, folder: str, checks: Sequence[Check]) -> None:
        self._points = {check.name: check.points for check in checks}
        self.results: List[CheckResult] = []
        self.notes: List[str] = []
        self.isolation = ""
        self.files: List[str] = []
        self.library: List[List[str]] = []
        self.ended = self.timed_out = False
        self._folder = folder
        self._waiting = b""
        self._file = ("", 0)
        self._bytes = 0

    def feed(self, data: bytes) -> bool:
        """Take bytes; False if the stream is invalid or too long, and must not be read further."""
        self._bytes += len(data)
        if self._bytes > _MOST_BYTES:
            return False
        self._waiting += data
        try:
            while self._parse_next():
                pass
        except (ValueError, TypeError, KeyError, OSError):
            return False
        return len(self._waiting) < _LONGEST_LINE or bool(self._file[0])

    def _parse_next(self) -> bool:
        """Take one line or one file; False if it is not whole yet."""
        name, size = self._file
        if name:
            if len(self._waiting) < size:
                return False
            self._write(name, self._waiting[:size])
            self._waiting, self._file = self._waiting[size:], ("", 0)
            return True
        line, found, rest = self._waiting.partition(b"\n")
        if not found:
            return False
        self._waiting = rest
        self._line(json.loads(line))
        return True

    def _line(self, value: Dict[str, Any]) -> None:
        if "result" in value:
            found = CheckResult(**value["result"])
            if not 0.0 <= found.points <= found.most + _ROUNDING or (
                    found.most != self._points[found.name]):
                raise ValueError(found)
            self.results.append(found)
        elif "note" in value:
            self.notes.append(str(value["note"]))
        elif "isolation" in value:
            self.isolation = str(value["isolation"])
        elif "library" in value:
            self.library += [[str(path), str(digest)] for path, digest in value["library"]]
        elif "file" in value:
            if not _NAME.match(value["file"]):
                raise ValueError(value["file"])
            self._file = (value["file"], int(value["size"]))
        else:
            self.ended, self.timed_out = True, not value["end"]

    def _write(self, name: str, content: bytes) -> None:
        os.makedirs(self._folder, exist_ok=True)
        with open(os.path.join(self._folder, name), "wb") as stream:
            stream.write(content)
        self.files.append(name)
