#!/usr/bin/env python3
"""Puts the figures of test/reliability into the tables of doc/reliability.md.

usage: reliability_table.py RECORDS   the file reliability.jsonl of a run of tools/test

A long run fills the second table, a short one the first.
"""
from __future__ import annotations

import json
import re
import sys
from pathlib import Path
from typing import Any, Dict, List

PAGE = Path(__file__).resolve().parents[2] / "doc" / "reliability.md"


def rows(records: List[Dict[str, Any]]) -> str:
    """A table of the last record of each proof."""
    last = {record["proof"]: record for record in records}
    lines = ["| proof | figures | took | test |", "|---|---|---|---|"]
    for proof, record in sorted(last.items()):
        figures = ", ".join(f"{name.replace('_', ' ')} {value}"
                            for name, value in record["figures"].items())
        test = record["test"].replace("test/reliability/", "")
        lines.append(f"| {proof} | {figures} | {record['seconds']} s | `{test}` |")
    return "\n".join(lines)


def with_table(page: str, name: str, table: str) -> str:
    """The page with the text between its marks replaced."""
    pattern = re.compile(f"(<!-- {name} -->\n).*?(<!-- end of {name} -->)", re.DOTALL)
    replaced, count = pattern.subn(lambda found: f"{found[1]}{table}\n{found[2]}", page)
    assert count == 1, name
    return replaced


def main(path: str) -> None:
    """Rewrite the page."""
    records = [json.loads(line) for line in Path(path).read_text().splitlines()]
    page = PAGE.read_text(encoding="utf-8")
    for name, wanted in (("short runs", False), ("long runs", True)):
        chosen = [record for record in records if record["long"] is wanted]
        if chosen:
            page = with_table(page, name, rows(chosen))
    PAGE.write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1])
