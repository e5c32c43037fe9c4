"""Sections of the pages in doc/ that generators write, between two marks."""
from __future__ import annotations

import pathlib
import sys
from typing import Callable

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]


def replaced(page: str, mark: str, text: str) -> str:
    """The page's text with `text` between `<!-- mark -->` and `<!-- /mark -->`."""
    begin, end = f"<!-- {mark} -->\n", f"<!-- /{mark} -->"
    head, rest = page.split(begin)
    return f"{head}{begin}{text}{end}{rest.split(end)[1]}"


def write(page: pathlib.Path, updated: Callable[[str], str]) -> None:
    """Write a page again, with the modules of this source tree."""
    sys.path.insert(0, str(REPOSITORY / "src"))
    page.write_text(updated(page.read_text(encoding="utf-8")), encoding="utf-8")
