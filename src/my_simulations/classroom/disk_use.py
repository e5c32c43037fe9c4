"""Measures how much of the disk the files of a student use."""
from __future__ import annotations

import subprocess
import time
from typing import Optional

_MEASURE_S = 10.0
_BYTES_PER_FILE = 4096   # an empty file takes a place in the file system, too
_COMMAND = 'du -sxB1 "$0"; du -sx --inodes "$0"'


class DiskUse:
    """Measures the files below a folder in a process of its own: there may be millions.

    Args:
        folder: only its file system is measured. What cannot be read is left out, as are deleted
            files that a program still has open.

    Attributes:
        used_mb: disk space at the last measurement, MB; 0 before the first.
    """

    def __init__(self, folder: str) -> None:
        self.used_mb = 0.0
        self._folder = folder
        self._process: "Optional[subprocess.Popen[bytes]]" = None
        self._begun = float("-inf")

    def poll(self) -> None:
        """Take a measurement that has ended, or begin one every few seconds."""
        if self._process is None:
            if time.monotonic() > self._begun + _MEASURE_S:
                self._begun = time.monotonic()
                self._process = subprocess.Popen(
                    ["nice", "sh", "-c", _COMMAND, self._folder], stdin=subprocess.DEVNULL,
                    stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        elif self._process.poll() is not None:
            lines = self._process.communicate()[0].split(b"\n")
            self._process = None
            if len(lines) == 3:   # else the folder was deleted
                size, files = (int(line.split()[0]) for line in lines[:2])
                self.used_mb = (size + files * _BYTES_PER_FILE) / 1e6

    def reset(self) -> None:
        """End a measurement that goes on, and forget the last one."""
        if self._process is not None:
            self._process.kill()
            self._process.communicate()
            self._process = None
        self.used_mb, self._begun = 0.0, float("-inf")
