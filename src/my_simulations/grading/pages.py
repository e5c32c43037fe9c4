"""Marks as pages: one for each student, and an overview."""
from __future__ import annotations

import os
from html import escape
from itertools import groupby
from typing import List, Sequence
from urllib.parse import quote

from ..simulator.safe_file import write_atomically
from .assignment import Assignment
from .final_picture import PICTURE
from .grader import STUDENTS
from .lists import reason_with_location
from .mark import GRADED, Mark

REPLAY = "replay.html"
_STYLE = """body{font:15px/1.45 sans-serif;margin:2em auto;max-width:62em;padding:0 1em;color:#222}
table{border-collapse:collapse}td,th{border:1px solid #ccc;padding:3px 9px;text-align:left;
vertical-align:top}th{background:#f2f2f2}.full{background:#e7f5e7}.part{background:#fff7dc}
.none{background:#fdeaea}.number{text-align:right;white-space:nowrap}code{overflow-wrap:anywhere}
img{max-width:100%}iframe{width:100%;height:34em;border:1px solid #ccc}"""


def write_pages(assignment: Assignment, marks: Sequence[Mark], out: str) -> str:
    """Write a page for each student, and the overview, whose path is returned.

    Raises CommandError: one cannot be written.
    """
    for mark in marks:
        path = os.path.join(os.path.abspath(out), STUDENTS, mark.student, "index.html")
        write_atomically(path, _student(assignment, mark).encode("utf-8", "replace"),
                         overwrite=True)
    path = os.path.join(os.path.abspath(out), "index.html")
    write_atomically(path, _overview(assignment, marks).encode("utf-8", "replace"), overwrite=True)
    return path


def _page(title: str, body: Sequence[str]) -> str:
    return (f'<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><title>{escape(title)}'
            f'</title><style>{_STYLE}</style></head><body>' + "\n".join(body) + "</body></html>\n")


def _colour(points: float, most: float) -> str:
    return "full" if points >= most else "part" if points > 0.0 else "none"


def _student(assignment: Assignment, mark: Mark) -> str:
    body = [f"<h1>{escape(assignment.lab)}: {escape(mark.student)}</h1>",
            f"<p><b>{mark.points:g} of {mark.most:g} points</b>"
            + ("" if mark.status == GRADED else f" ({escape(mark.status)})") + "</p>",
            *(f"<p>{escape(note)}</p>" for note in mark.notes),
            "<table><tr><th>check</th><th>points</th><th>reason</th><th>place</th></tr>",
            *_rows(mark), "</table>"]
    if PICTURE in mark.files:
        body.append(f'<p><img src="{PICTURE}" alt="The world at the end of the run"></p>')
    if REPLAY in mark.files:
        body += [f'<h2>Replay</h2><p><a href="{REPLAY}">in a window of its own</a></p>',
                 f'<iframe src="{REPLAY}" title="Replay" loading="lazy"></iframe>']
    body += [f'<p><a href="{quote(name)}">{escape(name)}</a></p>' for name in mark.files
             if name not in (PICTURE, REPLAY)]
    return _page(f"{assignment.lab}: {mark.student}", body)


def _rows(mark: Mark) -> List[str]:
    """A row for each check; a cause that several checks share is shown once."""
    rows: List[str] = []
    for (reason, place), group in groupby(mark.results, lambda one: (
            _without_notes(one.reason, mark.notes),
            f"{one.file}:{one.line}" if one.line else one.file)):
        results = list(group)
        shared = (f'<td rowspan="{len(results)}">{escape(reason)}</td>'
                  f'<td rowspan="{len(results)}"><code>{escape(place)}</code></td>')
        for one in results:
            rows.append(f'<tr class="{_colour(one.points, one.most)}"><td>{escape(one.name)}</td>'
                        f'<td class="number">{one.points:g} of {one.most:g}</td>{shared}</tr>')
            shared = ""
    return rows


def _without_notes(reason: str, notes: Sequence[str]) -> str:
    """A reason without the notes at its end, which the page shows above."""
    for note in notes:
        if note and reason.endswith(f"; {note}"):
            reason = reason[:-len(note) - 2]
    return reason


def _overview(assignment: Assignment, marks: Sequence[Mark]) -> str:
    names = [check.name for check in assignment.checks]
    head = "".join(f"<th>{escape(name)}</th>" for name in names)
    rows: List[str] = []
    for mark in marks:
        link = f"{STUDENTS}/{quote(os.fsencode(mark.student))}/index.html"
        cells = "".join(f'<td class="number {_colour(one.points, one.most)}" title='
                        f'"{escape(reason_with_location(one), quote=True)}">{one.points:g}</td>'
                        for one in mark.results)
        status = "" if mark.status == GRADED else f" ({escape(mark.status)})"
        rows.append(f'<tr><td><a href="{link}">{escape(mark.student)}</a>{status}</td>'
                    f'<td class="number"><b>{mark.points:g}</b></td>{cells}</tr>')
    means = "".join(f'<td class="number">{_mean([mark.results[at].points for mark in marks])}</td>'
                    for at in range(len(names)))
    total = _mean([mark.points for mark in marks])
    return _page(assignment.lab, [
        f"<h1>{escape(assignment.lab)}</h1>",
        f"<p>{len(marks)} submissions, {assignment.points:g} points at most."
        ' Lists: <a href="marks.csv">marks.csv</a>, <a href="nbgrader.csv">nbgrader.csv</a>,'
        ' <a href="junit.xml">junit.xml</a></p>',
        f"<table><tr><th>student</th><th>points</th>{head}</tr>", *rows,
        f'<tr><th>mean</th><td class="number">{total}</td>{means}</tr></table>'])


def _mean(values: Sequence[float]) -> str:
    return f"{sum(values) / len(values):.2f}" if values else ""
