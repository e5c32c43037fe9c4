#!/usr/bin/env python3
"""Writes the table of what is read into README.md, from the readers' own tables."""
from __future__ import annotations

import pathlib
import sys

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
BEGIN, END = "<!-- supported -->\n", "<!-- /supported -->"


def with_table(readme: str) -> str:
    """README's text with the present table between its marks."""
    from my_simulations.formats.support_table import markdown

    head, rest = readme.split(BEGIN)
    return f"{head}{BEGIN}{markdown().strip()}\n{END}{rest.split(END)[1]}"


if __name__ == "__main__":
    sys.path.insert(0, str(REPOSITORY / "src"))
    path = REPOSITORY / "README.md"
    path.write_text(with_table(path.read_text(encoding="utf-8")), encoding="utf-8")
