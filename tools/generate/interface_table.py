#!/usr/bin/env python3
"""Writes the table of services and topics into README.md, from the table that registers them."""
from __future__ import annotations

import pathlib
import sys

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
BEGIN, END = "<!-- interface -->\n", "<!-- /interface -->"


def with_interface(readme: str) -> str:
    """README's text with the present table between its marks."""
    from my_simulations.ros.interface import markdown

    head, rest = readme.split(BEGIN)
    return f"{head}{BEGIN}{markdown()}{END}{rest.split(END)[1]}"


if __name__ == "__main__":
    sys.path.insert(0, str(REPOSITORY / "src"))
    path = REPOSITORY / "README.md"
    path.write_text(with_interface(path.read_text(encoding="utf-8")), encoding="utf-8")
