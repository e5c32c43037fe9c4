"""The table of a study: CSV always, parquet where pyarrow is installed."""
from __future__ import annotations

import csv
import importlib
import importlib.util
import itertools
from typing import Any, Dict, Iterator, List, Optional, Sequence, Tuple

from .journal import read_rows
from .replacing import replacement_file
from .row import Row, row_of
from .study import Study

_FIRST = ("index", "case", "seed")
_LAST = ("status", "attempt", "flaky", "signal", "step", "issue", "hash", "processor", "trajectory")
_GROUP = 20_000  # rows of a row group of parquet


def columns_of(study: Study) -> List[str]:
    """Names of the columns: number, id and seed, what was varied, measured, and became of it."""
    return [*_FIRST, *(parameter.name for parameter in study.parameters),
            *(name for name, _ in study.results), *_LAST]


def rows_in_order(paths: Sequence[str]) -> Iterator[Row]:
    """The rows of journals in the order of the plan; of two of one case the last."""
    places: List[Tuple[int, int, int]] = []
    for number, path in enumerate(paths):
        for offset, line in read_rows(path):
            at = line.find(b'"index":') + 8
            places.append((int(line[at:line.index(b",", at)]), number, offset))
    places.sort()
    streams = [open(path, "rb") for path in paths]
    try:
        for _, same_index in itertools.groupby(places, lambda place: place[0]):
            found: Dict[str, Row] = {}
            for _, number, offset in same_index:
                streams[number].seek(offset)
                row = row_of(streams[number].readline())
                found[row.case] = row
            yield from found.values()
    finally:
        for stream in streams:
            stream.close()


def cells(row: Row) -> Dict[str, Any]:
    """The values of a row by column, without those that were not measured."""
    found: Dict[str, Any] = {name: getattr(row, name) for name in _FIRST + _LAST}
    found.update({name: _plain(value) for name, value in row.settings.items()})
    found.update(row.values)
    return found


def write_csv(path: str, study: Study, paths: Sequence[str]) -> int:
    """Write the table as CSV (RFC 4180, UTF-8); returns the number of rows.

    Floats are written so that reading them gives the same bits. A value that was not measured is
    empty, and NaN is `nan`.
    """
    columns, count = columns_of(study), 0
    with replacement_file(path) as part, open(part, "w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(columns)
        for row in rows_in_order(paths):
            found = cells(row)
            writer.writerow([found.get(name, "") for name in columns])
            count += 1
    return count


def parquet_fault() -> Optional[str]:
    """Why parquet cannot be written; "" without pyarrow, None if it can."""
    if importlib.util.find_spec("pyarrow") is None:
        return ""
    try:
        importlib.import_module("pyarrow.parquet")
    except Exception as fault:  # such as that of one that was built for another NumPy
        return f"results.parquet is left out, pyarrow cannot be imported: {fault}"
    return None


def write_parquet(path: str, study: Study, paths: Sequence[str]) -> int:
    """Write the table as parquet; returns the number of rows.

    Only where `parquet_fault` is None. A column has the type of the study file as it is now: what
    a former one left of another kind, such as a number where there is a condition now, is null.
    """
    arrow = importlib.import_module("pyarrow")
    parquet = importlib.import_module("pyarrow.parquet")
    kinds = _kinds(study)
    types = {int: arrow.int64(), str: arrow.string(), float: arrow.float64(), bool: arrow.bool_()}
    schema = arrow.schema([(name, types[kind]) for name, kind in kinds.items()])
    count = 0
    with replacement_file(path) as part, parquet.ParquetWriter(part, schema) as writer:
        group: List[Dict[str, Any]] = []
        for row in rows_in_order(paths):
            group.append({name: _convert_cell(value, kinds[name])
                          for name, value in cells(row).items() if name in kinds})
            count += 1
            if len(group) == _GROUP:
                writer.write_table(arrow.Table.from_pylist(group, schema))
                group = []
        writer.write_table(arrow.Table.from_pylist(group, schema))
    return count


def _kinds(study: Study) -> Dict[str, type]:
    """The type of each column, in order."""
    kinds: Dict[str, type] = {"index": int, "seed": int, "attempt": int, "step": int,
                              "flaky": bool}
    for parameter in study.parameters:
        numeric = all(isinstance(value, (int, float)) for value in parameter.values)
        kinds[parameter.name] = float if numeric else str
    for name, condition in study.results:
        kinds[name] = bool if condition else int if study.scenarios else float
    return {name: kinds.get(name, str) for name in columns_of(study)}


def _convert_cell(value: Any, kind: type) -> Any:
    """Convert a cell to the type of its column; None if that is not possible."""
    if kind is str:
        return str(value)
    if kind is float and type(value) is int:
        return float(value)
    return value if type(value) is kind else None


def _plain(value: Any) -> Any:
    """Poses and lists of names as one text."""
    return " ".join(map(str, value)) if isinstance(value, (list, tuple)) else value
