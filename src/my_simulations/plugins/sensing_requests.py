"""What one plugin has asked of the sensing process: a scan and a set of pictures at a time."""
from __future__ import annotations

import time
from collections import deque
from concurrent.futures import Future
from concurrent.futures import TimeoutError as FutureTimeoutError
from typing import Callable, Deque, Dict, List, NamedTuple, Optional, Sequence, Set, Tuple

from ..sensing.api import Mount, Pictures, RayFan, RayReturns, SensingError
from ..simulator.scene_sensing import SceneSensing
from .context import View

_SCAN_S = 10.0      # of wall time, for rays
_PICTURES_S = 60.0  # and for pictures, which only a world that is stepped manually waits for
_UNSENT_S = 0.002
_AGAIN_S = 60.0     # between two warnings of late pictures


class _Scan(NamedTuple):
    future: "Future[RayReturns]"
    call: Callable[[RayReturns, int], None]
    ns: int


class _PictureRequest(NamedTuple):
    futures: "List[Future[Pictures]]"
    call: Callable[[List[Pictures], int], None]
    ns: int
    stream: str
    first: bool   # the stream's first pictures, which are discarded

    @property
    def done(self) -> bool:
        return all(future.done() for future in self.futures)


class SensingRequests:
    """Hands the answers of a plugin's requests over in the order of the requests.

    Pictures belong to streams, one for each camera that a plugin uses independently.

    Args:
        scene: casts rays and takes pictures.
        inbox: of the plugin; gets the functions that hand answers over.
        wake: causes the inbox to be processed.
        warn: reports a warning to the user.
        answered: called when a scan or pictures are complete or have failed.
        sensor: name for warnings about streams without a name.
    """

    def __init__(self, scene: SceneSensing, inbox: Deque[Callable[[], None]],
                 wake: Callable[[], None], warn: Callable[[str], None],
                 answered: Callable[[], None] = lambda: None, sensor: str = "") -> None:
        self._scene, self._inbox, self._wake, self._warn = scene, inbox, wake, warn
        self._answered, self._sensor = answered, sensor
        self._scan: Optional[_Scan] = None
        self._shots: Dict[str, _PictureRequest] = {}
        self._unsent: Dict[str, Deque[None]] = {}
        self._warm: Set[str] = set()   # streams whose first pictures were rendered
        self._stream = ""
        self._fault = ""
        self._left_out = 0
        self._last_warning = -_AGAIN_S

    def discard_pending(self) -> None:
        """Discard pending scans and pictures after sim time was set."""
        self._scan = None
        self._shots.clear()

    @property
    def is_busy(self) -> bool:
        """Whether a scan or pictures are pending."""
        return self._scan is not None or bool(self._shots)

    @property
    def is_pending(self) -> bool:
        """Whether a scan, pictures or messages of pictures are not published yet."""
        return self.is_busy or any(self._unsent.values())

    @property
    def unsent(self) -> "Deque[None]":
        """One entry for each message that is being made of the stream that is handed over now."""
        return self._unsent.setdefault(self._stream, deque())

    # -- rays ------------------------------------------------------------------------------------

    def scan(self, mount: Mount, fan: RayFan, visuals: bool,
             call: Callable[[RayReturns, int], None], ns: int, rows: bytes) -> None:
        """Cast rays, after the result of the previous scan was handed over.

        `rows`: of all links, as of `ns`.
        """
        self._end_scan(self._scan)
        scan = self._scan = _Scan(self._scene.cast(mount, fan, visuals, ns, rows), call, ns)
        scan.future.add_done_callback(lambda _: self._queue_call(lambda: self._end_scan(scan)))

    def _queue_call(self, call: Callable[[], None]) -> None:
        self._inbox.append(call)
        self._wake()

    def _end_scan(self, scan: Optional[_Scan]) -> None:
        if scan is None or scan is not self._scan:
            return
        self._scan = None
        self._answered()
        if not scan.future.done():
            self._scene.send()
        try:
            found = scan.future.result(_SCAN_S)
        except (SensingError, FutureTimeoutError) as fault:
            self._report_fault("a scan is", fault)
            return
        scan.call(found, scan.ns)

    # -- pictures --------------------------------------------------------------------------------

    def photograph(self, views: Sequence[Tuple[Mount, View]],
                   call: Callable[[List[Pictures], int], None], ns: int, rows: bytes, wait: bool,
                   again: Callable[[], object], stream: str = "", queue: bool = False) -> bool:
        """Request pictures, unless the previous ones of the same stream are late.

        The world does not wait while the renderer starts, reads textures and compiles shaders. So
        the first pictures of a stream are discarded, and requested again when they are complete:
        the first published picture is as recent as later ones.

        Args:
            views: the pose and the outputs of each camera.
            call: called with the pictures and `ns`.
            ns: sim time, now.
            rows: of all links, as of `ns`.
            wait: wait for the previous pictures, even if they are late.
            again: requests the pictures again, at the sim time of its call.
            stream: its name.
            queue: request even while messages of the previous pictures are being made.

        Returns:
            Whether pictures were requested.
        """
        before, unsent = self._shots.get(stream), self._unsent.setdefault(stream, deque())
        if before is not None and (wait or before.done):
            self._end_request(before, _PICTURES_S if wait else 0.0)
        if wait:
            _wait_for(unsent)
        if stream in self._shots or (unsent and not queue):
            if stream not in self._shots or not self._shots[stream].first:
                self._report_skipped(stream or self._sensor)
            return False
        futures = self._scene.render(
            [(mount, view.camera, view.outputs) for mount, view in views], ns, rows)
        first = not (wait or stream in self._warm)
        shot = self._shots[stream] = _PictureRequest(futures, _ignore if first else call, ns,
                                                     stream, first)

        def arrived() -> None:
            if self._end_request(shot) and first:
                again()

        for future in shot.futures:
            future.add_done_callback(lambda _: self._queue_call(arrived))
        return True

    def _end_request(self, shot: _PictureRequest, timeout: float = 0.0) -> bool:
        """Hand pictures over; return whether this call did so."""
        if shot is not self._shots.get(shot.stream) or not (timeout or shot.done):
            return False
        del self._shots[shot.stream]
        self._answered()
        deadline = time.monotonic() + timeout
        try:
            found = [future.result(max(0.0, deadline - time.monotonic()))
                     for future in shot.futures]
        except (SensingError, FutureTimeoutError) as fault:
            self._warm.discard(shot.stream)
            self._report_fault("a picture is", fault)
            return False
        self._stream = shot.stream
        self._warm.add(shot.stream)
        shot.call(found, shot.ns)
        return True

    def _report_skipped(self, sensor: str) -> None:
        self._left_out += 1
        now = time.monotonic()
        if now - self._last_warning >= _AGAIN_S:
            self._last_warning = now
            self._warn(f"pictures of sensor '{sensor}' are late, this machine draws slower than "
                       f"the sensor's rate: {self._left_out} left out so far; physics continues")

    def _report_fault(self, what: str, fault: Exception) -> None:
        text = f"{what} left out: {fault or 'it took too long'}"
        if text != self._fault:
            self._fault = text
            self._warn(text)


def _ignore(pictures: List[Pictures], ns: int) -> None:
    """Discard the first pictures of a stream."""


def _wait_for(unsent: "Deque[None]") -> None:
    deadline = time.monotonic() + _PICTURES_S
    while unsent and time.monotonic() < deadline:
        time.sleep(_UNSENT_S)
