"""A world in use for long: memory, descriptors and threads stay, and the books agree."""
from __future__ import annotations

import os
import time

from ledger import Crew, descriptors, memory, threads
from proofs import scaled

SECONDS = scaled(20, 7200)
SETTLED = 0.4
"""Share of the time after which nothing may grow."""

KEPT_KB = 2.5
"""PyBullet keeps about 1.4 kB of each removed body until the world is reset (measured)."""

GROWTH, SLACK_MB = 1.05, scaled(4, 0)
"""In a short run a heap may still find its size."""

MOST_MODELS = 15


def test_nothing_grows_and_the_books_agree(record):
    with Crew(4, MOST_MODELS) as crew:
        time.sleep(SETTLED * SECONDS)  # the time itself is what is tested
        pids = (os.getpid(), crew.simulator.engine_pid)
        removed = -crew.removed
        before = [(memory(pid), descriptors(pid), threads(pid)) for pid in pids]
        time.sleep((1.0 - SETTLED) * SECONDS)
        after = [(memory(pid), descriptors(pid), threads(pid)) for pid in pids]
        removed += crew.removed
        assert crew.simulator.engine_pid == pids[1]
        crew.finish()
    known = (0.0, KEPT_KB * removed / 1024)
    for (memory0, files0, threads0), (memory1, files1, threads1), kept in zip(
            before, after, known):
        assert memory1 < GROWTH * memory0 + kept + SLACK_MB
        assert files1 <= files0 + 1 and threads1 <= threads0  # one for a file that is just read
    growth = [round(100 * (new[0] / old[0] - 1), 1) for old, new in zip(before, after)]
    record("soak", of_seconds=SECONDS, **crew.figures(), removed=removed,
           node_growth_percent=growth[0], engine_growth_percent=growth[1])
