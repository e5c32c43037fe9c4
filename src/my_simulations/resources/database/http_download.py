"""Downloads files with a total deadline, a size limit and checks of integrity."""
from __future__ import annotations

import base64
import hashlib
import http.client
import re
import socket
import time
import urllib.error
import urllib.request
from dataclasses import dataclass
from email.message import Message
from typing import IO, Any, Callable, Optional

from ...errors import ResourceError

_CHUNK = 1 << 16
_TRIES = 4
_MD5 = re.compile(r'"?([0-9a-f]{32})"?\Z')


@dataclass(frozen=True)
class Limits:
    """Limits of a database: bytes of the model list, of an archive and of its content; files."""

    list_bytes: int = 16 << 20
    archive_bytes: int = 512 << 20
    unpacked_bytes: int = 2 << 30
    files: int = 20000


class HttpError(ResourceError):
    """A download that failed. `missing`: the server does not have the file."""

    def __init__(self, message: str, missing: bool = False) -> None:
        super().__init__(message)
        self.missing = missing


def fetch(url: str, into: IO[bytes], largest: int, until: float,
          progress: Optional[Callable[[int, int], None]] = None) -> "Message[str, str]":
    """Download a file; failed transfers are tried up to four times (Gazebo behaviour).

    Args:
        url: http or https.
        into: a seekable stream; each try writes it from its start.
        largest: largest size, bytes.
        until: `time.monotonic()` at which to give up.
        progress: called with the bytes received and expected (0 if unknown).

    Returns:
        The headers of the response.

    Raises:
        HttpError: the download failed; `into` is incomplete.
    """
    if not url.startswith(("http://", "https://")):
        raise HttpError(f"{url} is not an HTTP URL")
    for left in range(_TRIES - 1, -1, -1):
        into.seek(0)
        into.truncate()
        try:
            return _once(url, into, largest, until, progress)
        except urllib.error.HTTPError as fault:
            missing = fault.code in (404, 410)
            if missing or fault.code < 500 or not left:
                raise HttpError(f"{url}: HTTP error {fault.code} {fault.reason}", missing) from None
        except (OSError, http.client.HTTPException, _DamagedDownloadError) as fault:
            _check_time(url, until)
            if not left or isinstance(getattr(fault, "reason", None), ConnectionRefusedError):
                reason = getattr(fault, "reason", None) or fault
                raise HttpError(f"cannot download {url}: {reason}") from None
        except ValueError as fault:  # of an address or a header that cannot be read
            raise HttpError(f"cannot download {url}: {fault}") from None
    raise AssertionError("the last try returns or raises")


class _DamagedDownloadError(ResourceError):
    """The received content does not match its checksum or length."""


def _once(url: str, into: IO[bytes], largest: int, until: float,
          progress: Optional[Callable[[int, int], None]]) -> "Message[str, str]":
    request = urllib.request.Request(url, headers={"Accept-Encoding": "identity"})
    with urllib.request.urlopen(request, timeout=_compute_seconds_left(url, until)) as answer:
        expected = _length(answer.headers.get("Content-Length"))
        if expected > largest:
            raise HttpError(f"{url} has {expected} bytes, the limit is {largest}")
        sums, done = hashlib.md5(), 0
        while True:
            _set_timeout(answer, _compute_seconds_left(url, until))
            # read1 returns what is there, so that a slow server cannot outlast the deadline.
            chunk = answer.read1(_CHUNK)
            if not chunk:
                break
            done += len(chunk)
            if done > largest:
                raise HttpError(f"{url} is larger than the limit of {largest} bytes")
            into.write(chunk)
            sums.update(chunk)
            if progress is not None:
                progress(done, expected)
        _check(answer.headers, expected, done, sums)
        return answer.headers


def _check(headers: Any, expected: int, done: int, sums: Any) -> None:
    if expected and done != expected:
        raise _DamagedDownloadError(f"received {done} of {expected} bytes")
    given = headers.get("Content-MD5")
    if given and base64.b64encode(sums.digest()).decode() != given.strip():
        raise _DamagedDownloadError("wrong checksum (Content-MD5)")
    # Object stores send the MD5 as ETag; other ETags are unrelated to the content. If an ETag has
    # the form of an MD5 and differs, Content-MD5 decides.
    tag = _MD5.match((headers.get("ETag") or "").strip())
    if tag and not given and tag.group(1) != sums.hexdigest():
        raise _DamagedDownloadError("wrong checksum (ETag)")


def _length(text: Optional[str]) -> int:
    return int(text) if text and text.isdigit() else 0


def _compute_seconds_left(url: str, until: float) -> float:
    _check_time(url, until)
    return max(0.01, until - time.monotonic())


def _check_time(url: str, until: float) -> None:
    if time.monotonic() >= until:
        raise HttpError(f"timed out downloading {url}")


def _set_timeout(answer: Any, seconds: float) -> None:
    raw = getattr(getattr(answer, "fp", None), "raw", None)
    connection = getattr(raw, "_sock", None)
    if isinstance(connection, socket.socket):
        connection.settimeout(seconds)
