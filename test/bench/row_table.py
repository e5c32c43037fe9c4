"""The command line of a benchmark: rows by name, each a figure beside the bar to be met."""
from __future__ import annotations

import os
import sys
from typing import Callable, Dict, List, Tuple

from server import master

Row = Tuple[str, str, str, bool]
"""What was measured, the figure, the bar, and whether it is met."""

Rows = Dict[str, Callable[[], List[Row]]]


def shown(rows: Rows, usage: str = "") -> None:
    """Measure and print the rows that the command line names, or all."""
    names = sys.argv[1:] or list(rows)
    if not set(names) <= set(rows):
        sys.exit(usage)
    print(f"cores: {len(os.sched_getaffinity(0))}")
    for name in names:
        for title, value, bar, met in rows[name]():
            print(f"{title:66} {value:>18}   bar {bar:8} {'' if met else 'MISSED'}", flush=True)


def shown_with_ros(rows: Rows, usage: str) -> None:
    """As `shown`, in a node on wall time, with a master of its own."""
    with master():
        import rospy
        rospy.init_node("bench", anonymous=True, disable_rostime=True, disable_signals=True)
        shown(rows, usage)
        rospy.signal_shutdown("done")
