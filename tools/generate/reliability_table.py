#!/usr/bin/env python3
"""Puts the figures of test/reliability into the tables of doc/dev/reliability.md.

usage: reliability_table.py RECORDS   the file reliability.jsonl of a run of tools/test

A long run fills the second table, a short one the first; `tools/test --long` calls this at its end.
Rows of proofs that the run did not make stay, as long as their test is there.
"""
from __future__ import annotations

import json
import re
import sys
from pathlib import Path
from typing import Any, Dict, List

PAGE = Path(__file__).resolve().parents[2] / "doc" / "dev" / "reliability.md"


TESTS = PAGE.parents[2] / "test"


def rows(records: List[Dict[str, Any]], before: str = "") -> str:
    """A table of the last record of each proof; of others the rows of the table `before`.

    A line below it adds up the inputs of all proofs that make some.
    """
    lines = {line.split(" | ")[0][2:]: line for line in before.splitlines()[2:]
             if line.startswith("| ") and _has_test(line)}
    for record in records:
        figures = ", ".join(f"{name.replace('_', ' ')} {value}"
                            for name, value in record["figures"].items())
        test = record["test"].replace("test/reliability/", "")
        lines[record["proof"]] = (
            f"| {record['proof']} | {figures} | {record['seconds']} s | `{test}` |")
    inputs = [int(found.group(1)) for line in lines.values()
              if (found := re.search(r"\binputs (\d+)", line))]
    total = f"Inputs in all: {sum(inputs)}, of {len(inputs)} proofs."
    return "\n".join(["| proof | figures | took | test |", "|---|---|---|---|",
                      *(lines[proof] for proof in sorted(lines)), *(["", total] if inputs else [])])


def _has_test(line: str) -> bool:
    """Whether the test that a row names is still there."""
    file, _, name = line.rpartition("`")[0].rpartition("`")[2].partition("::")
    return any(f"def {name}(" in path.read_text(encoding="utf-8") for path in TESTS.rglob(file))


def table_of(page: str, name: str) -> str:
    """The text between the marks of a table."""
    return page.partition(f"<!-- {name} -->\n")[2].partition(f"<!-- end of {name} -->")[0]


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
            page = with_table(page, name, rows(chosen, table_of(page, name)))
    PAGE.write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1])
