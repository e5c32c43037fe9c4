"""The journal of a study: one line of JSON for each finished case, only ever appended to.

It is the truth: tables and reports are made from it. A line is handed to the kernel in one
`write` as soon as its case has finished, so that it survives any death of the process. Once a
second, and at the end, the file is forced to the disk (fsync), so that a loss of power costs the
cases of the last second; they run again.

A line that has no end was being written when the machine stopped; it is cut off when the journal is
opened to go on. The first line says which study it is.
"""
from __future__ import annotations

import fcntl
import json
import os
import threading
import time
from typing import Any, Dict, Iterator, List, Optional, Sequence, Set, Tuple

from ..errors import CommandError
from .row import STATUSES, Row, row_of

FORMAT = 1
_FSYNC_S = 1.0
_STATUS_AT = len('{"status":"')  # where the status stands in a row


class Journal:
    """A journal that is open for writing, by one process at a time.

    Args:
        path: of the file.
        header: the first line of a new journal.

    Raises:
        CommandError: another process writes it, or it is of another study.
    """

    def __init__(self, path: str, header: Dict[str, Any]) -> None:
        self.path = path
        self._lock = threading.Lock()
        self._fault: Optional[OSError] = None  # of the first row that could not be written
        self._file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_APPEND | os.O_CLOEXEC, 0o666)
        self._synced = time.monotonic()
        try:
            try:
                fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                raise CommandError(f"another process is writing {path}") from None
            _cut_unfinished_line(self._file)
            if os.fstat(self._file).st_size == 0:
                self._write({"journal": FORMAT, **header})
            elif header_of(path)["study"] != header["study"]:
                raise CommandError(f"{path} is of study '{header_of(path)['study']}'; name another"
                                   " folder with --out")
        except BaseException:
            os.close(self._file)
            raise

    def append(self, rows: List[Row]) -> None:
        """Add rows, in one write.

        Raises OSError if they cannot be written, such as on a full disk. Nothing is left of them
        then, and every later call raises the same: the study ends, and can be resumed.
        """
        with self._lock:
            self._append("".join(row.line() for row in rows).encode())
            if time.monotonic() - self._synced > _FSYNC_S:
                os.fsync(self._file)
                self._synced = time.monotonic()

    def close(self) -> None:
        """Force everything to the disk and close it."""
        with self._lock:
            os.fsync(self._file)
            os.close(self._file)

    def _write(self, value: Dict[str, Any]) -> None:
        self._append((json.dumps(value) + "\n").encode())

    def _append(self, data: bytes) -> None:
        if self._fault is not None:
            raise self._fault
        size = os.fstat(self._file).st_size
        try:
            while data:  # a full disk may take a part
                data = data[os.write(self._file, data):]
        except OSError as fault:
            self._fault = fault
            os.ftruncate(self._file, size)
            raise


def has_header(path: str) -> bool:
    """Whether the first line of a file has been written. Raises CommandError if it is no file."""
    try:
        with open(path, "rb") as stream:
            return stream.readline().endswith(b"\n")
    except OSError as fault:
        raise CommandError(f"{path} cannot be read: {fault.strerror}") from None


def header_of(path: str) -> Dict[str, Any]:
    """The first line of a journal. Raises CommandError if it is none."""
    try:
        with open(path, "rb") as stream:
            header = json.loads(stream.readline())
        if header["journal"] != FORMAT:
            raise ValueError(f"its format is {header['journal']}")
    except (OSError, ValueError, KeyError, TypeError) as fault:
        raise CommandError(f"{path} is not the journal of a study: {fault}") from None
    return dict(header)


def read_rows(path: str) -> Iterator[Tuple[int, bytes]]:
    """Yield the offset and the text of each complete row, without the header."""
    with open(path, "rb") as stream:
        offset = len(stream.readline())
        for line in stream:
            if line.endswith(b"\n"):
                yield offset, line
            offset += len(line)


def rows(path: str) -> Iterator[Row]:
    """The rows, in the order in which cases finished. Raises CommandError for a broken line."""
    for offset, line in read_rows(path):
        try:
            yield row_of(line)
        except (ValueError, TypeError, KeyError, AttributeError) as fault:
            raise CommandError(f"{path}: the line at byte {offset} is no row: {fault}") from None


def statuses(paths: Sequence[str]) -> Dict[int, str]:
    """The status of each case that has a row, by its id as a number, which needs less memory.

    Of two rows of one case the last counts. Raises CommandError for a broken line.
    """
    known = {status.encode(): status for status in STATUSES}
    found: Dict[int, str] = {}
    for path in paths:
        for offset, line in read_rows(path):
            at = line.find(b'"case":"') + 8
            try:
                status = known[line[_STATUS_AT:line.index(b'"', _STATUS_AT)]]
                found[int(line[at:at + 16], 16)] = status
            except (ValueError, KeyError) as fault:
                raise CommandError(f"{path}: the line at byte {offset} is no row: {fault}"
                                   ) from None
    return found


def finished_cases(path: str, retried: Sequence[str] = ()) -> Set[int]:
    """The ids of the cases that have a row whose status is not among `retried`, as numbers."""
    return {case for case, status in statuses([path]).items() if status not in retried}


def _cut_unfinished_line(file: int) -> None:
    size = os.fstat(file).st_size
    at = size
    while at > 0:
        begin = max(0, at - 65536)
        found = os.pread(file, at - begin, begin).rfind(b"\n")
        if found >= 0:
            at = begin + found + 1
            break
        at = begin
    if at < size:
        os.ftruncate(file, at)
