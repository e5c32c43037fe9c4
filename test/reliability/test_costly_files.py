"""Small files that would take much time or memory: refused, or built while time goes on."""
from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest
from costly_files import ATTACKS
from proofs import IS_LONG

LARGE = "refused: model-too-large"
SKIPPED = "skipped: mesh-unreadable"

OUTCOMES = {
    "4000 empty links": LARGE,
    "20 000 boxes in a static link": LARGE,
    "20 000 boxes in a moving link": LARGE,
    "2000 links with boxes": LARGE,
    "2000 overlapping links": LARGE,
    "1000 plugins": LARGE,
    "OBJ face of 1.9 M indices": SKIPPED,
    "STL of 2 M triangles": "built",
    "STL that declares 40 M triangles": SKIPPED,
    "PLY that declares 400 M vertices": SKIPPED,
    "GLB that declares 2000 M values": SKIPPED,
    "height map of 4096 x 4096": "built",
    "PNG that declares 10 000 M pixels": "skipped: image-unreadable",
    "DAE of 280 000 empty nodes": SKIPPED,
    "includes of 14 folders": "refused: include-many",
    "OBJ of 3 GB": SKIPPED,
    "STL text of 3 GB": SKIPPED,
    "DAE of 3 GB": SKIPPED,
    "world of 16 000 links": "built",
}
SLOW = {name for name, outcome in OUTCOMES.items() if outcome == "built"}
"""Those that are built take half a minute on a busy machine: in long runs only."""

PROCESSES = ("node_mb", "engine_mb", "reader_mb")
MOST_TIMES, MOST_MORE_MB = 4, 100
"""A process may use four times the useful size of a file and 100 MB."""


def test_every_file_has_an_expected_outcome():
    assert set(OUTCOMES) == set(ATTACKS)


@pytest.mark.parametrize("name", [name for name in OUTCOMES if IS_LONG or name not in SLOW])
def test_a_costly_file_is_refused_or_built_while_time_goes_on(name, tmp_path, record):
    program = os.path.join(os.path.dirname(__file__), "costly_run.py")
    done = subprocess.run([sys.executable, program, name, str(tmp_path)], check=False, text=True,
                          capture_output=True, timeout=900)
    assert done.returncode == 0, done.stderr[-2000:]
    figures = json.loads(done.stdout.splitlines()[-1])
    assert figures.pop("outcome") == OUTCOMES[name]
    most = MOST_TIMES * figures["useful_mb"] + MOST_MORE_MB
    assert all(figures[process] <= most for process in PROCESSES), figures
    record(f"costly file: {name}", **figures)
