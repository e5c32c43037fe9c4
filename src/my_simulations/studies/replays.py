"""Keeps replays of failed cases: one HTML file each, in the folder `replays` of the results."""
from __future__ import annotations

import contextlib
import math
import os
import tempfile
from typing import Callable, List, Protocol

from ..errors import SimulationError
from ..python_api import OpenWorld
from .case_world import open_case, run_case
from .folder import StudyFolder
from .plan import Case, CasePlan
from .row import FAILED, OK, Row
from .row_recorder import SCENARIOS
from .scenario_slot import RECORDING
from .table import rows_in_order

REPLAYS = "replays"
_EVERY_S = 1.0 / 30.0

_LAST_S = 30.0    # of a scenario, at its end: what has failed ends it

WriteReplay = Callable[[str, str, str, float], None]
"""Writes the end of a state log as a replay: path of the log, path of the replay, title, s of sim
time.
"""


class Record(Protocol):
    """A file that records what happens in a world."""

    def record_state(self, world: OpenWorld) -> None:
        """Add the present state."""

    def close(self) -> None:
        """Finish the file."""


def replay_of(folder: str, case: str) -> str:
    """The path of the replay of a case, by the folder of the results and the id."""
    return os.path.join(folder, REPLAYS, f"{case}.html")


def keep_replays(plan: CasePlan, folder: StudyFolder, most: int, tell: Callable[[str], None],
                 record: Callable[[str], Record], write: WriteReplay) -> List[str]:
    """Write replays of the first failed cases that have none; returns their paths.

    A case of a world runs again, which repeats it bit for bit. The simulator has recorded a
    scenario while it ran.

    Args:
        plan: of the study.
        folder: of its results.
        most: number of cases that have a replay at the end.
        tell: gets a line if replays can no longer be written.
        record: opens a state log by its path.
        write: writes a replay.
    """
    written: List[str] = []
    kept = 0
    for row in rows_in_order(folder.journals()):
        if kept >= most:
            break
        if row.index >= len(plan) or not _has_replay(plan, folder, row):
            continue
        case = plan.case(row.index)
        if case.id != row.case:
            continue
        kept += 1
        path = replay_of(folder.path, row.case)
        if os.path.exists(path) and not _is_outdated(path, folder, row):
            continue
        title = f"{plan.study.name}, case {row.case}"
        try:
            if plan.study.scenarios:
                write(_recording(folder, row), path, title, _LAST_S)
            else:
                _record_again(plan, case, path, title, record, write)
        except SimulationError as fault:
            tell(f"study: no replays of failed cases: {fault}")
            break
        written.append(path)
    return written


def _has_replay(plan: CasePlan, folder: StudyFolder, row: Row) -> bool:
    if plan.study.scenarios:
        return row.status != OK and os.path.isfile(_recording(folder, row))
    return row.status == FAILED


def _is_outdated(replay: str, folder: StudyFolder, row: Row) -> bool:
    """Whether a scenario has run again since its replay was written."""
    recording = _recording(folder, row)
    return os.path.isfile(recording) and os.path.getmtime(recording) > os.path.getmtime(replay)


def _recording(folder: StudyFolder, row: Row) -> str:
    return os.path.join(folder.path, SCENARIOS, row.case, RECORDING)


def _record_again(plan: CasePlan, case: Case, path: str, title: str,
                  record: Callable[[str], Record], write: WriteReplay) -> None:
    with tempfile.TemporaryDirectory(prefix="my_simulations_replay_") as folder:
        log = os.path.join(folder, "state.log")
        with open_case(plan, case) as world, contextlib.closing(record(log)) as file:
            run_case(world, plan.study.duration, _EVERY_S, [file.record_state])
        write(log, path, title, math.inf)
