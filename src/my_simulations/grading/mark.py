"""Marks: the result of each check of a submission, and their JSON form."""
from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from typing import Any, Dict, List, Sequence

from ..errors import SimulationError
from .assignment import Assignment, Check

GRADED, TIMED_OUT, FAILED = "graded", "timed out", "not graded"
"""Statuses: every check was decided; the time ended first; the grading program itself failed."""

_LONGEST_REASON = 1000   # characters


class GradingError(SimulationError):
    """The grading program itself failed, through no fault of the submission."""


@dataclass(frozen=True)
class CheckResult:
    """The result of a check.

    Attributes:
        name: of the check.
        most: its points.
        points: the points given, 0..most.
        reason: one sentence for the student; "" if all points were given without a remark.
        file: path in the submission that the reason is about; "" for none.
        line: in that file, from 1; 0 for none.
    """

    name: str
    most: float
    points: float
    reason: str = ""
    file: str = ""
    line: int = 0

    @property
    def passed(self) -> bool:
        """Whether it gave all points."""
        return self.points >= self.most


def late_reason(assignment: Assignment) -> str:
    """Why checks have no points that were not decided in time."""
    return f"not finished within {assignment.limits.seconds:g} s of wall time"


def score_check(check: Check, share: float, reason: str = "", file: str = "", line: int = 0
                ) -> CheckResult:
    """Give a check a share (0..1) of its points, rounded to 0.01 points.

    A long reason is cut: it can contain any text of a submission.
    """
    if len(reason) > _LONGEST_REASON:
        reason = f"{reason[:_LONGEST_REASON]}…"
    points = round(check.points * min(max(share, 0.0), 1.0), 2)
    return CheckResult(check.name, check.points, points, reason, file, line)


@dataclass(frozen=True)
class Mark:
    """The mark of a submission.

    Attributes:
        student: name of the submission.
        status: GRADED, TIMED_OUT or FAILED.
        results: one for each check, in the order of the assignment.
        notes: remarks that belong to no check, such as files that were left out.
        files: names of further files in the folder of the student, such as `replay.html`.
        isolation: how the submission was kept apart.
        key: hash of submission, assignment and program version.
        library: path and digest of each other file on which it depends, such as an included model.
            A file that does not exist has a digest, too.
    """

    student: str
    status: str
    results: List[CheckResult]
    notes: List[str] = field(default_factory=list)
    files: List[str] = field(default_factory=list)
    isolation: str = ""
    key: str = ""
    library: List[List[str]] = field(default_factory=list)

    @property
    def points(self) -> float:
        return round(sum(one.points for one in self.results), 2)

    @property
    def most(self) -> float:
        return round(sum(one.most for one in self.results), 2)

    def to_json(self) -> str:
        return json.dumps(asdict(self), indent=1, sort_keys=True) + "\n"


def mark_of(text: str) -> Mark:
    """The mark of a JSON text. Raises ValueError, TypeError or KeyError."""
    plain: Dict[str, Any] = json.loads(text)
    plain["results"] = [CheckResult(**one) for one in plain["results"]]
    return Mark(**plain)


def without_result(checks: Sequence[Check], known: Sequence[CheckResult], reason: str
                   ) -> List[CheckResult]:
    """All checks in order; those that have no result yet get no points, and a reason."""
    found = {one.name: one for one in known}
    return [found.get(check.name) or score_check(check, 0.0, reason) for check in checks]


def all_failed(assignment: Assignment, student: str, status: str, reason: str) -> Mark:
    return Mark(student, status, without_result(assignment.checks, [], reason))
