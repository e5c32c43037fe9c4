"""`grade`: marks submissions by an assignment file."""
from __future__ import annotations

import argparse
import os
import sys
import threading
from typing import List, Optional, Sequence

from ..errors import CommandError, InputError
from ..grading.assignment import Assignment
from ..grading.assignment_file import read_assignment
from ..grading.grade import grade
from ..grading.mark import GRADED, Mark
from ..grading.shipped import shipped_assignment
from ..program_end import exit_cleanly
from ..ros.arguments import Parser

NAME = "grade"
OK, NOT_ALL, INVALID = 0, 1, 2


def parser() -> argparse.ArgumentParser:
    made = Parser(
        prog=NAME, description="Grade submissions by an assignment file (doc/grading.md). Each one"
        " runs isolated from the others and from this system.",
        epilog="Exit code: 0 if every submission was graded, 1 if some were not, 2 for a faulty"
        " assignment or command line, 130 if interrupted.")
    made.add_argument("assignment", metavar="ASSIGNMENT",
                      help="assignment file, or the name of a shipped one, such as lab_sheet")
    made.add_argument("submissions", nargs="*", metavar="SUBMISSION",
                      help="folder or file of each student; its name is that of the student")
    made.add_argument("--out", default="marks", metavar="FOLDER",
                      help="folder of the marks (default: %(default)s)")
    made.add_argument("--jobs", type=int, default=os.cpu_count() or 1, metavar="N",
                      help="submissions that are graded at a time (default: number of processors)")
    made.add_argument("--check", action="store_true", help="only check the assignment file")
    made.add_argument("--no-isolation", action="store_true", help="do not use namespaces: run"
                      " submissions as ordinary processes; for your own programs only")
    return made


@exit_cleanly
def main(argv: Optional[Sequence[str]] = None) -> int:
    """Run a command line, program name first; return the exit code that `parser` lists."""
    made = parser()
    options = made.parse_args((sys.argv if argv is None else list(argv))[1:])
    if options.jobs < 1:
        made.error("--jobs must be at least 1")
    try:
        assignment, issues = read_assignment(shipped_assignment(options.assignment))
    except InputError as fault:
        for issue in fault.issues:
            print(issue, file=sys.stderr)
        return INVALID
    except CommandError as fault:
        print(f"{NAME}: {fault}", file=sys.stderr)
        return INVALID
    for issue in issues:
        print(issue, file=sys.stderr)
    if options.check:
        print(f"{assignment.lab}: {len(assignment.checks)} checks, {assignment.points:g} points")
        return OK
    if not options.submissions:
        made.error("the following arguments are required: SUBMISSION")
    try:
        return _grade(assignment, options)
    except CommandError as fault:
        print(f"{NAME}: {fault}", file=sys.stderr)
        return INVALID


def _grade(assignment: Assignment, options: argparse.Namespace) -> int:
    lock = threading.Lock()
    count: List[Mark] = []

    def describe(mark: Mark, kept: bool) -> None:
        with lock:
            count.append(mark)
            ending = ", unchanged" if kept else "" if mark.status == GRADED else f", {mark.status}"
            print(f"{len(count)}/{len(options.submissions)} {mark.student}: {mark.points:g} of"
                  f" {mark.most:g}{ending}", file=sys.stderr, flush=True)

    def warn(text: str) -> None:
        print(f"{NAME}: warning: {text}", file=sys.stderr)

    done = grade(assignment, options.submissions, options.out, jobs=options.jobs,
                 isolate=not options.no_isolation, told=describe, warn=warn)
    for path in done.files:
        print(path, flush=True)
    return OK if all(mark.status == GRADED for mark in done.marks) else NOT_ALL
