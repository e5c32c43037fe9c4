"""The example programs run, and show what they say they show."""
from __future__ import annotations

import csv
import json
import runpy
from pathlib import Path

import numpy as np
import pytest

from my_simulations.studies.command import main as study

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


def example(name):
    return runpy.run_path(str(EXAMPLES / name), run_name="example")


def test_an_object_that_is_dropped_comes_to_rest(capsys, monkeypatch):
    monkeypatch.setattr("sys.argv", ["drop_test.py"])
    example("drop_test.py")["main"]()
    name, rise, unit = capsys.readouterr().out.split()[:3]
    assert (name, unit) == ("MY_OBJECT:", "mm") and abs(float(rise)) < 100.0


def test_boxes_slide_as_far_as_their_friction_lets_them(capsys):
    example("parameter_sweep.py")["main"]()
    rows = [line.split() for line in capsys.readouterr().out.splitlines()[1:]]
    assert [float(row[0]) for row in rows] == [0.2, 0.4, 0.6, 0.8]
    for row in rows:
        assert float(row[1]) == pytest.approx(float(row[3]), rel=0.01)


def test_a_grip_holds_from_the_force_on_that_carries_the_weight():
    lifts = example("grasp.py")["lifts"]
    assert not lifts(4.0)
    assert lifts(6.0)


def test_the_study_measures_what_the_formula_says(tmp_path):
    assert study(["study", "run", str(EXAMPLES / "friction_study.yaml"),
                  "--out", str(tmp_path)]) == 0
    with open(tmp_path / "results.csv", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == 48
    for row in rows:
        assert float(row["distance"]) == pytest.approx(float(row["expected"]), rel=0.01, abs=2e-3)


def test_a_robot_stops_before_a_wall():
    rows = list(example("drive_robot.py")["approach"](0.5))
    assert rows[0][1] > 2.0 > rows[-1][1] == pytest.approx(0.5, abs=0.03)
    assert rows[-1][2] == pytest.approx(3.0 - 0.1 - 0.08 - 0.5, abs=0.05)  # laser: 8 cm


def test_the_notebook_drives_a_robot_and_plots_what_it_sees(monkeypatch):
    monkeypatch.setenv("MPLBACKEND", "Agg")
    monkeypatch.chdir(EXAMPLES)   # where Jupyter runs it
    names = {}
    for cell in json.loads((EXAMPLES / "robot_in_a_house.ipynb").read_text())["cells"]:
        if cell["cell_type"] == "code":
            exec("".join(cell["source"]), names)
    figures = names["plt"].get_fignums()
    names["plt"].close("all")
    assert len(figures) == 3
    assert names["way"][-1][0] > 0.8
    assert np.nanmax(names["ranges"]) > 3.0
    assert names["picture"].rgb.std() > 20.0
