"""Trajectories of cases, several cases in one .npz file."""
from __future__ import annotations

import os
import re
import threading
import time
from dataclasses import dataclass
from typing import Dict, List, Tuple

import numpy as np

from .journal import Journal
from .row import Row

_MOST_BYTES = 64 << 20
_MOST_CASES = 200
_LONGEST_S = 10.0


@dataclass(frozen=True)
class CaseTrajectory:
    """The motion in one case.

    Attributes:
        times: (frames,) s of sim time.
        names: of the models, in the order of the second axis.
        poses: (frames, models, 7) x, y, z in m and a quaternion x, y, z, w, world frame.
    """

    times: np.ndarray
    names: Tuple[str, ...]
    poses: np.ndarray

    def arrays(self, case: str) -> Dict[str, np.ndarray]:
        """By their keys in the file."""
        return {f"{case}.time": self.times, f"{case}.names": np.array(self.names, dtype=str),
                f"{case}.pose": self.poses}


class Recorder:
    """Writes rows to the journal, and the trajectories of those that have one before them.

    A row with a trajectory is written once the file with it is complete, so that no row names a
    file that a killed process has left unfinished; those that waited run again.

    Args:
        journal: gets the rows.
        folder: where the files are written.
        prefix: of their names.
    """

    def __init__(self, journal: Journal, folder: str, prefix: str) -> None:
        self._journal = journal
        self._folder = folder
        self._prefix = prefix
        self._lock = threading.Lock()
        self._rows: List[Row] = []
        self._arrays: Dict[str, np.ndarray] = {}
        self._bytes = 0
        self._since = 0.0
        self._number = _last_number(folder, prefix)

    def add(self, row: Row, trajectory: "CaseTrajectory | None") -> None:
        """Keep a row, and its trajectory if it has one."""
        with self._lock:
            if trajectory is None:
                self._journal.append([row])
                return
            if not self._rows:
                self._since = time.monotonic()
            self._rows.append(row)
            arrays = trajectory.arrays(row.case)
            self._arrays.update(arrays)
            self._bytes += sum(array.nbytes for array in arrays.values())
            if (self._bytes > _MOST_BYTES or len(self._rows) >= _MOST_CASES
                    or time.monotonic() - self._since > _LONGEST_S):
                self._flush()

    def close(self) -> None:
        """Write what is kept."""
        with self._lock:
            self._flush()

    def _flush(self) -> None:
        if not self._rows:
            return
        self._number += 1
        name = f"{self._prefix}-{self._number:06d}.npz"
        path = os.path.join(self._folder, name)
        with open(path + ".part", "wb") as stream:
            np.savez_compressed(stream, **self._arrays)  # type: ignore[arg-type]
            stream.flush()
            os.fsync(stream.fileno())
        os.replace(path + ".part", path)
        for row in self._rows:
            row.trajectory = name
        self._journal.append(self._rows)
        self._rows, self._arrays, self._bytes = [], {}, 0


def _last_number(folder: str, prefix: str) -> int:
    """The greatest number of a file that is there; a name is never used again."""
    pattern = re.compile(re.escape(prefix) + r"-(\d+)\.npz(\.part)?$")
    found = [int(match.group(1)) for match in map(pattern.match, os.listdir(folder)) if match]
    return max(found, default=0)
