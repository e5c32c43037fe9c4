"""Reads meshes and pictures from untrusted sources in a process of its own, under limits.

A small file can make its reader use any amount of memory and time: an image expands a thousandfold,
a mesh names its own parts again and again. Only files that could do so are read here; which they
are is decided by those who read them, from size and header. The process is started with the first
of them, serves the next ones, and is ended when there are none for a while.

Its answers are JSON and arrays, never pickles: a decoder that a file has taken over must not gain
control of this process.
"""
from __future__ import annotations

import functools
import json
import os
import signal
import struct
import subprocess
import threading
import time
from typing import Any, Dict, List, Tuple

from ..child_process import child_command, child_environment, wait_or_kill
from ..errors import InputError, Issue, Severity, error
from ..readable import wait_until_readable

MEMORY, SECONDS, DEADLINE_S = 1 << 30, 4, 300.0
"""Limits of a small file: bytes, s of processor time, and s of wall time on a busy machine."""

_MEMORY_PER_BYTE, _BYTES_PER_SECOND = 16, 5_000_000
_KINDS = {"<f8", "<i8", "<i4", "<u2", "|u1", "|b1"}
_LENGTH = struct.Struct("<Q")
_LONGEST_HEADER = 64 << 20
_KEPT_S = 20.0
_END_S = 1.0  # how long the child may take to end by itself

Answer = Tuple[Any, List[Any]]
"""A value of JSON, and arrays."""


def read_elsewhere(task: str, path: str, code: str, **options: Any) -> Answer:
    """Have another process read a file.

    Args:
        task: name of a function in `reader_worker`.
        path: the file.
        code: of the issue that reports exceeded limits.
        options: for the task, as JSON.

    Raises:
        InputError: what the reader said, or limits that were exceeded.
    """
    size = os.path.getsize(path) if os.path.isfile(path) else 0
    request = {"task": task, "path": path, "options": options,
               "memory": MEMORY + _MEMORY_PER_BYTE * size,
               "seconds": SECONDS + size // _BYTES_PER_SECOND}
    header, arrays = kept().send_request(request, path, code)
    if "issues" in header:
        raise InputError([Issue(**{**issue, "severity": Severity(issue["severity"])})
                          for issue in header["issues"]])
    return header["value"], arrays


class _GoneError(Exception):
    """The process ended before it answered."""


_GONE = (_GoneError, ValueError, TypeError, LookupError, AttributeError)
"""The same, or an invalid answer."""


class ReaderProcess:
    """One child at most; one file at a time. Safe from any thread."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._child: Any = None
        self._last = 0.0
        self._keeper: Any = None

    def send_request(self, request: Dict[str, Any], path: str, code: str) -> Tuple[Any, List[Any]]:
        """The answer to a request. Raises InputError if limits were exceeded."""
        until = time.monotonic() + DEADLINE_S + request["seconds"]
        with self._lock:
            fresh = self._child is None
            try:
                return self._answer(request, until)
            except _GONE:
                status = self._end()
            if not fresh and status == 0:  # it ended by itself after a large file before this one
                try:
                    return self._answer(request, until)
                except _GONE:
                    status = self._end()
        raise InputError([error(code, f"it cannot be read: {_why(status, request)}", file=path)])

    @property
    def pid(self) -> int:
        """Process id of the child; 0 if there is none."""
        child = self._child
        return child.pid if child is not None else 0

    def close(self) -> None:
        with self._lock:
            self._end()

    def _answer(self, request: Dict[str, Any], until: float) -> Tuple[Any, List[Any]]:
        import numpy as np

        child = self._start_worker()
        try:
            child.stdin.write(json.dumps(request).encode() + b"\n")
            child.stdin.flush()
        except OSError:
            raise _GoneError from None
        (length,) = _LENGTH.unpack(self._read(_LENGTH.size, until))
        if length > _LONGEST_HEADER:
            raise _GoneError
        header = json.loads(self._read(length, until))
        arrays, total = [], 0
        for kind, shape in header.pop("arrays", []):
            count = int(np.prod([int(n) for n in shape], dtype=object)) if shape else 1
            total += count * 8
            if kind not in _KINDS or count < 0 or total > 8 * request["memory"]:
                raise _GoneError
            data = self._read(count * np.dtype(kind).itemsize, until)
            arrays.append(np.frombuffer(data, dtype=kind).reshape(shape))
        self._schedule_end()
        return header, arrays

    def _read(self, size: int, until: float) -> bytearray:
        data = bytearray(size)
        view, at = memoryview(data), 0
        stream = self._child.stdout
        while at < size:
            left = until - time.monotonic()
            if left <= 0 or not wait_until_readable(stream.fileno(), left):
                self._child.kill()
                raise _GoneError
            count = stream.readinto(view[at:])
            if not count:
                raise _GoneError
            at += count
        return data

    def _start_worker(self) -> Any:
        if self._child is not None and self._child.poll() is not None:
            self._end()  # it was ended from outside while idle
        if self._child is None:
            # A session of its own: Ctrl-C is for the caller, whose end closes the pipe.
            self._child = subprocess.Popen(
                child_command("formats.reader_worker"),
                stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                bufsize=0, start_new_session=True, env=child_environment())
        return self._child

    def _end(self) -> int:
        child, self._child = self._child, None
        if child is None:
            return 0
        child.stdin.close()
        wait_or_kill(child, _END_S)
        child.stdout.close()
        return int(child.returncode)

    def _schedule_end(self) -> None:
        """Have the child ended when it has had nothing to do for a while."""
        self._last = time.monotonic()
        if self._keeper is None:
            self._keeper = threading.Thread(target=self._wait, name="mesh reader", daemon=True)
            self._keeper.start()

    def _wait(self) -> None:
        while True:
            time.sleep(_KEPT_S)
            with self._lock:
                if time.monotonic() - self._last >= _KEPT_S:
                    self._end()
                    self._keeper = None
                    return


@functools.lru_cache(maxsize=1)
def kept() -> ReaderProcess:
    return ReaderProcess()


def _why(status: int, request: Dict[str, Any]) -> str:
    limits = (f"{request['memory'] >> 20} MB of memory or {request['seconds']} s of processor"
              " time")
    if status == -signal.SIGXCPU:
        return f"reading takes more than {request['seconds']} s of processor time"
    return f"reading takes more than {limits} (status {status})"
