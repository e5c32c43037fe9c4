"""The report of a study: one HTML file that needs neither network nor script."""
from __future__ import annotations

import math
import os
from html import escape
from typing import Any, Dict, List, Sequence, Tuple

from .replacing import replacement_file
from .replays import replay_of
from .row import OK, STATUSES, Row
from .study import Study
from .table import cells, columns_of, rows_in_order

_MOST_ROWS = 500
_MOST_POINTS = 1000
_MOST_PLOTS = 24
_MOST_EXAMPLES = 5

_STYLE = """body{font:14px/1.4 sans-serif;margin:2em;color:#222}table{border-collapse:collapse}
td,th{border:1px solid #ccc;padding:2px 8px;text-align:left}th{background:#f2f2f2}
code{background:#f2f2f2;padding:0 3px}.plots{display:flex;flex-wrap:wrap;gap:8px}
svg{border:1px solid #ddd}svg text{font:11px sans-serif}.grid{stroke:#e4e4e4;fill:none}
circle{fill:#1f6fb2;fill-opacity:.6}.scroll{overflow-x:auto}"""


def write_report(path: str, study: Study, paths: Sequence[str], have_run: int, command: str
                 ) -> None:
    """Write the report.

    Args:
        path: of the HTML file.
        study: the study.
        paths: its journals.
        have_run: how many cases of the study have a row; other rows are of former ids.
        command: what shows a case when its id is appended.
    """
    found = _Collected(study)
    for row in rows_in_order(paths):
        found.add(row)
    parts = [f'<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><title>'
             f'{escape(study.name)}</title><style>{_STYLE}</style></head><body>'
             f'<h1>{escape(study.name)}</h1><p><code>{escape(study.file)}</code></p>',
             _summary(study, found, have_run), _plots(study, found),
             _failures(found, command, os.path.dirname(path)),
             _table(study, found), "</body></html>\n"]
    with replacement_file(path) as part, open(part, "w", encoding="utf-8") as stream:
        stream.write("\n".join(text for text in parts if text))


class _Collected:
    """What the report shows of the rows, in bounded memory."""

    def __init__(self, study: Study) -> None:
        self.counts = dict.fromkeys(STATUSES, 0)
        self.total = self.flaky = 0
        self.rows: List[Row] = []
        self.causes: Dict[Tuple[str, str], List[Row]] = {}
        self.cause_counts: Dict[Tuple[str, str], int] = {}
        self.points: List[Dict[str, Any]] = []
        self._every = max(1, study.count // _MOST_POINTS)

    def add(self, row: Row) -> None:
        self.counts[row.status] += 1
        self.flaky += row.flaky
        if len(self.rows) < _MOST_ROWS:
            self.rows.append(row)
        if row.status != OK:
            cause = (row.status, row.issue)
            self.cause_counts[cause] = self.cause_counts.get(cause, 0) + 1
            examples = self.causes.setdefault(cause, [])
            if len(examples) < _MOST_EXAMPLES:
                examples.append(row)
        if row.values and self.total % self._every == 0:
            self.points.append(cells(row))
        self.total += 1


def _summary(study: Study, found: _Collected, have_run: int) -> str:
    rows = "".join(f"<tr><td>{status}</td><td>{count}</td></tr>"
                   for status, count in found.counts.items() if count)
    each = "" if study.scenarios else f", {study.duration:g} s of sim time each"
    former = found.total - have_run
    note = f" {former} rows of the table are of former ids." if former > 0 else ""
    return (f"<h2>Cases</h2><p>{have_run} of {study.count} have run{each}; {found.flaky} are"
            f" flaky (crashed once, ran the second time).{note}</p>"
            f"<table><tr><th>status</th><th>cases</th></tr>{rows}</table>")


def _plots(study: Study, found: _Collected) -> str:
    drawn: List[str] = []
    for name, expression in study.measure:
        for parameter in study.parameters:
            # Rows of former ids lack what the study file has gained since.
            points = [(float(point[parameter.name]), float(point[name])) for point in found.points
                      if _finite(point.get(parameter.name)) and _finite(point.get(name))]
            if points and not expression.condition and len(drawn) < _MOST_PLOTS:
                drawn.append(scatter(points, parameter.name, name))
    if not drawn:
        return ""
    note = (f"<p>Every {found._every}th case.</p>" if found._every > 1 else "")
    return f'<h2>Measured by varied</h2>{note}<div class="plots">{"".join(drawn)}</div>'


def _finite(value: Any) -> bool:
    return isinstance(value, (int, float)) and math.isfinite(value)


def _replay(folder: str, case: str) -> str:
    """A link to the replay of a case, if there is one."""
    path = replay_of(folder, case)
    if not os.path.isfile(path):
        return ""
    return f' <a href="{escape(os.path.relpath(path, folder))}">replay</a>'


def _failures(found: _Collected, command: str, folder: str) -> str:
    if not found.causes:
        return ""
    rows = []
    for cause, count in sorted(found.cause_counts.items(), key=lambda item: -item[1]):
        shown = "<br>".join(f"<code>{escape(command)} {row.case}</code>{_replay(folder, row.case)}"
                            for row in found.causes[cause])
        rows.append(f"<tr><td>{cause[0]}</td><td>{escape(cause[1])}</td><td>{count}</td>"
                    f"<td>{shown}</td></tr>")
    return ("<h2>Failures by cause</h2><table><tr><th>status</th><th>cause</th><th>cases</th>"
            "<th>to see one</th></tr>" + "".join(rows) + "</table>")


def _table(study: Study, found: _Collected) -> str:
    columns = columns_of(study)
    body = []
    for row in found.rows:
        values = cells(row)
        body.append("<tr>" + "".join(f"<td>{escape(_format_value(values.get(name, '')))}</td>"
                                     for name in columns) + "</tr>")
    note = (f"<p>The first {_MOST_ROWS} of {found.total}; all are in the CSV file.</p>"
            if found.total > _MOST_ROWS else "")
    head = "".join(f"<th>{escape(name)}</th>" for name in columns)
    return (f'<h2>Table</h2>{note}<div class="scroll"><table><tr>{head}</tr>'
            + "\n".join(body) + "</table></div>")


def _format_value(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


_WIDTH, _HEIGHT = 360, 240
_LEFT, _RIGHT, _TOP, _BOTTOM = 56, 12, 12, 40


def ticks(least: float, most: float, about: int = 5) -> List[float]:
    """Round numbers from `least` to `most`, about so many of them."""
    if not most > least:
        return [least]
    raw = (most - least) / about
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= raw)
    first = math.ceil(least / step - 1e-9)
    last = math.floor(most / step + 1e-9)
    return [index * step for index in range(first, last + 1)]


def scatter(points: Sequence[Tuple[float, float]], across: str, up: str) -> str:
    """A plot of points (x, y), all finite; both axes have their names and round numbers."""
    xs, ys = _range([x for x, _ in points]), _range([y for _, y in points])

    def at(x: float, y: float) -> Tuple[float, float]:
        return (_LEFT + (x - xs[0]) / (xs[1] - xs[0]) * (_WIDTH - _LEFT - _RIGHT),
                _HEIGHT - _BOTTOM - (y - ys[0]) / (ys[1] - ys[0]) * (_HEIGHT - _TOP - _BOTTOM))

    bottom, right = _HEIGHT - _BOTTOM, _WIDTH - _RIGHT
    parts = [f'<svg viewBox="0 0 {_WIDTH} {_HEIGHT}" width="{_WIDTH}" height="{_HEIGHT}" role="img"'
             f' aria-label="{escape(up)} by {escape(across)}">']
    for x in ticks(*xs):
        left = at(x, ys[0])[0]
        parts.append(f'<path class="grid" d="M{left:.1f} {_TOP}V{bottom}"/>'
                     f'<text x="{left:.1f}" y="{bottom + 14}" text-anchor="middle">{x:.4g}</text>')
    for y in ticks(*ys):
        top = at(xs[0], y)[1]
        parts.append(f'<path class="grid" d="M{_LEFT} {top:.1f}H{right}"/>'
                     f'<text x="{_LEFT - 4}" y="{top + 4:.1f}" text-anchor="end">{y:.4g}</text>')
    parts += [f'<circle cx="{at(x, y)[0]:.1f}" cy="{at(x, y)[1]:.1f}" r="2.5"/>' for x, y in points]
    parts.append(f'<text x="{(_LEFT + right) / 2}" y="{_HEIGHT - 6}" text-anchor="middle">'
                 f'{escape(across)}</text><text x="12" y="{(_TOP + bottom) / 2}"'
                 f' text-anchor="middle" transform="rotate(-90 12 {(_TOP + bottom) / 2})">'
                 f'{escape(up)}</text></svg>')
    return "".join(parts)


def _range(values: Sequence[float]) -> Tuple[float, float]:
    """Somewhat more than from the least to the greatest."""
    least, most = min(values), max(values)
    margin = 0.04 * (most - least) or 0.1 * abs(most) or 1.0
    return least - margin, most + margin
