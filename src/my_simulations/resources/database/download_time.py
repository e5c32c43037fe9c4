"""Base of model providers: one deadline for each world, and each fault reported once."""
from __future__ import annotations

import time
from typing import Callable, Dict, Optional

from ..model_provider import ModelNotProvidedError, Progress
from .http_download import Limits

WORLD_SECONDS = 10.0


class DownloadTime:
    """A provider that downloads models.

    Args:
        progress: called with the progress of a download.
        seconds: total wall time for all downloads of a world, from the first one on.
        limits: size limits.
    """

    def __init__(self, progress: Optional[Progress] = None, seconds: float = WORLD_SECONDS,
                 limits: Optional[Limits] = None) -> None:
        self._progress = progress
        self._seconds = seconds
        self.limits = limits or Limits()
        self._deadline: Optional[float] = None
        self._failed: Dict[str, str] = {}

    def begin(self) -> None:
        """Start a new world: the deadline starts again, and failed downloads may be tried again."""
        self._deadline = None
        self._failed.clear()

    def set_seconds(self, seconds: float) -> None:
        """Set the total time of downloads (s) from the next `begin` on."""
        self._seconds = seconds

    def until(self) -> float:
        if self._deadline is None:
            self._deadline = time.monotonic() + self._seconds
        return self._deadline

    def once(self, name: str, source: str, download: Callable[[], None]) -> None:
        """Download a model, unless that has failed for this world. Raises ModelNotProvidedError."""
        from .archive import ArchiveError
        from .http_download import HttpError

        if name in self._failed:
            raise ModelNotProvidedError(self._failed[name])
        try:
            download()
        except (HttpError, ArchiveError, OSError) as fault:
            text = f"{source}: {getattr(fault, 'strerror', None) or fault}"
            self._failed[name] = text
            raise ModelNotProvidedError(text) from fault

    def report(self, name: str) -> Optional[Callable[[int, int], None]]:
        progress = self._progress
        if progress is None:
            return None
        return lambda done, expected: progress(name, done, expected)
