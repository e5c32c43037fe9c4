"""Marks of the collected submissions, for the tutor's page."""
from __future__ import annotations

import os
from typing import Any, Dict, Optional, Tuple

from ..grading.grader import MARK, STUDENTS
from ..grading.mark import mark_of
from .class_plan import ClassPlan

_TYPES = {".html": "text/html", ".json": "application/json", ".csv": "text/csv",
          ".xml": "text/xml", ".txt": "text/plain"}
_PAGE = "default-src 'none'; style-src 'unsafe-inline'; frame-src 'self'; base-uri 'none'"
_REPLAY = "sandbox allow-scripts"
"""A replay contains names that a student wrote: it runs without the rights of the tutor's page."""


def marks_folder(plan: ClassPlan) -> str:
    """The folder of the marks, which only the owner of the class can enter."""
    return os.path.join(plan.state, "marks")


def mark_shown(plan: ClassPlan, name: str) -> Optional[Dict[str, Any]]:
    """Points, most points and status of a student; None if there is no mark."""
    try:
        with open(os.path.join(marks_folder(plan), STUDENTS, name, MARK),
                  encoding="utf-8") as stream:
            mark = mark_of(stream.read())
    except (OSError, ValueError, TypeError, KeyError):
        return None    # not graded, or being written now
    return {"points": mark.points, "most": mark.most, "status": mark.status}


def marks_file(plan: ClassPlan, inside: str) -> Optional[Tuple[str, str, str]]:
    """Path, content type and policy of a file of the marks; None if there is none."""
    root = os.path.realpath(marks_folder(plan))
    path = os.path.realpath(os.path.join(root, inside))
    kind = _TYPES.get(os.path.splitext(path)[1])
    if not path.startswith(root + os.sep) or kind is None or not os.path.isfile(path):
        return None
    policy = _PAGE if os.path.basename(path) == "index.html" else _REPLAY
    return path, kind, f"{policy}; frame-ancestors 'self'"
