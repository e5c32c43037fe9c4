"""The command `study`, with what records cases: rosbags and state logs."""
from __future__ import annotations

from typing import Optional, Sequence

from ..program_end import exit_cleanly
from ..studies.command import main as study
from ..studies.replays import Record


@exit_cleanly
def main(argv: Optional[Sequence[str]] = None) -> int:
    """Run the command; see `studies.command.main`."""
    return study(argv, records={"bag": _bag, "log": _log}, write_replay=_write_replay)


def _bag(path: str) -> Record:
    from .case_records import BagRecord  # what it imports is needed for this alone

    return BagRecord(path)


def _log(path: str) -> Record:
    from ..editor.logs.world_record import LogRecord

    return LogRecord(path)


def _write_replay(log: str, path: str, title: str, last: float) -> None:
    from ..editor.logs.replay_page import write_replay
    from ..resources.resolver import Resolver

    write_replay(log, path, Resolver.from_environment(), title, last=last)
