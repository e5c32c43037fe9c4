"""Roads as cameras and rays see them: the strip of the page, whose test reads the same cases."""
from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from my_simulations.description.surroundings import Road
from my_simulations.sensing.scenery import road_strip

CASES = json.loads((Path(__file__).parents[2] / "data/road_strips.json").read_text())["cases"]


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["says"])
def test_the_strip_is_the_one_of_the_page(case):
    points = [tuple(one) for one in case["road"]["points"]]
    found = road_strip(Road("r", case["road"]["width"], points))
    assert np.allclose(found.vertices, case["corners"], atol=1e-12)
    assert np.allclose(found.uv, case["uvs"], atol=1e-12)
    assert found.triangles.tolist() == case["triangles"]


def test_a_level_road_looks_upwards():
    found = road_strip(Road("r", 2.0, [(0.0, 0.0, 3.0), (1.0, 0.0, 3.0), (1.0, 5.0, 3.0)]))
    assert np.allclose(found.normals, (0.0, 0.0, 1.0))


@pytest.mark.parametrize("road", [
    Road("one point", 1.0, [(0.0, 0.0, 0.0)]), Road("none", 1.0, []),
    Road("no width", 0.0, [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)]),
    Road("nowhere", 1.0, [(0.0, 0.0, 0.0), (float("nan"), 0.0, 0.0)])], ids=lambda road: road.name)
def test_what_has_no_surface_is_nothing(road):
    assert road_strip(road) is None
