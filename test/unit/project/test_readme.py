"""The README says what the code does."""
from __future__ import annotations

import pathlib
import sys

REPOSITORY = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(REPOSITORY / "tools" / "generate"))

from supported_table import with_table


def test_the_table_of_what_is_read_is_the_readers_own():
    readme = (REPOSITORY / "README.md").read_text(encoding="utf-8")
    assert with_table(readme) == readme, "run tools/generate/supported_table.py"
