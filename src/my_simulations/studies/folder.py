"""The folder of a study's results: journals, table, trajectories and report."""
from __future__ import annotations

import glob
import os
import re
import shutil
from typing import Any, Callable, Dict, List, NamedTuple, Tuple

from ..errors import CommandError
from ..program_end import is_disk_full
from .journal import has_header, header_of, statuses
from .plan import ALL_CASES, CasePlan, Shard, number_of
from .replacing import replacement_file
from .row import OK, STATUSES
from .table import parquet_fault, rows_in_order, write_csv, write_parquet

COPY = "study.yaml"
REPORT = "report.html"


def shard_of(journal: str) -> Shard:
    found = re.search(r"-(\d+)-of-(\d+)\.jsonl$", journal)
    return Shard(int(found[1]), int(found[2])) if found else ALL_CASES


class Cause(NamedTuple):
    """Why a number of `cases` are not ok; `example` is the id of the first one."""

    status: str
    issue: str
    cases: int
    example: str


class StudyFolder:
    """Where the results of a study are.

    Args:
        path: of the folder.
    """

    def __init__(self, path: str) -> None:
        self.path = os.path.abspath(path)

    def journal_of(self, shard: Shard) -> str:
        return os.path.join(self.path, self.stem("journal", shard) + ".jsonl")

    @staticmethod
    def stem(kind: str, shard: Shard) -> str:
        """The name of a shard's file, without its ending."""
        return kind if shard.of == 1 else f"{kind}-{shard.index}-of-{shard.of}"

    def journals(self) -> List[str]:
        """Return the paths of all journals. Raises CommandError if there is none.

        A file without a complete first line, which names the study, is ignored: its process was
        killed, or the disk was full, before the first case ran.
        """
        found = [path for path in self._files() if has_header(path)]
        if not found:
            raise CommandError(f"there is no study in {self.path}; start one with"
                               " `study run FILE`")
        return found

    def _files(self) -> List[str]:
        return sorted(glob.glob(os.path.join(glob.escape(self.path), "journal*.jsonl")))

    def check_shards(self, of: int) -> None:
        """Raise CommandError if the folder has journals of another number of shards.

        Each shard knows only its own journal: cases would run twice.
        """
        for path in self._files():
            found = shard_of(path).of
            if found != of:
                raise CommandError(
                    f"{self.path} holds a run in {found} shard{'s' * (found > 1)}, not in {of}:"
                    " go on with that number or name another folder with --out")

    def missing_shards(self) -> List[Shard]:
        """The shards of the run that have no journal here: they have not begun, or elsewhere."""
        found = {shard_of(path).index for path in self.journals()}
        of = shard_of(self.journals()[0]).of
        return [Shard(index, of) for index in range(1, of + 1) if index not in found]

    def is_complete(self, plan: CasePlan) -> bool:
        """Whether each case of the plan has a row."""
        if self.missing_shards():
            return False
        found = statuses(self.journals())
        return len(found) >= len(plan) and all(number_of(case.id) in found
                                               for case in plan.cases())

    def status_counts(self, plan: CasePlan, shard: Shard = ALL_CASES) -> Dict[str, int]:
        """How many cases of a shard of the plan, or of all, have each status.

        Rows of former ids, which the plan does not have any more, do not count.
        """
        paths = self.journals() if shard == ALL_CASES else [self.journal_of(shard)]
        found = statuses(paths)
        count = dict.fromkeys(STATUSES, 0)
        for case in plan.cases(shard) if found else ():
            status = found.get(number_of(case.id))
            if status is not None:
                count[status] += 1
        return count

    def causes(self, plan: CasePlan, shard: Shard = ALL_CASES) -> List[Cause]:
        """Why cases of a shard of the plan are not ok, the most frequent cause first."""
        planned = {case.id for case in plan.cases(shard)}
        found: Dict[Tuple[str, str], Cause] = {}
        for row in rows_in_order(self.journals()):
            if row.status != OK and row.case in planned:
                key = (row.status, row.issue)
                known = found.get(key, Cause(*key, 0, row.case))
                found[key] = known._replace(cases=known.cases + 1)
        return sorted(found.values(), key=lambda cause: -cause.cases)

    def header(self) -> Dict[str, Any]:
        """What the first journal says about the study."""
        return header_of(self.journals()[0])

    def create(self) -> None:
        try:
            os.makedirs(self.path, exist_ok=True)
        except OSError as fault:
            if is_disk_full(fault):
                raise
            raise CommandError(f"cannot write to {self.path}: {fault.strerror}") from None

    def copy_study_file(self, study_file: str) -> None:
        """Copy the study file for the record; the caller has opened a journal of the folder."""
        with replacement_file(os.path.join(self.path, COPY)) as part:
            shutil.copyfile(study_file, part)

    def write_tables(self, plan: CasePlan, say: Callable[[str], None]) -> List[str]:
        """Write the table in all formats; returns the files. Says why one is left out."""
        paths = self.journals()
        files = [os.path.join(self.path, "results.csv")]
        write_csv(files[0], plan.study, paths)
        fault = parquet_fault()
        if fault is None:
            files.append(os.path.join(self.path, "results.parquet"))
            write_parquet(files[1], plan.study, paths)
        elif fault:
            say(fault)
        return files
