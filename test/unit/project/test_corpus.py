"""The table of test/corpus: each file counts once, in the right column."""
from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from reading import sdf

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "test/corpus"))
from workers import Worker

BOX = '<model name="m"><link name="l"/></model>'


def include(uri):
    return sdf(f'<world name="w"><include><uri>{uri}</uri></include></world>', "1.7")


FILES = {
    "crate/model.config": '<model><name>crate</name><sdf version="1.7">model.sdf</sdf></model>',
    "crate/model.sdf": sdf(BOX, "1.7"),
    "found.world": include("model://crate"),
    "absent.world": include("model://nowhere"),
    "misplaced.world": include("model://deep/crate2"),
    "other/deep/crate2/readme": "not a model",
    "without.world": include(""),
    "broken.sdf": "<sdf version='1.7'><model name='m'><link",
    "odd.sdf": sdf('<model name="m"><link name="l"><pose>0 0 1</pose></link></model>', "1.7"),
    "unbuilt.world": include("model://unbuilt"),
    "unbuilt/model.config": '<model><name>unbuilt</name><sdf>model.sdf</sdf></model>',
    "needs.xacro": '<robot name="$(arg robot)"/>',
    "macros.xacro": '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"/>',
}


@pytest.fixture
def table(tmp_path):
    for name, text in FILES.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    done = subprocess.run([sys.executable, str(ROOT / "test/corpus/corpus.py"), "--show", "faulty",
                           f"some={tmp_path}"],
                          capture_output=True, text=True, timeout=120)
    return done


def test_every_file_is_in_the_column_of_its_worst_error(table):
    head, row = (line.split() for line in table.stdout.splitlines()[-2:])
    counts = dict(zip(head, map(int, row[1:])))
    assert counts == {"files": 8, "clean": 2, "odd": 1, "missing": 2, "faulty": 2, "ours": 1,
                      "crash": 0, "hang": 0}
    assert table.returncode == 1


def test_errors_are_told_with_column_file_and_line(table):
    (line,) = (one for one in table.stdout.splitlines() if "without.world" in one)
    assert line.startswith("faulty") and "without.world:1: error [include-uri-missing]" in line


@pytest.fixture
def worker(request):
    made = Worker(dict(os.environ), request.param)
    yield made
    made.close()


@pytest.mark.parametrize("worker", [1.0], indirect=True)
def test_a_file_that_stops_the_reader_is_a_hang(worker, tmp_path):
    os.mkfifo(tmp_path / "pipe.sdf")  # has no writer
    assert worker.read(str(tmp_path / "pipe.sdf")) == {"end": "hang"}


@pytest.mark.parametrize("worker", [60.0], indirect=True)
def test_a_file_that_ends_the_reader_is_a_crash_and_the_next_is_read(worker, tmp_path):
    (tmp_path / "good.sdf").write_text(sdf(BOX, "1.7"))
    assert worker.read("\0.urdf") == {"end": "crash"}
    assert worker.read(str(tmp_path / "good.sdf"))["issues"] == []
