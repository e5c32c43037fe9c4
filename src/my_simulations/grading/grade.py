"""`grade`: marks submissions, and writes lists and pages."""
from __future__ import annotations

import os
from typing import Callable, List, NamedTuple, Optional, Sequence, Union

from ..errors import CommandError
from .assignment import Assignment, Launch, Rostest
from .assignment_file import read_assignment
from .box_support import isolation_fault
from .grader import Grader, Told
from .lists import write_lists
from .mark import Mark
from .pages import write_pages
from .shipped import shipped_assignment
from .submission import submissions_of


class Grading(NamedTuple):
    """What `grade` has done.

    Attributes:
        marks: of the submissions, in order.
        files: paths of the lists and of the overview.
    """

    marks: List[Mark]
    files: List[str]


def grade(assignment: Union[str, Assignment], submissions: Sequence[str], out: str = "marks", *,
          jobs: Optional[int] = None, isolate: bool = True, told: Told = lambda mark, kept: None,
          warn: Callable[[str], None] = lambda text: None) -> Grading:
    """Grade submissions (doc/grading.md); those that have not changed keep their marks.

    Args:
        assignment: assignment file, or the name of a shipped one, such as `lab_sheet`.
        submissions: folder, file or archive of each student; its name is that of the student.
        out: folder of the marks; created.
        jobs: submissions that are graded at a time; default: number of processors.
        isolate: use namespaces. Without, programs run as ordinary processes of yours.
        told: called for each mark, with whether it was kept from a run before, from any thread.
        warn: called with a sentence if world files are graded without isolation.

    Raises:
        InputError: the assignment file has faults; all of them are named.
        CommandError: a submission does not exist, `out` cannot be written, or this system cannot
            isolate the programs of the assignment.
    """
    if isinstance(assignment, str):
        assignment, _ = read_assignment(shipped_assignment(assignment))
    found = submissions_of(submissions)
    namespaces = isolate and _can_isolate(assignment, warn)
    marks = Grader(assignment, out, jobs or os.cpu_count() or 1, namespaces, told).run(found)
    return Grading(marks, [*write_lists(assignment, marks, out),
                           write_pages(assignment, marks, out)])


def _can_isolate(assignment: Assignment, warn: Callable[[str], None]) -> bool:
    """Whether submissions can be isolated. Raises CommandError if their programs would not be."""
    fault = isolation_fault()
    if fault and (assignment.form.run or assignment.of(Launch, Rostest)):
        raise CommandError(f"{fault}: programs of submissions could change all that you can. Grade"
                           " as root, or permit user namespaces; --no-isolation runs them"
                           " nevertheless")
    if fault:
        warn(f"{fault}; world files are graded without isolation")
    return not fault
