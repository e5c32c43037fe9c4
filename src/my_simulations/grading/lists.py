"""Marks as files for other programs: CSV, Gradescope, nbgrader and JUnit."""
from __future__ import annotations

import csv
import io
import json
import os
from typing import Any, Dict, List, Sequence

from lxml import etree

from ..simulator.safe_file import write_atomically
from ..xml_characters import without_forbidden
from .assignment import Assignment
from .grader import STUDENTS
from .mark import GRADED, CheckResult, Mark

_NBGRADER = ("assignment", "duedate", "timestamp", "student_id", "last_name", "first_name",
             "email", "raw_score", "late_submission_penalty", "score", "max_score")
"""Columns of `nbgrader export`."""


def write_lists(assignment: Assignment, marks: Sequence[Mark], out: str) -> List[str]:
    """Write all lists; returns the paths of those of all students.

    Raises CommandError: one cannot be written.
    """
    texts = {"marks.csv": _csv(assignment, marks), "nbgrader.csv": _nbgrader(assignment, marks),
             "junit.xml": _junit(assignment, marks)}
    for mark in marks:
        texts[os.path.join(STUDENTS, mark.student, "results.json")] = json.dumps(
            gradescope_results(mark), indent=1).encode() + b"\n"
    for name, text in texts.items():
        write_atomically(os.path.join(os.path.abspath(out), name), text, overwrite=True)
    return [os.path.join(os.path.abspath(out), name)
            for name in ("marks.csv", "nbgrader.csv", "junit.xml")]


def _csv(assignment: Assignment, marks: Sequence[Mark]) -> bytes:
    rows: List[List[Any]] = [["student", "points", "most", "status",
                              *(check.name for check in assignment.checks)]]
    for mark in marks:
        rows.append([mark.student, mark.points, mark.most, mark.status,
                     *(one.points for one in mark.results)])
    return _table(rows)


def _nbgrader(assignment: Assignment, marks: Sequence[Mark]) -> bytes:
    rows: List[List[Any]] = [list(_NBGRADER)]
    for mark in marks:
        row = {"assignment": assignment.lab, "student_id": mark.student, "raw_score": mark.points,
               "late_submission_penalty": 0.0, "score": mark.points, "max_score": mark.most}
        rows.append([row.get(name, "") for name in _NBGRADER])
    return _table(rows)


def _table(rows: Sequence[Sequence[Any]]) -> bytes:
    stream = io.StringIO(newline="")
    csv.writer(stream).writerows(rows)
    return stream.getvalue().encode("utf-8", "replace")


def gradescope_results(mark: Mark) -> Dict[str, Any]:
    """Return the content of Gradescope's `results.json`."""
    tests = [{"name": one.name, "score": one.points, "max_score": one.most,
              "status": "passed" if one.passed else "failed", "output": reason_with_location(one)}
             for one in mark.results]
    return {"score": mark.points, "tests": tests, "output": "\n".join(mark.notes)}


def reason_with_location(one: CheckResult) -> str:
    """Return the reason of a result, with file and line in front."""
    if not one.reason or not one.file:
        return one.reason
    return f"{one.file}:{one.line}: {one.reason}" if one.line else f"{one.file}: {one.reason}"


def _junit(assignment: Assignment, marks: Sequence[Mark]) -> bytes:
    root = etree.Element("testsuites", name=without_forbidden(assignment.lab))
    for mark in marks:
        failed = [one for one in mark.results if not one.passed]
        suite = etree.SubElement(
            root, "testsuite", name=without_forbidden(mark.student), tests=str(len(mark.results)),
            failures=str(len(failed) if mark.status == GRADED else 0),
            errors=str(0 if mark.status == GRADED else len(failed)))
        for one in mark.results:
            case = etree.SubElement(suite, "testcase", name=without_forbidden(one.name),
                                    classname=without_forbidden(f"{assignment.lab}.{mark.student}"))
            if not one.passed:
                kind = "failure" if mark.status == GRADED else "error"
                etree.SubElement(case, kind, message=without_forbidden(
                    f"{one.points:g} of {one.most:g} points: {reason_with_location(one)}"))
    text: bytes = etree.tostring(root, encoding="UTF-8", xml_declaration=True, pretty_print=True)
    return text
