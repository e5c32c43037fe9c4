"""Scoped names are split by one rule; the page's tests read the same table."""
import json
from pathlib import Path

import pytest

from my_simulations.description.scoped_names import split_scoped

TABLE = Path(__file__).parents[2] / "data" / "scoped_names.json"
CASES = json.loads(TABLE.read_text(encoding="utf-8"))["cases"]


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["says"])
def test_longest_model_name_wins(case):
    assert split_scoped(case["name"], case["models"].__contains__) == tuple(case["split"])
