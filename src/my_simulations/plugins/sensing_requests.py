"""What one plugin has asked of the sensing process: a scan and a set of pictures at a time."""
from __future__ import annotations

import time
from collections import deque
from concurrent.futures import Future
from concurrent.futures import TimeoutError as FutureTimeoutError
from typing import Callable, Deque, List, NamedTuple, Optional, Sequence, Tuple

from ..sensing.api import Mount, Pictures, RayFan, RayReturns, SensingError
from .context import View
from .eyes import Eyes

_SCAN_S = 10.0      # of wall time, for rays
_PICTURES_S = 60.0  # and for pictures, which only a world that is stepped manually waits for
_UNSENT_S = 0.002
_AGAIN_S = 60.0     # between two warnings of late pictures


class _Scan(NamedTuple):
    future: "Future[RayReturns]"
    call: Callable[[RayReturns, int], None]
    ns: int


class _Shot(NamedTuple):
    futures: "List[Future[Pictures]]"
    call: Callable[[List[Pictures], int], None]
    ns: int

    @property
    def done(self) -> bool:
        return all(future.done() for future in self.futures)


class SensingRequests:
    """Keeps order between a plugin's requests and their answers.

    Args:
        eyes: who looks.
        inbox: of the plugin; functions that hand answers over are put there.
        wake: have somebody look into the inbox.
        warn: tells the user.

    Attributes:
        unsent: a mark for each message that is being made of pictures.
    """

    def __init__(self, eyes: Eyes, inbox: Deque[Callable[[], None]], wake: Callable[[], None],
                 warn: Callable[[str], None]) -> None:
        self._eyes, self._inbox, self._wake, self._warn = eyes, inbox, wake, warn
        self.unsent: Deque[None] = deque()
        self._scan: Optional[_Scan] = None
        self._shot: Optional[_Shot] = None
        self._fault = ""
        self._left_out = 0
        self._told = -_AGAIN_S

    def forget(self) -> None:
        """What is on its way belongs to a time that has been set back."""
        self._scan = self._shot = None

    # -- rays ------------------------------------------------------------------------------------

    def scan(self, mount: Mount, fan: RayFan, visuals: bool,
             call: Callable[[RayReturns, int], None], ns: int) -> None:
        """Cast rays, after the answer to those before has been handed over."""
        self._end_scan(self._scan)
        scan = self._scan = _Scan(self._eyes.cast(mount, fan, visuals), call, ns)
        scan.future.add_done_callback(lambda _: self._hear(lambda: self._end_scan(scan)))

    def _hear(self, call: Callable[[], None]) -> None:
        self._inbox.append(call)
        self._wake()

    def _end_scan(self, scan: Optional[_Scan]) -> None:
        if scan is None or scan is not self._scan:
            return
        self._scan = None
        try:
            found = scan.future.result(_SCAN_S)
        except (SensingError, FutureTimeoutError) as fault:
            self._tell_fault("a scan is", fault)
            return
        scan.call(found, scan.ns)

    # -- pictures --------------------------------------------------------------------------------

    def photograph(self, views: Sequence[Tuple[Mount, View]],
                   call: Callable[[List[Pictures], int], None], ns: int, wait: bool) -> bool:
        """Ask for pictures, unless those before are late.

        Args:
            views: where each camera is, and what it is to give.
            call: gets the pictures, and `ns`.
            ns: sim time, now.
            wait: for those before, however late they are.

        Returns:
            Whether pictures were asked for.
        """
        if wait:
            self._wait()
        elif self._shot is not None and self._shot.done:
            self._end_shot(self._shot)
        if self._shot is not None or self.unsent:
            self._leave_out()
            return False
        shot = self._shot = _Shot(self._eyes.render(views), call, ns)
        for future in shot.futures:
            future.add_done_callback(lambda _: self._hear(lambda: self._end_shot(shot)))
        return True

    def _wait(self) -> None:
        if self._shot is not None:
            self._end_shot(self._shot, _PICTURES_S)
        deadline = time.monotonic() + _PICTURES_S
        while self.unsent and time.monotonic() < deadline:
            time.sleep(_UNSENT_S)

    def _end_shot(self, shot: _Shot, timeout: float = 0.0) -> None:
        if shot is not self._shot or not (timeout or shot.done):
            return
        self._shot = None
        deadline = time.monotonic() + timeout
        try:
            found = [future.result(max(0.0, deadline - time.monotonic()))
                     for future in shot.futures]
        except (SensingError, FutureTimeoutError) as fault:
            self._tell_fault("a picture is", fault)
            return
        shot.call(found, shot.ns)

    def _leave_out(self) -> None:
        self._left_out += 1
        now = time.monotonic()
        if now - self._told >= _AGAIN_S:
            self._told = now
            self._warn(f"pictures are late, this machine draws slower than the camera's rate: "
                       f"{self._left_out} left out so far; physics goes on")

    def _tell_fault(self, what: str, fault: Exception) -> None:
        text = f"{what} left out: {fault or 'it took too long'}"
        if text != self._fault:
            self._fault = text
            self._warn(text)
