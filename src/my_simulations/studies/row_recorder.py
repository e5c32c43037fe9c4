"""Records rows, and the output of their cases in files beside them."""
from __future__ import annotations

import os
import re
import shutil
import threading
import time
from typing import Dict, List, Optional

import numpy as np

from .case_output import CaseOutput, ScenarioFiles
from .journal import Journal
from .replacing import replacement_file
from .row import Row

SCENARIOS = "scenarios"
"""The folder of what scenarios leave."""

_MOST_BYTES = 64 << 20
_MOST_CASES = 200
_LONGEST_S = 10.0


class Recorder:
    """Writes rows to the journal, and before them the output of their cases.

    Trajectories go into .npz files of several cases each, files of a scenario into a folder of its
    own, `scenarios/ID`. A row with a trajectory is written once the file with it is complete, so
    that no row names a file that a killed process has left unfinished; those that waited run again.

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

    def add(self, row: Row, output: Optional[CaseOutput]) -> None:
        """Record a row and the output of its case."""
        if isinstance(output, ScenarioFiles):
            self._write_files(row.case, output)
            output = None
        with self._lock:
            if output is None:
                self._journal.append([row])
                return
            if not self._rows:
                self._since = time.monotonic()
            self._rows.append(row)
            arrays = output.arrays(row.case)
            self._arrays.update(arrays)
            self._bytes += sum(array.nbytes for array in arrays.values())
            if (self._bytes > _MOST_BYTES or len(self._rows) >= _MOST_CASES
                    or time.monotonic() - self._since > _LONGEST_S):
                self._flush()

    def close(self) -> None:
        """Write the trajectories."""
        with self._lock:
            self._flush()

    def _write_files(self, case: str, output: ScenarioFiles) -> None:
        folder = os.path.join(self._folder, SCENARIOS, case)
        shutil.rmtree(folder, ignore_errors=True)  # of a former run of this case
        os.makedirs(folder, exist_ok=True)
        for name, content in output.files.items():
            with open(os.path.join(folder, name), "wb") as stream:
                stream.write(content)

    def _flush(self) -> None:
        if not self._rows:
            return
        self._number += 1
        name = f"{self._prefix}-{self._number:06d}.npz"
        path = os.path.join(self._folder, name)
        with replacement_file(path) as part, open(part, "wb") as stream:
            np.savez_compressed(stream, **self._arrays)  # type: ignore[arg-type]
            stream.flush()
            os.fsync(stream.fileno())
        for row in self._rows:
            row.trajectory = name
        self._journal.append(self._rows)
        self._rows, self._arrays, self._bytes = [], {}, 0


def _last_number(folder: str, prefix: str) -> int:
    """The greatest number of a file that is there; a name is never used again."""
    pattern = re.compile(re.escape(prefix) + r"-(\d+)\.npz\b")
    found = [int(match.group(1)) for match in map(pattern.match, os.listdir(folder)) if match]
    return max(found, default=0)
