#!/usr/bin/env python3
"""Writes doc/issue_codes.md from the registry of issue codes."""
from __future__ import annotations

import pathlib
import sys

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]

if __name__ == "__main__":
    sys.path.insert(0, str(REPOSITORY / "src"))
    from my_simulations.issue_codes import markdown

    (REPOSITORY / "doc" / "issue_codes.md").write_text(markdown(), encoding="utf-8")
