"""The walks of doc/dev/walks.md: which modules and functions a request passes."""
from __future__ import annotations

import re
from pathlib import Path
from typing import List, NamedTuple, Tuple

PAGE = Path(__file__).resolve().parents[3] / "doc" / "dev" / "walks.md"
_COUNTS = re.compile(r"(\d+) modules, (\d+) revisits")


class Walk(NamedTuple):
    """`counts`: stated modules and revisits; `rows`: each a module and its functions."""

    title: str
    counts: Tuple[int, int]
    rows: List[Tuple[str, List[str]]]


def walks() -> List[Walk]:
    text = PAGE.read_text(encoding="utf-8")
    found = []
    for part in text.split("\n## ")[1:]:
        lines = re.search(r"```text walk\n(.*?)```", part, re.DOTALL).group(1).splitlines()
        # Remarks begin after two spaces or more, or after a name without a comma.
        rows = [re.match(r"(\S+)\s+(\w+(?:, \w+)*)", line).groups() for line in lines]
        modules, revisits = map(int, _COUNTS.search(part).groups())
        found.append(Walk(part.splitlines()[0], (modules, revisits),
                          [(module, names.split(", ")) for module, names in rows]))
    return found
