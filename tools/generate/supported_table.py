#!/usr/bin/env python3
"""Write the table of supported elements into doc/sdf_support.md, from the readers' own tables."""
from __future__ import annotations

import pathlib
import sys

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
PAGE = REPOSITORY / "doc" / "sdf_support.md"
BEGIN, END = "<!-- supported -->\n", "<!-- /supported -->"


def with_table(page: str) -> str:
    """The page's text with the present table between its marks."""
    from my_simulations.formats.support_table import markdown

    head, rest = page.split(BEGIN)
    return f"{head}{BEGIN}{markdown().strip()}\n{END}{rest.split(END)[1]}"


if __name__ == "__main__":
    sys.path.insert(0, str(REPOSITORY / "src"))
    PAGE.write_text(with_table(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
