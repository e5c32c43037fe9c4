"""State logs: what moved and what changed, in one file, to be looked at again later.

A file begins with `MAGIC`; each record is a kind (u8), a sim time (f64, s), a size (u32) and so
many bytes: a world document (JSON), all poses, those that moved, contacts (JSON, as the push
`watch` has them), the list of recorded topics (JSON, `Topic` of the protocol), or a message of a
topic (a frame as pages receive it). Contacts and messages belong to the state before them. Little
endian. A file that was cut off by a crash is good up to its last whole record.
"""
from __future__ import annotations

import bisect
import json
import os
import struct
from dataclasses import dataclass
from time import strftime
from typing import Any, BinaryIO, Dict, Iterator, List, Optional, Tuple

from ...errors import CommandError
from ..transport.pose_messages import HEAD_BYTES, LOG, Poses, SentPoses, record_type

FILE = "state.log"
"""What a log is called, in a folder that bears its name (Gazebo behaviour)."""

MAGIC = b"my_simulations state log 1\n"
DOCUMENT, WHOLE, MOVED, CONTACTS, TOPICS, MESSAGE = 1, 2, 3, 4, 5, 6
_STATES, _NOTES = (WHOLE, MOVED), (CONTACTS, TOPICS, MESSAGE)

_RECORD = struct.Struct("<BdI")
_WHOLE_EVERY_S = 5.0
_LARGEST = 256 << 20


def new_name() -> str:
    """The default name of a log: date and time."""
    return strftime("%Y-%m-%dT%H.%M.%S")


class LogWriter:
    """Writes one log. Raises CommandError when that cannot be done."""

    def __init__(self, path: str) -> None:
        self.path = path
        self._sent = SentPoses()
        self._whole_at = float("-inf")
        self.begin: Optional[float] = None
        self.end = 0.0
        self._written = float("-inf")
        self._notes: Dict[int, bytes] = {CONTACTS: b"[]", TOPICS: b"[]"}
        try:
            os.makedirs(os.path.dirname(path), exist_ok=True)
            self._file: BinaryIO = open(path, "xb")
            self._file.write(MAGIC)
        except OSError as fault:
            raise CommandError(f"{path} cannot be written: {fault.strerror}") from fault

    def document(self, time: float, world: Dict[str, Any]) -> None:
        self._write(DOCUMENT, time, json.dumps(world, separators=(",", ":")).encode())
        self._sent.forget()
        self._whole_at = float("-inf")

    def poses(self, poses: Poses) -> None:
        time = poses.sim_time
        whole = not self._whole_at <= time < self._whole_at + _WHOLE_EVERY_S
        if whole:
            self._sent.forget()
            self._whole_at = time
        frame = self._sent.frame(LOG, 0, poses)
        if frame or whole:  # a world without links has states, too
            self._write(WHOLE if whole else MOVED, time, frame[HEAD_BYTES:])
            self._written = time
        self.begin = time if self.begin is None else self.begin
        self.end = time

    def add_record(self, kind: int, time: float, data: bytes) -> None:
        """Add contacts, a list of topics or a message to the last state; s of sim time.

        Contacts and lists are written only if they differ from the last ones. A message that comes
        while nothing moves has a state of its own, without poses: else it would lose its time.
        """
        if self._notes.get(kind) == data:
            return
        if kind != MESSAGE:
            self._notes[kind] = data
        elif time > self._written:
            self._write(MOVED, time, b"")
            self._written = time
        self._write(kind, time, data)

    def flush(self) -> None:
        """Make what was written so far survive the end of this process. Raises CommandError."""
        try:
            self._file.flush()
        except OSError as fault:
            raise CommandError(f"{self.path} cannot be written: {fault.strerror}") from fault

    def close(self) -> None:
        """Nothing more comes. Raises CommandError when not all of it could be written."""
        try:
            if self.begin is not None and self.end > self._written:  # nothing has moved since
                self._write(MOVED, self.end, b"")
        finally:
            try:
                self._file.close()
            except OSError as fault:
                raise CommandError(f"{self.path} is incomplete: {fault.strerror}") from fault

    def _write(self, kind: int, time: float, data: bytes) -> None:
        try:
            self._file.write(_RECORD.pack(kind, time, len(data)) + data)
        except OSError as fault:
            raise CommandError(f"{self.path} cannot be written: {fault.strerror}") from fault


@dataclass(frozen=True)
class _Record:
    kind: int
    time: float
    at: int
    size: int


class LogReader:
    """Reads one log. For one thread at a time.

    Attributes:
        begin, end: sim time, s. What follows a reset of sim time is after what was before it.

    Raises:
        CommandError: no such file, or not a log.
    """

    def __init__(self, path: str) -> None:
        try:
            self._file = open(path, "rb")
        except OSError as fault:
            raise CommandError(f"{path} cannot be read: {fault.strerror}") from fault
        if self._file.read(len(MAGIC)) != MAGIC:
            self._file.close()
            raise CommandError(f"{path} is not a state log")
        self._records = self._scan(os.fstat(self._file.fileno()).st_size)
        self._states = [n for n, record in enumerate(self._records) if record.kind in _STATES]
        if not self._states:
            self._file.close()
            raise CommandError(f"{path} contains no states")
        self._times = _log_times([self._records[n].time for n in self._states])
        self.begin, self.end = self._times[0], self._times[-1]
        self._poses: Dict[int, Any] = {}
        self._at = -1

    def close(self) -> None:
        """Give the file back."""
        self._file.close()

    def times(self, period: float) -> List[float]:
        """The times of states at least `period` apart, s: the first and last one, and the first one
        after each document.
        """
        found: List[float] = []
        before = -1
        for state, time in zip(self._states, self._times):
            kinds = [record.kind for record in self._records[before + 1:state]]
            before = state
            if not found or DOCUMENT in kinds or time >= found[-1] + period - 1e-9:
                found.append(time)
        return found if found[-1] == self.end else [*found, self.end]

    def seek(self, time: float) -> Tuple[int, Poses]:
        """The number of the document that holds at a time, and the poses then."""
        import numpy as np

        position = max(0, bisect.bisect_right(self._times, time) - 1)
        target = self._states[position]
        start = self._start(target)
        if not start <= self._at <= target:
            self._at = start - 1
        for n in range(self._at + 1, target + 1):
            self._apply(self._records[n])
        self._at = target
        ids = np.fromiter(self._poses, dtype=np.int64, count=len(self._poses))
        values = np.array(list(self._poses.values()), dtype=np.float32).reshape(-1, 7)
        shown = min(max(time, self.begin), self.end)
        return self._document_at(target), Poses(ids, values, position, shown, shown)

    def records(self, after: int, upto: int) -> Iterator[Tuple[int, bytes]]:
        """Kind and content of all contacts, lists of topics and messages of some states.

        Args:
            after: number of the last state (`Poses.step` of `seek`) whose notes are not wanted; -1
                for none.
            upto: number of the last state whose notes are wanted.
        """
        begin = self._states[after + 1] if after >= 0 else 0
        end = self._states[upto + 1] if upto + 1 < len(self._states) else len(self._records)
        for record in self._records[begin:end]:
            if record.kind in _NOTES:
                yield record.kind, self._bytes(record)

    def text(self, number: int) -> bytes:
        """The JSON of the world document of that number."""
        if number < 0:
            raise CommandError("the log contains no world")
        return self._bytes(self._records[number])

    def _start(self, target: int) -> int:
        """The last record with all poses, up to `target`."""
        while target > 0 and self._records[target].kind != WHOLE:
            target -= 1
        return target

    def _document_at(self, target: int) -> int:
        while target >= 0 and self._records[target].kind != DOCUMENT:
            target -= 1
        return target

    def _apply(self, record: _Record) -> None:
        import numpy as np

        if record.kind not in _STATES:
            return
        table = np.frombuffer(self._bytes(record), dtype=record_type())
        if record.kind == WHOLE:
            self._poses = {}
        for known, pose in zip(table["id"].tolist(), table["pose"]):
            self._poses[known] = pose

    def _bytes(self, record: _Record) -> bytes:
        self._file.seek(record.at)
        return self._file.read(record.size)

    def _scan(self, size: int) -> List[_Record]:
        found: List[_Record] = []
        at = len(MAGIC)
        while True:
            self._file.seek(at)
            head = self._file.read(_RECORD.size)
            if len(head) < _RECORD.size:
                return found
            kind, time, length = _RECORD.unpack(head)
            at += _RECORD.size
            if kind not in (DOCUMENT, *_STATES, *_NOTES) or length > _LARGEST or at + length > size:
                return found  # cut off, or no record
            found.append(_Record(kind, time, at, length))
            at += length


def _log_times(times: List[float]) -> List[float]:
    """The sim times, s, but after a reset of sim time they go on from where they were.

    So every state has a time of its own, and what was recorded first is shown first.
    """
    offset = 0.0
    previous = times[0]
    found = []
    for time in times:
        offset += max(0.0, previous - time)
        found.append(time + offset)
        previous = time
    return found
