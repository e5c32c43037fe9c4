"""Machines that lack something: a folder whose disk can be full or read-only, busy processors."""
from __future__ import annotations

import contextlib
import os
import resource
import subprocess
import sys
from typing import Iterator, List

MEGABYTES = 2


class Disk:
    """A folder on a disk of its own where this user may mount one."""

    def __init__(self, folder: str) -> None:
        os.makedirs(folder, exist_ok=True)
        self.folder = folder
        self.mounted = subprocess.run(
            ["mount", "-t", "tmpfs", "-o", f"size={MEGABYTES}m", "tmpfs", folder],
            capture_output=True, check=False).returncode == 0
        self._filling = os.path.join(folder, "filling")
        self._size = resource.getrlimit(resource.RLIMIT_FSIZE)

    @contextlib.contextmanager
    def full(self) -> Iterator[None]:
        """Nothing more fits on it."""
        if not self.mounted:  # the kernel then refuses all that this process writes
            resource.setrlimit(resource.RLIMIT_FSIZE, (0, self._size[1]))
            try:
                yield
            finally:
                resource.setrlimit(resource.RLIMIT_FSIZE, self._size)
            return
        with open(self._filling, "wb", buffering=0) as stream:
            with contextlib.suppress(OSError):
                while True:
                    stream.write(b"x" * 4096)
            yield
        os.unlink(self._filling)

    @contextlib.contextmanager
    def read_only(self) -> Iterator[None]:
        """Nothing on it can be changed."""
        self._allow(False)
        try:
            yield
        finally:
            self._allow(True)

    def _allow(self, writing: bool) -> None:
        if self.mounted:
            subprocess.run(["mount", "-o", f"remount,{'rw' if writing else 'ro'}", self.folder],
                           check=True)
        else:
            for folder, _, _ in os.walk(self.folder):
                os.chmod(folder, 0o755 if writing else 0o555)

    def close(self) -> None:
        """Give it back."""
        if self.mounted:
            subprocess.run(["umount", "-l", self.folder], check=True)


@contextlib.contextmanager
def starved(loops: int) -> Iterator[None]:
    """So many processes that compute all the time."""
    busy: List["subprocess.Popen[bytes]"] = [
        subprocess.Popen([sys.executable, "-I", "-S", "-c", "while True: pass"])
        for _ in range(loops)]
    try:
        yield
    finally:
        for process in busy:
            process.kill()
            process.wait()
