#!/usr/bin/env python3
"""Write the topics and services into doc/ros_api.md, from the table that registers them."""
from __future__ import annotations

import pathlib
import sys

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
PAGE = REPOSITORY / "doc" / "ros_api.md"
BEGIN, END = "<!-- interface -->\n", "<!-- /interface -->"


def with_interface(page: str) -> str:
    """The page's text with the present table between its marks."""
    from my_simulations.ros.interface import markdown

    head, rest = page.split(BEGIN)
    return f"{head}{BEGIN}{markdown()}{END}{rest.split(END)[1]}"


if __name__ == "__main__":
    sys.path.insert(0, str(REPOSITORY / "src"))
    PAGE.write_text(with_interface(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
