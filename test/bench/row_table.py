"""The command line of a benchmark: rows by name, each a figure beside the bar to be met."""
from __future__ import annotations

import os
import sys
from typing import Callable, Dict, List, Tuple

Row = Tuple[str, str, str, bool]
"""What was measured, the figure, the bar, and whether it is met."""

Rows = Dict[str, Callable[[], List[Row]]]


def shown(rows: Rows) -> None:
    """Measure and print the rows that the command line names, or all."""
    print(f"cores: {len(os.sched_getaffinity(0))}")
    for name in sys.argv[1:] or list(rows):
        for title, value, bar, met in rows[name]():
            print(f"{title:66} {value:>18}   bar {bar:8} {'' if met else 'MISSED'}", flush=True)
