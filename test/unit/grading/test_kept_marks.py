"""Marks of a run before are kept as long as nothing has changed on which they depend."""
from __future__ import annotations

import pytest

from my_simulations.grading.grade import grade

WORLD = """<sdf version="1.6"><world name="w"><include><uri>model://{}</uri></include></world></sdf>
"""
MODEL = """<sdf version="1.6"><model name="rock"><static>{}</static><link name="l"/></model></sdf>
"""


@pytest.fixture
def run(tmp_path, monkeypatch):
    """Grades all submissions; returns the points, and the students whose marks were kept."""
    (tmp_path / "lab.yaml").write_text("submission: {world: a.world}\nchecks:\n"
                                       "  - {points: 2, count: static, at_least: 1}\n")
    monkeypatch.setenv("GAZEBO_MODEL_PATH", str(tmp_path / "library"))
    for student, model in (("anna", "rock"), ("ben", "pebble")):
        (tmp_path / student).mkdir()
        (tmp_path / student / "a.world").write_text(WORLD.format(model))
    add_model(tmp_path, "rock")

    def graded():
        kept = []
        done = grade(str(tmp_path / "lab.yaml"), [str(tmp_path / name) for name in ("anna", "ben")],
                     str(tmp_path / "marks"),
                     told=lambda mark, was_kept: kept.extend([mark.student] * was_kept))
        return [mark.points for mark in done.marks], sorted(kept)

    return graded


def add_model(folder, name, static="true"):
    (folder / "library" / name).mkdir(parents=True, exist_ok=True)
    (folder / "library" / name / "model.config").write_text("<model><sdf>model.sdf</sdf></model>")
    (folder / "library" / name / "model.sdf").write_text(MODEL.format(static))


def test_a_mark_depends_on_the_models_of_the_library(tmp_path, run):
    assert run() == ([2, 0], [])
    assert run() == ([2, 0], ["anna", "ben"])
    add_model(tmp_path, "rock", "false")
    assert run() == ([0, 0], ["ben"])
    add_model(tmp_path, "pebble")
    assert run() == ([0, 2], ["anna"])
