"""A module's base name says one thing in the whole package."""
from __future__ import annotations

import pathlib
from collections import Counter

PACKAGE = pathlib.Path(__file__).resolve().parents[3] / "src" / "my_simulations"

SAME_IDEA = {
    "inter_model_joints",  # engine and simulator
    "joint", "link", "model",  # SDF, URDF, description
    "light", "saved_state", "noise", "sensor", "transmission", "plugin",  # SDF, description
    "scene", "materials",  # simulator, editor, sensing, appearance
    "api",  # engine, sensing: the interface of a child process
    "context", "registry", "imu",  # plugins, beside what they stand for elsewhere
    "world",  # SDF, description
}
"""Base names that stand for the same idea in several packages."""


def test_base_names_are_unique_unless_they_mean_the_same():
    counted = Counter(file.stem for file in PACKAGE.rglob("*.py"))
    assert {name for name, count in counted.items()
            if count > 1 and not name.startswith("__")} <= SAME_IDEA
